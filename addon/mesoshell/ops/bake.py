"""mesoshell.bake: bakes a tile object into a map file.

From a script it runs to its end; invoked from the interface it runs in the background and Esc cancels it.
"""

import os

import bpy
from bpy.props import IntProperty, StringProperty

from ..core import native
from ..core.bake_tile import BakeRequest, bake_tile, check_folder
from ..host import (bake_options, bake_state, chosen_source, paths, sentences, shell_options, source_options,
                    versions)

POLL_SECONDS = 0.1


class MESOSHELL_OT_bake(bake_options.BakeOptions, bpy.types.Operator):
    """Bake the tile into a map file; what is not given is taken from the scene's settings"""

    bl_idname = "mesoshell.bake"
    bl_label = "Bake Tile"
    bl_options = {'REGISTER'}

    tile: StringProperty(name="Tile", description="Name of the tile object", options={'SKIP_SAVE'})
    collection: StringProperty(name="Collection", description="Name of the collection that is the tile",
                               options={'SKIP_SAVE'})
    image: StringProperty(name="Image", description="Name of the image that is the height field, or the path of one",
                          options={'SKIP_SAVE'})
    box: StringProperty(name="Box", description="Name of the empty that shows the tile's period", options={'SKIP_SAVE'})
    filepath: StringProperty(name="Map", subtype='FILE_PATH', options={'SKIP_SAVE'} | versions.PATH_OPTIONS)
    threads: IntProperty(name="Threads", description="0 means all cores", default=0, min=0, options={'SKIP_SAVE'})

    @classmethod
    def poll(cls, context):
        return sentences.poll_message(cls, not bake_state.running(), "A bake is running: wait for it, or cancel it")

    def execute(self, context):
        try:
            request = self._request(context)
        except sentences.expected() as error:
            return self._fail(error)
        manager = context.window_manager
        manager.progress_begin(0, 1000)

        def progress(fraction):
            manager.progress_update(int(1000 * fraction))
            return True

        try:
            result = bake_tile(request, progress)
        except sentences.expected() as error:
            return self._fail(error)
        finally:
            manager.progress_end()
        return self._succeed(result, request)

    def invoke(self, context, event):
        if bpy.app.background or context.window is None:
            return self.execute(context)
        try:
            request = self._request(context)
        except sentences.expected() as error:
            return self._fail(error)
        self._request_made = request
        self._job = bake_state.start(lambda progress: bake_tile(request, progress), f"Baking {request.surface.name}")
        self._timer = context.window_manager.event_timer_add(POLL_SECONDS, window=context.window)
        context.window_manager.modal_handler_add(self)
        self._show(context)
        return {'RUNNING_MODAL'}

    def modal(self, context, event):
        if event.type == 'ESC' and event.value == 'PRESS' and not self._job.done:
            self._job.cancel()
            return {'RUNNING_MODAL'}
        if event.type != 'TIMER':
            return {'PASS_THROUGH'}
        if bake_state.job is not self._job:  # another file was opened, or the add-on was disabled
            self._clean_up(context)
            return {'CANCELLED', 'PASS_THROUGH'}
        if not self._job.done:
            self._show(context)
            return {'PASS_THROUGH'}
        self._clean_up(context)
        if self._job.error is None:
            return self._succeed(self._job.result, self._request_made)
        if self._job.cancelled and isinstance(self._job.error, native.module().Cancelled):
            bake_state.finish(f'The bake of "{self._request_made.surface.name}" was cancelled', False)
            self.report({'WARNING'}, bake_state.report)
            return {'CANCELLED'}
        if isinstance(self._job.error, sentences.expected()):
            return self._fail(self._job.error)
        bake_state.finish(f"The bake failed: {self._job.error}", True)
        raise self._job.error

    def cancel(self, context):
        """Blender ends, or closes the window: the thread ends too, before anything is saved."""
        self._job.cancel()
        if bake_state.job is self._job:
            bake_state.finish(f'The bake of "{self._request_made.surface.name}" was cancelled', False)
        self._clean_up(context)

    def _request(self, context):
        """Copies everything out of Blender; raises what sentences.expected() lists."""
        native.module()
        settings = context.scene.mesoshell

        def value(name):
            given = self.properties.is_property_set(name)
            return getattr(self if given else settings, name)

        path = paths.absolute(self.filepath or settings.output_path)
        check_folder(path)
        surface = chosen_source.read(self._choice(context, value), context.evaluated_depsgraph_get(),
                                     source_options.options(value))
        return BakeRequest(surface=surface, path=path, threads=self.threads, **self.quality(value))

    def _choice(self, context, value):
        """What the call names; what it does not name, the scene does."""
        settings, objects = context.scene.mesoshell, context.scene.objects
        source, image = value("source"), settings.image
        here = f'object in the scene "{context.scene.name}"'
        tile, collection, box = settings.tile, settings.tile_collection, settings.box
        if self.grid_path:
            source, box = 'FILE', None
        if self.image:
            source, image = 'IMAGE', bpy.data.images.get(self.image) or self._image_path()
        if self.collection:
            source, collection = 'COLLECTION', chosen_source.named(bpy.data.collections, self.collection, "collection")
        if self.tile:
            source, tile = 'OBJECT', chosen_source.named(objects, self.tile, here)
            if tile.mesoshell_tile.is_tile:  # its own period, and not that of whatever the scene's box was put around
                box = None
        if self.box:
            box = chosen_source.named(objects, self.box, here)
        return chosen_source.choose(context, source=source, tile=tile, collection=collection, box=box, image=image,
                                    grid_path=value("grid_path"))

    def _image_path(self):
        path = paths.absolute(self.image)
        if not os.path.isfile(path):
            raise ValueError(f'There is no image called "{self.image}", and no file: check the name')
        return path

    def _succeed(self, result, request):
        seconds = sum(result.seconds.values())
        bake_state.learn(request, seconds)
        bake_state.finish(f'Baked "{request.surface.name}" to {result.path} in {seconds:.1f} s: {result.terms} terms, '
                          f"RMSE {result.rmse * request.resolution[0]:.2g} voxels", False, result.notices)
        for notice in result.notices:
            self.report({'WARNING'}, notice)
        self.report({'INFO'}, bake_state.report)
        shell_options.tag_redraw()
        return {'FINISHED'}

    def _fail(self, error):
        bake_state.finish(sentences.of(error), True)
        self.report({'ERROR'}, bake_state.report)
        return {'CANCELLED'}

    def _show(self, context):
        if context.workspace is not None:
            context.workspace.status_text_set(f"{bake_state.title}: {bake_state.fraction():.0%}    Esc: cancel")
        _redraw_sidebars(context)

    def _clean_up(self, context):
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        _redraw_sidebars(context)


def _redraw_sidebars(context):
    """Only the sidebars: drawing the whole view ten times a second would take cores from the bake."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == 'VIEW_3D':
                for region in area.regions:
                    if region.type == 'UI':
                        region.tag_redraw()


def register():
    bpy.utils.register_class(MESOSHELL_OT_bake)


def unregister():
    bpy.utils.unregister_class(MESOSHELL_OT_bake)
