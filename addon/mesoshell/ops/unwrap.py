"""mesoshell.unwrap: gives a surface UVs, in whatever mode it is and whatever is selected."""

import math

import bpy
from bpy.props import EnumProperty, FloatProperty, StringProperty

from ..host import sentences, shell_options, surfaces, unwrapping


class MESOSHELL_OT_unwrap(bpy.types.Operator):
    """Unwrap the whole mesh, so that it can carry a shell; mode and selection stay as they are"""

    bl_idname = "mesoshell.unwrap"
    bl_label = "Unwrap for the Shell"
    bl_options = {'REGISTER', 'UNDO'}

    object: StringProperty(name="Object", description="Name of a mesh object; the active one if empty",
                           options={'SKIP_SAVE'})
    method: EnumProperty(name="Method", items=unwrapping.METHODS, default='SMART')
    angle_limit: FloatProperty(name="Angle Limit", description="Of faces in one island of Smart Project", subtype='ANGLE',
                               default=math.radians(66.0), min=0.0, max=math.radians(89.0))
    margin: FloatProperty(name="Margin", description="Between islands", default=0.0, min=0.0, max=1.0)

    def execute(self, context):
        try:
            obj = surfaces.of_operator(context, self.object)
            unwrapping.unwrap(obj, self.method, angle_limit=self.angle_limit, margin=self.margin)
        except (*sentences.expected(), RuntimeError) as error:
            self.report({'ERROR'}, sentences.of(error))
            return {'CANCELLED'}
        shell_options.tag_redraw()
        return {'FINISHED'}


def register():
    bpy.utils.register_class(MESOSHELL_OT_unwrap)


def unregister():
    bpy.utils.unregister_class(MESOSHELL_OT_unwrap)
