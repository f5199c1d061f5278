"""mesoshell.add_shell: puts a baked map on a mesh object."""

import bpy
from bpy.props import FloatProperty, StringProperty

from ..host import (chosen_source, map_cache, meshes, paths, sentences, shell_building, shell_keys, shell_options, shells,
                    surfaces, versions)


class MESOSHELL_OT_add_shell(shell_options.ShellOptions, bpy.types.Operator):
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
    thickness_image: StringProperty(name="Image", description="Name of the image whose red channel multiplies the thickness",
                                    options={'SKIP_SAVE'})

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
        obj = surfaces.of_operator(context, self.object)
        image = chosen_source.named(bpy.data.images, self.thickness_image, "image") if self.thickness_image else None
        try:
            loaded_map = map_cache.load(map_cache.file_state(paths.absolute(self.filepath, obj)))
        except sentences.expected() as error:
            raise ValueError(f'No shell on "{obj.name}": {sentences.of(error)}') from error
        depsgraph = context.evaluated_depsgraph_get()
        # Built before anything is changed, so that a failure leaves the object as it was.
        fits = self.fit_thickness or self.thickness == 0.0
        key = shell_keys.read(obj, depsgraph, lambda name: getattr(self, name), map_path=self.filepath,
                              thickness=None if fits else self.thickness, image=image)
        surface = meshes.read_surface(obj, depsgraph, key.reading)
        built = shell_building.build(obj, surface, key, loaded_map.map, image)
        settings = obj.mesoshell
        for name in shell_options.NAMES:
            setattr(settings, name, getattr(self, name))
        settings.map_path, settings.thickness, settings.thickness_image = self.filepath, built.fit.thickness, image
        settings.enabled = True
        # As the object's own settings ask for it, so that the shell built here is the one that is drawn.
        shells.adopt(obj, depsgraph, shell_keys.of_object(obj, depsgraph), built, loaded_map)


def register():
    bpy.utils.register_class(MESOSHELL_OT_add_shell)


def unregister():
    bpy.utils.unregister_class(MESOSHELL_OT_add_shell)
