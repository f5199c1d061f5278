"""mesoshell.check_shell: counts folds, cut seams and what else is wrong with a shell."""

import bpy
from bpy.props import StringProperty

from ..host import sentences, shell_checks, shells, surfaces


class MESOSHELL_OT_check_shell(bpy.types.Operator):
    """Count what is wrong with the active object's shell: folds, cut seams, UVs without area and stretch"""

    bl_idname = "mesoshell.check_shell"
    bl_label = "Check Shell"
    bl_options = {'REGISTER'}

    object: StringProperty(name="Object", description="Name of an object; the active one if empty",
                           options={'SKIP_SAVE'})

    def execute(self, context):
        try:
            obj = surfaces.with_shell(context, self.object)
            instance = shells.one(obj, context.evaluated_depsgraph_get())
            if instance is None:
                raise ValueError(shells.problem(obj))
            report = shell_checks.check(obj, instance)
        except sentences.expected() as error:
            self.report({'ERROR'}, sentences.of(error))
            return {'CANCELLED'}
        self.report({'WARNING' if report.folds or report.without_area else 'INFO'}, report.sentence(obj.name))
        return {'FINISHED'}


def register():
    bpy.utils.register_class(MESOSHELL_OT_check_shell)


def unregister():
    bpy.utils.unregister_class(MESOSHELL_OT_check_shell)
