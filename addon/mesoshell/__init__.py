"""Mesoshell: chain mail, weave and scales on any surface, drawn per pixel in the viewport."""

import importlib
import sys

import bpy

bl_info = {
    "name": "Mesoshell",
    "author": "Mesoshell contributors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Mesoshell",
    "description": "Bakes one periodic tile and draws it as a shell on any surface",
    "category": "3D View",
}

# In order of registration; each has register() and unregister().
NAMES = [
    "host.properties",
    "host.overlay_options",
    "host.bake_options",
    "host.render_options",
    "host.shells",
    "host.bake_state",
    "ops.add_tile_box",
    "ops.snap_tile_box",
    "ops.bake",
    "ops.cancel_bake",
    "ops.add_shell",
    "ops.remove_shell",
    "ops.check_shell",
    "ops.unwrap",
    "ops.realize",
    "ui.bake_panel",
    "ui.shell_panel",
    "ui.shell_subpanels",
    "engine.engine",
    "ui.engine_panels",
]
if not bpy.app.background:
    NAMES.append("gpu.handler")
if sys.version_info < (3, 11):
    NAMES = ["host.too_old"]

_registered = []


def register():
    try:
        for name in NAMES:
            module = importlib.import_module("." + name, __package__)
            module.register()
            _registered.append(module)
    except Exception:
        unregister()
        raise


def unregister():
    while _registered:
        _registered.pop().unregister()
