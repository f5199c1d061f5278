"""How the render engine renders: properties of the scene."""

import bpy
from bpy.props import IntProperty, PointerProperty


class MesoshellRender(bpy.types.PropertyGroup):
    """Of the engine Mesoshell; film, border, resolution and filter are Blender's own settings."""

    samples: IntProperty(name="Samples", description="Rays a pixel: smooth edges and soft shadows take many", default=16,
                         min=1, max=65536, soft_max=1024)
    seed: IntProperty(name="Seed", description="Another one has another noise", default=0, min=0)


def register():
    bpy.utils.register_class(MesoshellRender)
    bpy.types.Scene.mesoshell_render = PointerProperty(type=MesoshellRender)


def unregister():
    del bpy.types.Scene.mesoshell_render
    bpy.utils.unregister_class(MesoshellRender)
