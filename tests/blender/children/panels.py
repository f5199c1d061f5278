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
bake_state, jobs, shells, shell_options = (session.part(name) for name in (
    "host.bake_state", "core.jobs", "host.shells", "host.shell_options"))
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
    for cls in [*CLASSES, *OF_SHELLS[1:]]:
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
    torus.hide_set(True)  # to draw it takes longer than all panels
    show_shells(torus)
    torus.mesoshell.map_path = os.path.join(folder, "lost.exr")
    shells.one(torus, bpy.context.evaluated_depsgraph_get())
    show("a shell that lost its map", OF_SHELLS)
    bare = scenes.make_object("Bare", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [[0, 1, 2]])
    view_layer.objects.active = bare
    show("a surface without UVs", OF_SHELLS[:1])
    bare.mesoshell.map_path, bare.mesoshell.enabled = map_file, True
    view_layer.update()
    shells.visible(bpy.context.evaluated_depsgraph_get())
    show("a shell without UVs", OF_SHELLS)


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


def show_shells(torus):
    """Each choice of a shell's has fields of its own; so has each overlay, and what was found."""
    settings, overlays = torus.mesoshell, bpy.context.scene.mesoshell_overlays
    for name, items in (("part", shell_options.PARTS), ("refine", shell_options.REFINEMENTS),
                        ("subdivision", shell_options.SUBDIVISIONS)):
        default = getattr(settings, name)
        for identifier, *_ in items:
            setattr(settings, name, identifier)
            show(f"a shell whose {name} is {identifier}", OF_SHELLS[1:2])
        setattr(settings, name, default)
    settings.fit_thickness = True
    show("a shell that fits its tile", OF_SHELLS[:1])
    settings.fit_thickness = False
    bpy.ops.mesoshell.check_shell(object=torus.name)
    show("a shell that was checked", OF_SHELLS)
    for name in ("show_prisms", "show_folds", "show_seams", "show_stretch"):
        setattr(overlays, name, True)
    overlays.measure = "angle"
    show("a shell under all overlays", OF_SHELLS)
    for name in ("show_prisms", "show_folds", "show_seams", "show_stretch", "measure"):
        # Not the group as a whole: Blender frees it then, and the panels shown so far stay open and draw it again.
        overlays.property_unset(name)


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
