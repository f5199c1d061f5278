"""The compiled module: found where it should be, with libraries of its own, and missed in one sentence."""

import os
from pathlib import Path

import pytest
import session


def test_functions_come_from_the_modules_own_libraries(native):
    """Blender has an Embree and an OpenSubdiv too: none of ours may have bound to those."""
    own = Path(os.path.realpath(native.__file__)).parent / "mesoshell_native.libs"
    libraries = native.libraries()
    assert libraries
    for name, path in libraries.items():
        assert Path(os.path.realpath(path)).parent == own, f"{name} is served by {path}, not by a library in {own}"


def test_module_is_the_one_to_be_tested(native):
    inside = session.ROOT in Path(os.path.realpath(native.__file__)).parents
    assert inside == (session.package == "source"), native.__file__


def load_anew(part, monkeypatch):
    module = part("core.native")
    monkeypatch.setattr(module, "_module", None)
    monkeypatch.setattr(module, "_problem", None)
    return module


def test_a_folder_without_it_is_named(part, monkeypatch, tmp_path):
    monkeypatch.setenv("MESOSHELL_NATIVE_PATH", str(tmp_path))
    loader = load_anew(part, monkeypatch)
    for _ in range(2):
        with pytest.raises(loader.NativeMissing, match=str(tmp_path)):
            loader.module()


def test_a_broken_one_is_named(part, monkeypatch, tmp_path):
    (tmp_path / "mesoshell_native.abi3.so").write_bytes(b"\x7fELF not really")
    monkeypatch.setenv("MESOSHELL_NATIVE_PATH", str(tmp_path))
    loader = load_anew(part, monkeypatch)
    import sys
    whole = sys.modules.get("mesoshell_native")
    try:
        with pytest.raises(loader.NativeMissing, match="does not load"):
            loader.module()
    finally:
        if whole is not None:
            sys.modules["mesoshell_native"] = whole


def test_missing_it_is_an_operators_report(part, monkeypatch, tmp_path, chain_scene):
    import bpy
    monkeypatch.setenv("MESOSHELL_NATIVE_PATH", str(tmp_path))
    load_anew(part, monkeypatch)
    with pytest.raises(RuntimeError, match=str(tmp_path)):
        bpy.ops.mesoshell.bake(tile=chain_scene.tile.name, filepath=str(tmp_path / "x.exr"))
