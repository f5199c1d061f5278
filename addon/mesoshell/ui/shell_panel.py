"""The sidebar's panel of the active object's shell; what it is made of in detail is in ui/shell_subpanels.py."""

import bpy

from ..gpu import handler
from ..host import meshes, shells
from .parts import SidebarPanel, draw_sentence, split_layout


class MESOSHELL_PT_shell(SidebarPanel, bpy.types.Panel):
    bl_label = "Shell"

    def draw(self, context):
        layout = split_layout(self)
        obj = context.view_layer.objects.active
        if obj is None or obj.type != 'MESH':
            layout.label(text="Select a mesh object", icon='INFO')
            return
        settings = obj.mesoshell
        if not settings.enabled:
            _draw_add(layout, context, obj)
            return
        layout.prop(settings, "map_path")
        column = layout.column(align=True)
        if settings.fit_thickness:
            _draw_fitted(column, shells.thickness(obj))
        else:
            column.prop(settings, "thickness")
        column.prop(settings, "fit_thickness")
        layout.prop(settings, "traversal")
        layout.prop(settings, "base_color")
        draw_sentence(layout, context, shells.problem(obj) or handler.problem(), 'ERROR')
        if shells.needs_unwrap(obj):
            _draw_unwrap(layout)
        count = shells.prism_count(obj)
        if count is not None:
            layout.label(text=f"{count:,} prisms")
        layout.operator("mesoshell.realize", icon='MESH_DATA')
        layout.operator("mesoshell.remove_shell", icon='X')


def _draw_add(layout, context, obj):
    if not obj.data.is_editmode and meshes.render_layer(obj.data) is None and len(obj.data.polygons) > 0:
        draw_sentence(layout, context, f'"{obj.name}" has no UVs, which say where tiles go', 'INFO')
        _draw_unwrap(layout)
    layout.operator_context = 'INVOKE_DEFAULT'
    add = layout.operator("mesoshell.add_shell", text="Add Shell with Baked Map", icon='ADD')
    add.filepath = context.scene.mesoshell.output_path
    layout.operator("mesoshell.add_shell", text="Add Shell from File", icon='FILE_FOLDER')


def _draw_fitted(layout, thickness):
    row = layout.row()
    row.use_property_split = False
    split = row.split(factor=0.4)
    name = split.row()
    name.alignment = 'RIGHT'
    name.label(text="Thickness")
    split.label(text="" if thickness is None else f"{thickness:.4g}")


def _draw_unwrap(layout):
    row = layout.row(align=True)
    row.operator("mesoshell.unwrap", icon='UV').method = 'SMART'
    row.operator_menu_enum("mesoshell.unwrap", "method", text="", icon='DOWNARROW_HLT')


CLASSES = (MESOSHELL_PT_shell,)


def register():
    bpy.utils.register_class(MESOSHELL_PT_shell)


def unregister():
    bpy.utils.unregister_class(MESOSHELL_PT_shell)
