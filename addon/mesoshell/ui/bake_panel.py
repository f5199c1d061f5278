"""The sidebar's panel of the bake: what the tile is, its box, how fine the map is."""

import bpy

from ..host import bake_state, chosen_source, sentences, versions
from .parts import SidebarPanel, draw_sentence, split_layout

_OF_OBJECTS = {'OBJECT', 'SELECTION', 'COLLECTION'}


class MESOSHELL_PT_bake(SidebarPanel, bpy.types.Panel):
    bl_label = "Bake"

    def draw(self, context):
        layout = split_layout(self)
        settings = context.scene.mesoshell
        _draw_source(layout, context, settings)
        row = layout.row(align=True)
        row.use_property_split = False
        row.prop(settings, "preset", expand=True)
        layout.prop(settings, "output_path")
        if bake_state.running():
            versions.draw_progress(layout, f"{bake_state.title}: {bake_state.fraction():.0%}", bake_state.fraction(),
                                   context.window_manager, "mesoshell_bake_fraction")
            layout.operator("mesoshell.cancel_bake", text="Cancel (Esc)", icon='CANCEL')
            return
        _draw_estimate(layout, context, settings)
        layout.operator_context = 'INVOKE_DEFAULT'
        layout.operator("mesoshell.bake", text="Bake", icon='RENDER_STILL')
        draw_sentence(layout, context, bake_state.report, 'ERROR' if bake_state.failed else 'INFO')
        for notice in bake_state.notices:
            draw_sentence(layout, context, notice, 'DOT')


class MESOSHELL_PT_bake_repetition(SidebarPanel, bpy.types.Panel):
    bl_label = "Borders and Repetition"
    bl_parent_id = "MESOSHELL_PT_bake"
    bl_options = {'DEFAULT_CLOSED'}

    def draw(self, context):
        layout = split_layout(self)
        settings = context.scene.mesoshell
        layout.prop(settings, "periodic")
        if settings.periodic == 'BLEND':
            layout.prop(settings, "blend_width")
            if settings.source in _OF_OBJECTS:
                draw_sentence(layout, context, "Objects can not be blended: choose Mirror", 'ERROR')
        layout.prop(settings, "copies")
        if settings.copies > 1:
            _draw_all(layout, settings, "variation", "seed")
        side = settings.copies * (2 if settings.periodic == 'MIRROR' else 1)
        if side > 1:
            draw_sentence(layout, context, f"Nodes are spread over {side} × {side} copies", 'INFO')


class MESOSHELL_PT_bake_quality(SidebarPanel, bpy.types.Panel):
    bl_label = "Quality"
    bl_parent_id = "MESOSHELL_PT_bake"
    bl_options = {'DEFAULT_CLOSED'}

    def draw(self, context):
        layout = split_layout(self)
        settings = context.scene.mesoshell
        for name in ("resolution", "directions", "sdf_resolution", "facet_cells", "attribute_resolution"):
            layout.prop(settings, name)
        _draw_all(layout, settings, "layout", "terms", "precision")
        layout.prop(settings, "memory_limit")


def _draw_estimate(layout, context, settings):
    try:
        estimate = bake_state.estimated(0, settings.quality(lambda name: getattr(settings, name)))
    except sentences.expected() as error:
        draw_sentence(layout, context, sentences.of(error), 'ERROR')
    else:
        draw_sentence(layout, context, estimate.sentence(), 'TIME' if estimate.plan["blocks"] else 'ERROR')


def _draw_source(layout, context, settings):
    layout.prop(settings, "source")
    if settings.source == 'OBJECT':
        layout.prop(settings, "tile")
    elif settings.source == 'COLLECTION':
        layout.prop(settings, "tile_collection")
    elif settings.source == 'SELECTION':
        layout.label(text=f"{len(context.selected_objects)} objects are selected")
    elif settings.source == 'IMAGE':
        layout.template_ID(settings, "image", open="image.open")
        _draw_all(layout, settings, "height_low", "height_high", "most_nodes")
    else:
        layout.prop(settings, "grid_path")
        array = settings.grid_path.lower().endswith(".npy")
        _draw_all(layout, settings, "threshold", *(("inside", "grid_height") if array else ("grid_name",)))
        if not array:
            layout.prop(settings, "box")
    if settings.source in _OF_OBJECTS:
        if chosen_source.may_be_volume(context):
            _draw_all(layout, settings, "threshold", "grid_name")
        _draw_box(layout, settings)
        layout.prop(settings, "thickness")


def _draw_all(layout, settings, *names):
    column = layout.column(align=True)
    for name in names:
        column.prop(settings, name)


def _draw_box(layout, settings):
    column = layout.column(align=True)
    column.prop(settings, "box")
    if settings.box is not None:
        column.operator("mesoshell.snap_tile_box", icon='SNAP_ON')
        return
    column.operator("mesoshell.add_tile_box", icon='CUBE')
    if settings.source == 'OBJECT' and settings.tile is not None:
        tile = settings.tile.mesoshell_tile
        column = layout.column(align=True)
        column.prop(tile, "is_tile", text="Or the object's own period")
        if tile.is_tile:
            for name in ("period_u", "period_v", "height"):
                column.prop(tile, name)


CLASSES = (MESOSHELL_PT_bake, MESOSHELL_PT_bake_repetition, MESOSHELL_PT_bake_quality)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
