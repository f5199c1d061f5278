"""The sidebar's panel of the active object's shell."""

import bpy

from ..gpu import handler
from ..host import shells
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
            _draw_add(layout, context)
            return
        for name in ("map_path", "thickness", "tiles_u", "tiles_v", "levels", "scheme", "traversal", "base_color"):
            layout.prop(settings, name)
        count = shells.prism_count(obj)
        draw_sentence(layout, context, shells.problem(obj) or handler.problem(), 'ERROR')
        if count is not None:
            layout.label(text=f"{count} prisms")
        layout.operator("mesoshell.remove_shell", icon='X')


def _draw_add(layout, context):
    layout.operator_context = 'INVOKE_DEFAULT'
    add = layout.operator("mesoshell.add_shell", text="Add Shell with Baked Map", icon='ADD')
    add.filepath = context.scene.mesoshell.output_path
    layout.operator("mesoshell.add_shell", text="Add Shell from File", icon='FILE_FOLDER')


CLASSES = (MESOSHELL_PT_shell,)


def register():
    bpy.utils.register_class(MESOSHELL_PT_shell)


def unregister():
    bpy.utils.unregister_class(MESOSHELL_PT_shell)
