"""The render engine "Mesoshell": F12 and animations by the reference renderer, with a GPU or without.

`update` reads the scene, while Blender keeps the viewports from drawing it; `render` touches no scene data, so that a user
may go on. The viewport's Rendered mode is not the engine's: it shows the shells that the draw handler draws, and a sentence.
"""

import blf
import bpy

from ..core import native
from ..host import sentences
from . import frame, passes

_NOTICE = "Mesoshell renders with F12: choose Solid or Material Preview to see the whole scene here"


class MesoshellRenderEngine(bpy.types.RenderEngine):
    bl_idname = "MESOSHELL"
    bl_label = "Mesoshell"
    bl_use_preview = False
    bl_use_eevee_viewport = True  # for Material Preview
    bl_use_shading_nodes_custom = False  # materials have Blender's own nodes

    def update_render_passes(self, scene=None, renderlayer=None):
        passes.register(self, scene, renderlayer)

    def update(self, data=None, depsgraph=None):
        self.update_stats("", "Reading the scene")
        self.frame, self.problem = None, None
        try:
            self.frame = frame.read(depsgraph, (self.resolution_x, self.resolution_y))
        except sentences.expected() as error:
            self.problem = sentences.of(error)

    def render(self, depsgraph):
        if self.frame is None:
            if self.problem is not None:  # without one, update() has raised, and Blender has printed that
                self.report({'ERROR'}, self.problem)
            return
        for notice in self.frame.notices:
            self.report({'WARNING'}, notice)
        self.update_stats("", f"Rendering {self.frame.sentence()}")
        layer, depth_start = depsgraph.view_layer.name, self.frame.depth_start

        def show(x, y, width, height, color):
            self._fill((x, y), (width, height), layer, {"color": color}, depth_start)

        size = self.frame.arguments["size"]
        try:
            picture = native.module().render_scene(**self.frame.arguments, progress=self._progress,
                                                   on_tile=None if bpy.app.background else show)
        except sentences.expected() as error:
            if not isinstance(error, native.module().Cancelled):
                self.report({'ERROR'}, sentences.of(error))
            return
        finally:
            self.frame = None  # the arrays of a large scene; the engine may live as long as the picture is shown
        self._fill((0, 0), size, layer, picture, depth_start)

    def _fill(self, first, size, layer, picture, depth_start):
        """Puts a part of the picture, from the pixel `first` on, into Blender's, which is that of the render border."""
        result = self.begin_result(*first, *size, layer=layer)
        passes.fill(result.layers[0].passes, picture, depth_start)
        self.end_result(result)

    def _progress(self, fraction):
        self.update_progress(fraction)
        return not self.test_break()

    def view_update(self, context, depsgraph):
        pass

    def view_draw(self, context, depsgraph):
        scale = context.preferences.system.ui_scale
        blf.size(0, 12 * scale)
        blf.color(0, 1.0, 1.0, 1.0, 1.0)
        blf.position(0, 20 * scale, 20 * scale, 0)
        blf.draw(0, _NOTICE)


def register():
    bpy.utils.register_class(MesoshellRenderEngine)


def unregister():
    bpy.utils.unregister_class(MesoshellRenderEngine)
