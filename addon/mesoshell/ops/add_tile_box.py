"""mesoshell.add_tile_box: an empty that shows the tile's period, made around the source."""

import bpy

from ..host import chosen_source, sentences, source_options, tile_box

_DISPLAY_SIZE = 0.5  # so that the empty's scale is the box's size


class MESOSHELL_OT_add_tile_box(bpy.types.Operator):
    """Add the box that is one period of the tile: an empty around the source, to move, turn and scale as any object"""

    bl_idname = "mesoshell.add_tile_box"
    bl_label = "Add Tile Box"
    bl_options = {'REGISTER', 'UNDO'}

    def execute(self, context):
        try:
            choice = chosen_source.from_scene(context)
            depsgraph = context.evaluated_depsgraph_get()
            axes = chosen_source.axes_of(choice)
            low, high = chosen_source.bounds(choice, axes, depsgraph, source_options.from_scene(context))
        except sentences.expected() as error:
            self.report({'ERROR'}, sentences.of(error))
            return {'CANCELLED'}
        empty = bpy.data.objects.new(f"{choice.name} box", None)
        empty.empty_display_type, empty.empty_display_size = 'CUBE', _DISPLAY_SIZE
        context.scene.collection.objects.link(empty)
        tile_box.place(empty, axes, low, high)
        context.scene.mesoshell.box = empty
        return {'FINISHED'}


def register():
    bpy.utils.register_class(MESOSHELL_OT_add_tile_box)


def unregister():
    bpy.utils.unregister_class(MESOSHELL_OT_add_tile_box)
