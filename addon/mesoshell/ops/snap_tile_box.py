"""mesoshell.snap_tile_box: the tile box to the bounds of the source."""

import bpy
import numpy as np
from bpy.props import BoolProperty

from ..host import chosen_source, sentences, source_options, tile_box


class MESOSHELL_OT_snap_tile_box(bpy.types.Operator):
    """Move and scale the tile box to the bounds of the source, modifiers and instances included; its rotation stays"""

    bl_idname = "mesoshell.snap_tile_box"
    bl_label = "Snap to Bounds"
    bl_options = {'REGISTER', 'UNDO'}

    # A tile's period is often shorter than its geometry is long, its height seldom.
    along_u: BoolProperty(name="Along U", default=True, options={'SKIP_SAVE'})
    along_v: BoolProperty(name="Along V", default=True, options={'SKIP_SAVE'})
    along_w: BoolProperty(name="Along W", default=True, options={'SKIP_SAVE'})

    @classmethod
    def poll(cls, context):
        return sentences.poll_message(cls, context.scene.mesoshell.box is not None, "Add a tile box first, or pick one")

    def execute(self, context):
        empty = context.scene.mesoshell.box
        try:
            depsgraph = context.evaluated_depsgraph_get()
            axes = tile_box.frame(empty.matrix_world)
            choice, options = chosen_source.from_scene(context), source_options.from_scene(context)
            low, high = chosen_source.bounds(choice, axes, depsgraph, options)
        except sentences.expected() as error:
            self.report({'ERROR'}, sentences.of(error))
            return {'CANCELLED'}
        snapped = np.array([self.along_u, self.along_v, self.along_w])
        if not snapped.all():
            matrix = np.array(empty.matrix_world, np.float64)
            center = matrix[:3, 3] @ axes
            half = np.linalg.norm(matrix[:3, :3], axis=0) * empty.empty_display_size
            low, high = np.where(snapped, low, center - half), np.where(snapped, high, center + half)
        tile_box.place(empty, axes, low, high)
        return {'FINISHED'}


def register():
    bpy.utils.register_class(MESOSHELL_OT_snap_tile_box)


def unregister():
    bpy.utils.unregister_class(MESOSHELL_OT_snap_tile_box)
