"""mesoshell.remove_shell: takes the shell off an object."""

import bpy
from bpy.props import StringProperty

from ..host import shell_options


class MESOSHELL_OT_remove_shell(bpy.types.Operator):
    """Take the shell off the active object and forget its settings; the map's file stays"""

    bl_idname = "mesoshell.remove_shell"
    bl_label = "Remove Shell"
    bl_options = {'REGISTER', 'UNDO'}

    object: StringProperty(name="Object", description="Name of an object; the active one if empty",
                           options={'SKIP_SAVE'})

    def execute(self, context):
        obj = context.scene.objects.get(self.object) if self.object else context.view_layer.objects.active
        if obj is None:
            named = f'no object "{self.object}" in the scene' if self.object else "no active object"
            self.report({'ERROR'}, f"There is {named}: select the surface, or give its name")
            return {'CANCELLED'}
        if not obj.mesoshell.enabled:
            self.report({'ERROR'}, f'"{obj.name}" has no shell: pick an object that has one')
            return {'CANCELLED'}
        settings = obj.mesoshell
        # One by one: unset as a whole, Blender frees the group, and a panel that is still open would draw freed memory.
        for setting in settings.bl_rna.properties:
            if not setting.is_readonly:
                settings.property_unset(setting.identifier)
        shell_options.tag_redraw()
        return {'FINISHED'}


def register():
    bpy.utils.register_class(MESOSHELL_OT_remove_shell)


def unregister():
    bpy.utils.unregister_class(MESOSHELL_OT_remove_shell)
