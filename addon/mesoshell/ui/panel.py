"""The Mesoshell tab of the 3D view's sidebar."""

import textwrap

import bpy

from ..gpu import handler
from ..host import bake_state, shells, versions


class MesoshellPanel:
    bl_space_type = 'VIEW_3D'
    bl_region_type = 'UI'
    bl_category = "Mesoshell"


class MESOSHELL_PT_bake(MesoshellPanel, bpy.types.Panel):
    bl_label = "Bake"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.mesoshell
        layout.prop(settings, "tile")
        if settings.tile is not None:
            _draw_tile(layout, settings.tile)
        layout.prop(settings, "output_path")
        if bake_state.running():
            versions.draw_progress(layout, f"{bake_state.title}: {bake_state.fraction():.0%}", bake_state.fraction(),
                                   context.window_manager, "mesoshell_bake_fraction")
            layout.operator("mesoshell.cancel_bake", text="Cancel (Esc)", icon='CANCEL')
            return
        layout.operator_context = 'INVOKE_DEFAULT'
        layout.operator("mesoshell.bake", text="Bake", icon='RENDER_STILL')
        _draw_sentence(layout, context, bake_state.report, 'ERROR' if bake_state.failed else 'INFO')


class MESOSHELL_PT_bake_quality(MesoshellPanel, bpy.types.Panel):
    bl_label = "Quality"
    bl_parent_id = "MESOSHELL_PT_bake"
    bl_options = {'DEFAULT_CLOSED'}

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.mesoshell
        for name in ("resolution", "directions", "sdf_resolution", "terms", "precision"):
            layout.prop(settings, name)


class MESOSHELL_PT_shell(MesoshellPanel, bpy.types.Panel):
    bl_label = "Shell"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        obj = context.view_layer.objects.active
        if obj is None or obj.type != 'MESH':
            layout.label(text="Select a mesh object", icon='INFO')
            return
        settings = obj.mesoshell
        if not settings.enabled:
            _draw_add(layout, context)
            return
        for name in ("map_path", "thickness", "tiles_u", "tiles_v", "levels", "scheme", "traversal", "base_color"):
            layout.prop(settings, name)
        count = shells.prism_count(obj)
        _draw_sentence(layout, context, shells.problem(obj) or handler.problem(), 'ERROR')
        if count is not None:
            layout.label(text=f"{count} prisms")
        layout.operator("mesoshell.remove_shell", icon='X')


def _draw_tile(layout, tile):
    settings = tile.mesoshell_tile
    layout.prop(settings, "is_tile")
    column = layout.column(align=True)
    column.active = settings.is_tile
    for name in ("period_u", "period_v", "height"):
        column.prop(settings, name)


def _draw_add(layout, context):
    layout.operator_context = 'INVOKE_DEFAULT'
    add = layout.operator("mesoshell.add_shell", text="Add Shell with Baked Map", icon='ADD')
    add.filepath = context.scene.mesoshell.output_path
    layout.operator("mesoshell.add_shell", text="Add Shell from File", icon='FILE_FOLDER')


def _draw_sentence(layout, context, sentence, icon):
    """A sentence in as many lines as the sidebar's width asks for."""
    if not sentence:
        return
    column = layout.column(align=True)
    width = context.region.width if context.region is not None else 240  # a panel in a popover has no region
    characters = max(20, int(width / (7.5 * context.preferences.system.ui_scale)))
    for index, line in enumerate(textwrap.wrap(sentence, characters)):
        column.label(text=line, icon=icon if index == 0 else 'BLANK1')


CLASSES = (MESOSHELL_PT_bake, MESOSHELL_PT_bake_quality, MESOSHELL_PT_shell)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
