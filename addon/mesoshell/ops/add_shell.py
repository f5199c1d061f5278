"""mesoshell.add_shell: puts a baked map on a mesh object."""

import bpy
import numpy as np
from bpy.props import EnumProperty, FloatProperty, IntProperty, StringProperty

from ..host import map_cache, meshes, paths, properties, sentences, shells, versions


class MESOSHELL_OT_add_shell(bpy.types.Operator):
    """Put a baked map on the active object, as a shell on its surface"""

    bl_idname = "mesoshell.add_shell"
    bl_label = "Add Shell"
    bl_options = {'REGISTER', 'UNDO'}

    object: StringProperty(name="Object", description="Name of a mesh object; the active one if empty",
                           options={'SKIP_SAVE'})
    filepath: StringProperty(name="Map", subtype='FILE_PATH', options={'SKIP_SAVE'} | versions.PATH_OPTIONS)
    filter_glob: StringProperty(default="*.exr", options={'HIDDEN', 'SKIP_SAVE'})
    thickness: FloatProperty(name="Thickness", description="In the object's units; 0 keeps the tile's proportions",
                             default=0.0, min=0.0, options={'SKIP_SAVE'})
    levels: IntProperty(name="Levels", description="Subdivisions of the surface", default=0, min=0, max=5,
                        options={'SKIP_SAVE'})
    scheme: EnumProperty(name="Scheme", items=properties.SCHEMES, default="catmark", options={'SKIP_SAVE'})
    tiles_u: FloatProperty(name="Tiles U", default=1.0, min=0.001, options={'SKIP_SAVE'})
    tiles_v: FloatProperty(name="Tiles V", default=1.0, min=0.001, options={'SKIP_SAVE'})
    traversal: EnumProperty(name="Traversal", items=properties.TRAVERSALS, default="sdf", options={'SKIP_SAVE'})

    def invoke(self, context, event):
        if self.filepath:
            return self.execute(context)
        self.filepath = context.scene.mesoshell.output_path
        context.window_manager.fileselect_add(self)
        return {'RUNNING_MODAL'}

    def execute(self, context):
        try:
            self._add(context)
        except sentences.expected() as error:
            self.report({'ERROR'}, sentences.of(error))
            return {'CANCELLED'}
        return {'FINISHED'}

    def _add(self, context):
        obj = self._object(context)
        try:
            state = map_cache.file_state(paths.absolute(self.filepath, obj))
            loaded_map = map_cache.load(state)
        except sentences.expected() as error:
            raise ValueError(f'No shell on "{obj.name}": {sentences.of(error)}') from error
        depsgraph = context.evaluated_depsgraph_get()
        tiles = (self.tiles_u, self.tiles_v)
        thickness = self.thickness
        if thickness == 0.0:
            surface = meshes.read_surface(obj, depsgraph, tiles=tiles)
            # As the property will hold it, so that the shell built here is the one that is drawn.
            thickness = float(np.float32(loaded_map.map.height * meshes.mean_unit_length(surface, obj.name)))
        # Built before anything is changed, so that a failure leaves the object as it was.
        key = shells.build_key(obj, map_path=self.filepath, thickness=thickness, levels=self.levels,
                               scheme=self.scheme, tiles=tiles)
        surface = shells.surface_for(obj, depsgraph, key)
        shell = shells.build(obj, surface, key)
        settings = obj.mesoshell
        settings.map_path, settings.thickness, settings.levels = self.filepath, thickness, self.levels
        settings.scheme, settings.traversal = self.scheme, self.traversal
        settings.tiles_u, settings.tiles_v = tiles
        settings.enabled = True
        shells.adopt(obj, depsgraph, key, surface, shell, loaded_map)

    def _object(self, context):
        if self.object:
            obj = context.scene.objects.get(self.object)
            if obj is None:
                raise ValueError(f'There is no object "{self.object}" in the scene "{context.scene.name}": '
                                 "give the name of a mesh object")
        else:
            obj = context.view_layer.objects.active
            if obj is None:
                raise ValueError("There is no active object: select the surface first, or give its name")
        if obj.type != 'MESH':
            raise ValueError(f'"{obj.name}" is not a mesh: convert it (Object > Convert > Mesh), or pick another object')
        if obj.library is not None:
            raise ValueError(f'"{obj.name}" is linked from another file: make it local, or add the shell there')
        return obj


def register():
    bpy.utils.register_class(MESOSHELL_OT_add_shell)


def unregister():
    bpy.utils.unregister_class(MESOSHELL_OT_add_shell)
