"""The Properties editor while the engine Mesoshell is chosen: Blender's own panels, and what the engine adds.

Blender's panels say in COMPAT_ENGINES which engines they are for; those of the former built-in renderer, BLENDER_RENDER, fit
any.
"""

import bpy

from ..engine.engine import MesoshellRenderEngine
from .parts import split_layout

_ENGINE = MesoshellRenderEngine.bl_idname

# Panels of Eevee's whose settings the engine honors.
_ALSO = {"DATA_PT_EEVEE_light", "EEVEE_MATERIAL_PT_context_material", "EEVEE_MATERIAL_PT_surface", "EEVEE_WORLD_PT_surface",
         "VIEWLAYER_PT_layer_passes"}
# Panels of BLENDER_RENDER whose settings the engine has no use for, or that DATA_PT_EEVEE_light replaces.
_NOT = {"DATA_PT_light", "RENDER_PT_gpencil", "RENDER_PT_freestyle"}


class _EnginePanel:
    bl_space_type = 'PROPERTIES'
    bl_region_type = 'WINDOW'
    COMPAT_ENGINES = {_ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES


class MESOSHELL_RENDER_PT_sampling(_EnginePanel, bpy.types.Panel):
    bl_label = "Sampling"
    bl_context = "render"

    def draw(self, context):
        layout = split_layout(self)
        settings = context.scene.mesoshell_render
        layout.prop(settings, "samples")
        layout.prop(settings, "seed")


class MESOSHELL_RENDER_PT_film(_EnginePanel, bpy.types.Panel):
    bl_label = "Film"
    bl_context = "render"

    def draw(self, context):
        layout = split_layout(self)
        render = context.scene.render
        layout.prop(render, "filter_size")
        layout.prop(render, "film_transparent", text="Transparent")


class MESOSHELL_RENDER_PT_threads(_EnginePanel, bpy.types.Panel):
    bl_label = "Performance"
    bl_context = "render"
    bl_options = {'DEFAULT_CLOSED'}

    def draw(self, context):
        layout = split_layout(self)
        render = context.scene.render
        layout.prop(render, "threads_mode")
        column = layout.column()
        column.enabled = render.threads_mode == 'FIXED'
        column.prop(render, "threads")


class MESOSHELL_VIEWLAYER_PT_passes(_EnginePanel, bpy.types.Panel):
    bl_label = "Data"
    bl_context = "view_layer"
    bl_parent_id = "VIEWLAYER_PT_layer_passes"

    def draw(self, context):
        column = split_layout(self).column(heading="Include")
        view_layer = context.view_layer
        column.prop(view_layer, "use_pass_z", text="Z")
        column.prop(view_layer, "use_pass_normal", text="Normal")
        column.prop(view_layer, "use_pass_object_index", text="Object Index")


class MESOSHELL_OBJECT_PT_ray_visibility(_EnginePanel, bpy.types.Panel):
    bl_label = "Ray Visibility"
    bl_context = "object"
    bl_parent_id = "OBJECT_PT_visibility"

    def draw(self, context):
        column = split_layout(self).column()
        column.prop(context.object, "visible_camera", text="Camera")
        column.prop(context.object, "visible_shadow", text="Shadow")


class MESOSHELL_LIGHT_PT_shadow(_EnginePanel, bpy.types.Panel):
    bl_label = "Shadow"
    bl_context = "data"
    bl_parent_id = "DATA_PT_EEVEE_light"

    @classmethod
    def poll(cls, context):
        return context.light is not None and super().poll(context)

    def draw(self, context):
        split_layout(self).prop(context.light, "use_shadow", text="Cast Shadow")


CLASSES = (MESOSHELL_RENDER_PT_sampling, MESOSHELL_RENDER_PT_film, MESOSHELL_RENDER_PT_threads,
           MESOSHELL_VIEWLAYER_PT_passes, MESOSHELL_OBJECT_PT_ray_visibility, MESOSHELL_LIGHT_PT_shadow)


def _fitting():
    """Blender's panels that are to be shown with the engine."""
    for panel in _subclasses(bpy.types.Panel):
        engines = getattr(panel, "COMPAT_ENGINES", None)
        name = panel.__name__.removeprefix("NODE_")  # the shader editor's copy of a panel has the very same set
        if isinstance(engines, set) and panel not in CLASSES and name not in _NOT and (
                'BLENDER_RENDER' in engines or name in _ALSO):
            yield panel


def _subclasses(cls):
    for subclass in cls.__subclasses__():
        yield subclass
        yield from _subclasses(subclass)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    for panel in _fitting():
        panel.COMPAT_ENGINES.add(_ENGINE)


def unregister():
    for panel in _subclasses(bpy.types.Panel):
        if panel not in CLASSES:
            getattr(panel, "COMPAT_ENGINES", set()).discard(_ENGINE)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
