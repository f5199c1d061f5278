"""mesoshell.realize: the tile's own triangles warped into an object's shell, as a mesh for Cycles, export or print."""

import bpy
from bpy.props import BoolProperty, FloatProperty, IntProperty, StringProperty

from ..core import realized
from ..host import chosen_source, realizing, sentences, shells, source_options, surfaces

# The map may be another tile's, but its proportions give most mistakes away; stored values are single precision.
_SAME_PROPORTIONS = 1e-4


class MESOSHELL_OT_realize(bpy.types.Operator):
    """Make a mesh of the active object's shell: the tile, bent onto the surface, with its materials, colors and UVs"""

    bl_idname = "mesoshell.realize"
    bl_label = "Realize"
    bl_options = {'REGISTER', 'UNDO'}

    object: StringProperty(name="Object", description="Name of an object with a shell; the active one if empty",
                           options={'SKIP_SAVE'})
    tile: StringProperty(name="Tile", description="Name of the tile object that the map was baked from; if empty, the "
                         "source that the scene's settings name", options={'SKIP_SAVE'})
    error: FloatProperty(name="Error", description="How far edges may lie beside the curves that the shell makes of them, in "
                         "tile widths", default=0.001, min=1e-5, soft_max=0.1, precision=4, options={'SKIP_SAVE'})
    caps: BoolProperty(name="Caps", description="Close the solid where the tile's height, the border of the shell and seams "
                       "cut it", default=True, options={'SKIP_SAVE'})
    most_triangles: IntProperty(name="Most Triangles", description="Refuse to make more than about so many, in millions",
                                default=20, min=1, soft_max=100, options={'SKIP_SAVE'})
    threads: IntProperty(name="Threads", description="0 means all cores", default=0, min=0, options={'SKIP_SAVE'})

    def execute(self, context):
        manager = context.window_manager
        manager.progress_begin(0, 1000)

        def progress(fraction):
            manager.progress_update(int(1000 * fraction))
            return True

        try:
            obj = surfaces.with_shell(context, self.object)
            depsgraph = context.evaluated_depsgraph_get()
            instance = shells.one(obj, depsgraph)
            if instance is None:
                raise ValueError(shells.problem(obj))
            surface = self._tile(context, depsgraph)
            self._check(obj, instance, surface)
            made = realized.realize(instance.shell, surface, error=self.error, caps=self.caps, threads=self.threads,
                                    progress=progress)
            self._check_count(obj, instance, len(made.triangles))
            mesh_object = realizing.add_object(obj, made, surface, f"{obj.name} Mesostructure")
        except sentences.expected() as error:
            self.report({'ERROR'}, sentences.of(error))
            return {'CANCELLED'}
        finally:
            manager.progress_end()
        realizing.activate(context, mesh_object)
        for notice in made.notices:
            self.report({'WARNING'}, notice)
        self.report({'INFO'}, f'"{mesh_object.name}" has {len(made.triangles):,} triangles of {instance.shell.prism_count:,} '
                              f'prisms with the tile "{surface.name}"')
        return {'FINISHED'}

    def _tile(self, context, depsgraph):
        settings = context.scene.mesoshell
        if self.tile:
            tile = chosen_source.named(context.scene.objects, self.tile, f'object in the scene "{context.scene.name}"')
            box = None if tile.mesoshell_tile.is_tile else settings.box
            choice = chosen_source.choose(context, source='OBJECT', tile=tile, box=box)
        else:
            choice = chosen_source.from_scene(context)
        return chosen_source.read(choice, depsgraph, source_options.from_scene(context))

    def _check(self, obj, instance, surface):
        shown = instance.map
        if (abs(shown.height - surface.height) > _SAME_PROPORTIONS * shown.height
                or abs(shown.aspect - surface.aspect) > _SAME_PROPORTIONS * shown.aspect):
            self.report({'WARNING'}, f'The shell of "{obj.name}" shows a tile {shown.height:.4g} high and {shown.aspect:.4g} '
                                     f'long, "{surface.name}" is {surface.height:.4g} high and {surface.aspect:.4g} long: '
                                     "it looks different from what is drawn")
        self._check_count(obj, instance, realized.estimated_triangles(instance.shell.prisms, surface))

    def _check_count(self, obj, instance, count):
        if count > self.most_triangles * 1_000_000:
            raise ValueError(f'"{obj.name}" would be {count:,} triangles or more in {instance.shell.prism_count:,} prisms: use '
                             "fewer tiles, a simpler tile or fewer subdivision levels, or raise Most Triangles "
                             f"({self.most_triangles} million)")


def register():
    bpy.utils.register_class(MESOSHELL_OT_realize)


def unregister():
    bpy.utils.unregister_class(MESOSHELL_OT_realize)
