"""Runs in a Blender of its own, with a window: shows each panel in each state and writes what its drawing met.

    blender --python panels.py -- MAP FOLDER RESULT
"""

import json
import os
import sys
import time
import traceback
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import scenes  # noqa: E402
import session  # noqa: E402

map_file, folder, result = sys.argv[sys.argv.index("--") + 1:]
session.module_name = session.enable(os.environ["MESOSHELL_TEST_PACKAGE"])
bake_state, jobs, shells = (session.part(name) for name in ("host.bake_state", "core.jobs", "host.shells"))
bpy.context.preferences.view.show_splash = False
CLASSES = [*session.part("ui.bake_panel").CLASSES, *session.part("ui.shell_panel").CLASSES]
OF_SHELLS = [*session.part("ui.shell_panel").CLASSES, *session.part("ui.shell_subpanels").CLASSES]
OF_SOURCES = CLASSES[:2]  # what the source changes
drawn, errors = [], []
state = "start"


def watch(cls):
    """Records each drawing of a panel, and what it raises (Blender would only print it)."""
    draw = cls.draw

    def watched(self, context):
        drawn.append((state, cls.__name__))
        try:
            draw(self, context)
        except BaseException:
            errors.append([state, cls.__name__, traceback.format_exc()])
    cls.draw = watched


def show(name, classes=CLASSES):
    global state
    state = name
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == 'VIEW_3D')
    region = next(region for region in area.regions if region.type == 'WINDOW')
    with bpy.context.temp_override(window=window, screen=window.screen, area=area, region=region):
        for cls in classes:
            bpy.ops.wm.call_panel('INVOKE_DEFAULT', name=cls.__name__, keep_open=True)
            bpy.ops.wm.redraw_timer(type='DRAW_WIN_SWAP', iterations=1)


def states():
    for cls in CLASSES:
        watch(cls)
    settings, view_layer = bpy.context.scene.mesoshell, bpy.context.view_layer
    view_layer.objects.active = None
    show("nothing active")
    settings.tile, torus = scenes.make_tile("SphereTile"), scenes.make_torus("MailTorus")
    view_layer.objects.active = torus
    show("a tile and a surface")
    show_sources(settings)
    bake_state.start(until_cancelled, "Baking SphereTile")
    show("a bake that runs")
    jobs.cancel_all()
    bake_state.finish("A long sentence that says what went wrong and what to do about it, on several lines", True)
    show("a bake that failed")
    view_layer.update()
    bpy.ops.mesoshell.add_shell(object="MailTorus", filepath=map_file)
    shells.visible(bpy.context.evaluated_depsgraph_get())
    show("a shell")
    torus.mesoshell.map_path = os.path.join(folder, "lost.exr")
    shells.visible(bpy.context.evaluated_depsgraph_get())
    show("a shell that lost its map")


def show_sources(settings):
    """Each source has fields of its own, and so has what is done to it."""
    settings.source = 'SELECTION'
    show("the selection", OF_SOURCES)
    tile, settings.source = settings.tile, 'OBJECT'
    settings.tile = bpy.data.objects.new("Smoke", bpy.data.volumes.new("Smoke"))
    show("a volume", OF_SOURCES)
    settings.source, settings.tile, settings.periodic = 'COLLECTION', tile, 'MIRROR'
    settings.tile_collection = bpy.data.collections.new("Parts")
    show("a collection that is mirrored", OF_SOURCES)
    settings.source, settings.copies, settings.periodic = 'IMAGE', 3, 'NONE'
    settings.image = bpy.data.images.new("Relief", 4, 4)
    show("an image that is varied", OF_SOURCES)
    settings.source, settings.copies, settings.periodic, settings.grid_path = 'FILE', 1, 'BLEND', "//grid.npy"
    show("an array that is blended", OF_SOURCES)
    settings.grid_path = "//grid.vdb"
    show("a file of grids", OF_SOURCES)
    settings.source = 'OBJECT'
    show("an object that can not be blended", OF_SOURCES)
    settings.periodic = 'NONE'


def until_cancelled(progress):
    while progress(0.4):
        time.sleep(0.05)  # as often as the native module asks


def run():
    try:
        states()
    except BaseException:
        errors.append(["run", "", traceback.format_exc()])
    Path(result).write_text(json.dumps({"drawn": drawn, "errors": errors}))
    os._exit(0)


bpy.app.timers.register(run, first_interval=0.5)
