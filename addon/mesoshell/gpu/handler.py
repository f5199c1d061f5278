"""The draw handler of the 3D View: every visible shell, after Blender's own objects, against their depth."""

import traceback

import bpy
import numpy

from ..core import native
from ..host import lights, shells, versions
from . import draw, program, resources, scene_depth

_handle = None
_problem = None


def problem():
    """The sentence of what keeps shells from being drawn, or None."""
    return _problem


def _draw():
    global _problem
    context = bpy.context
    depsgraph = context.evaluated_depsgraph_get()
    try:
        instances = shells.visible(depsgraph, context.space_data)
        if not instances:
            return
        clip_from_world = numpy.array(context.region_data.perspective_matrix, numpy.float64)
        lit = lights.read(depsgraph)
        if not versions.handlers_see_depth(context.space_data, context.scene.render.engine):
            scene_depth.draw(depsgraph, context.space_data, clip_from_world)
        for instance in instances:
            draw.draw_shell(instance, clip_from_world, lit)
        _problem = None
    except (RuntimeError, ValueError, native.NativeMissing) as error:
        if _problem != str(error):  # once, not every frame
            traceback.print_exc()
        _problem = str(error)
    resources.end_draw()


def register():
    global _handle
    scene_depth.register()
    _handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW")


def unregister():
    global _handle, _problem
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None
    _problem = None
    scene_depth.unregister()
    resources.forget()
    program.forget()
