"""Runs in a Blender of its own, with a window: bakes from the event loop, does one thing meanwhile, writes what it saw.

    blender --enable-event-simulate --python modal_bake.py -- ACTION FOLDER RESULT

ACTION: finish, esc, button, undo, load, quit or disable.
"""

import json
import os
import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import scenes  # noqa: E402
import session  # noqa: E402

action, folder, result = sys.argv[sys.argv.index("--") + 1:]
session.module_name = session.enable(os.environ["MESOSHELL_TEST_PACKAGE"])
bake_state = session.part("host.bake_state")
jobs = session.part("core.jobs")
# The splash would be the one to get the Esc; the threads' own turn would hide how well the main one gets its.
bpy.context.preferences.view.show_splash = False

seen = {"action": action, "ticks": [], "fractions": [], "acted_at": None, "error": None}


def window_override():
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == 'VIEW_3D')
    region = next(region for region in area.regions if region.type == 'WINDOW')
    return bpy.context.temp_override(window=window, screen=window.screen, area=area, region=region)


def start():
    tile = scenes.make_tile("SphereTile")
    bpy.context.view_layer.update()
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "before.blend"))
    with window_override():
        bpy.ops.ed.undo_push(message="tile")
        tile.location.x += 1.0
        bpy.ops.ed.undo_push(message="moved")
        # One thread, so that even a fast machine bakes for a while.
        answer = bpy.ops.mesoshell.bake('INVOKE_DEFAULT', tile="SphereTile", filepath=os.path.join(folder, "modal.gdm.exr"),
                                        resolution=(64, 64, 32), directions=(16, 32), sdf_resolution=(32, 40, 27),
                                        terms=4, threads=1)
    seen["answer"] = sorted(answer)
    seen["thread"] = bake_state.job is not None
    bpy.app.timers.register(guarded(tick), persistent=True)


def tick():
    seen["ticks"].append(time.monotonic())
    seen["fractions"].append(bake_state.fraction())
    if not bake_state.running():
        end()
        return None
    if seen["acted_at"] is None and bake_state.fraction() > 0.05:
        seen["acted_at"] = time.monotonic()
        act()
    return 0.02


def act():
    with window_override():
        window = bpy.context.window
        if action == "esc":
            window.event_simulate(type='ESC', value='PRESS', x=600, y=400)
            window.event_simulate(type='ESC', value='RELEASE', x=600, y=400)
        elif action == "button":
            bpy.ops.mesoshell.cancel_bake()
        elif action == "undo":
            bpy.ops.ed.undo()
            seen["undone"] = bpy.data.objects["SphereTile"].location.x
        elif action == "disable":
            session.addon().unregister()
        elif action == "quit":
            write()
            bpy.ops.wm.quit_blender()
    if action == "load":
        bpy.ops.wm.open_mainfile(filepath=os.path.join(folder, "before.blend"))


def end():
    """Once more through the event loop, so that what the operator leaves to it is done; then out."""
    seen["report"], seen["failed"] = bake_state.report, bake_state.failed
    seen["jobs_left"] = len(jobs._running)
    seen["ended_at"] = time.monotonic()
    bpy.app.timers.register(guarded(leave), first_interval=0.5, persistent=True)


def leave():
    seen["jobs_left"] = len(jobs._running)
    write()
    os._exit(0)


def write():
    seen["files"] = sorted(os.listdir(folder))
    Path(result).write_text(json.dumps(seen))


def guarded(call):
    def run():
        try:
            return call()
        except BaseException as error:
            seen["error"] = repr(error)
            write()
            os._exit(1)
    return run


bpy.app.timers.register(guarded(start), first_interval=0.5)
