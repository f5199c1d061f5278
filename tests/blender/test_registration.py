"""Registering leaves nothing behind, twice; an old Python gets one sentence."""

import importlib
import sys

import bpy
import pytest


def traces():
    """Everything of Mesoshell that Blender knows."""
    handlers = {f"{name}: {function.__module__}.{function.__name__}" for name in dir(bpy.app.handlers)
                if isinstance(getattr(bpy.app.handlers, name), list) for function in getattr(bpy.app.handlers, name)
                if "mesoshell" in function.__module__}
    properties = {f"{owner.__name__}.{name}" for owner in (bpy.types.Object, bpy.types.Scene, bpy.types.WindowManager)
                  for name in dir(owner) if "mesoshell" in name}
    classes = {name for name in dir(bpy.types) if "mesoshell" in name.lower()}
    operators = set(dir(bpy.ops.mesoshell))
    return handlers, properties, classes, operators


def test_register_and_unregister_twice(addon):
    before = traces()
    assert all(before), "an add-on that is registered is seen"
    for _ in range(2):
        addon.unregister()
        try:
            assert traces() == (set(), set(), set(), set())
        finally:
            addon.register()
        assert traces() == before


def test_a_part_that_fails_takes_the_others_back(addon, part, monkeypatch):
    def fail():
        raise RuntimeError("a part that can not register")
    before = traces()
    addon.unregister()
    try:
        with monkeypatch.context() as patch:
            patch.setattr(part("ui.shell_panel"), "register", fail)
            with pytest.raises(RuntimeError, match="can not register"):
                addon.register()
        assert traces() == (set(), set(), set(), set())
    finally:
        addon.register()
    assert traces() == before


def test_an_old_python_is_told_in_one_sentence(addon, part, monkeypatch, capsys):
    """Enabling does not fail with a traceback, and nothing that needs a newer Python is imported."""
    before = traces()
    addon.unregister()
    parts = {name: module for name, module in sys.modules.items() if name.startswith(addon.__name__ + ".")}
    try:
        with monkeypatch.context() as patch:
            patch.setattr(sys, "version_info", (3, 10, 13, "final", 0))
            for name in parts:
                del sys.modules[name]
            importlib.reload(addon)
            addon.register()
            imported = {name for name in sys.modules if name.startswith(addon.__name__ + ".")}
            addon.unregister()
        assert imported == {f"{addon.__name__}.host", f"{addon.__name__}.host.too_old"}
        assert len(capsys.readouterr().out.strip().splitlines()) == 1
        assert traces() == (set(), set(), set(), set())
    finally:
        for name in [name for name in sys.modules if name.startswith(addon.__name__ + ".")]:
            del sys.modules[name]
        sys.modules.update(parts)
        importlib.reload(addon)
        addon.register()
    assert traces() == before


def test_panels_are_in_the_sidebar(addon):
    panels = [getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("MESOSHELL_PT_")]
    assert len(panels) >= 2
    assert {(panel.bl_space_type, panel.bl_region_type, panel.bl_category) for panel in panels} == {
        ('VIEW_3D', 'UI', "Mesoshell")}
