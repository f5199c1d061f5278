"""mesoshell.cancel_bake: what Esc does, for a button."""

import bpy

from ..host import bake_state


class MESOSHELL_OT_cancel_bake(bpy.types.Operator):
    """Cancel the bake that runs; nothing is saved"""

    bl_idname = "mesoshell.cancel_bake"
    bl_label = "Cancel Bake"
    bl_options = {'INTERNAL'}

    @classmethod
    def poll(cls, context):
        return bake_state.running()

    def execute(self, context):
        bake_state.job.cancel()
        return {'FINISHED'}


def register():
    bpy.utils.register_class(MESOSHELL_OT_cancel_bake)


def unregister():
    bpy.utils.unregister_class(MESOSHELL_OT_cancel_bake)
