"""Fixtures of the tests inside Blender, and which of them run in which session.

Unmarked tests run in the background and in a window. `window` tests need a window and its event loop; `gpu` tests need
the gpu module: a window, or Blender 5.2 and later in the background.
"""

import subprocess
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
import scenes
import session

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"


def pytest_configure(config):
    config.addinivalue_line("markers", "window: needs a window and its event loop")
    config.addinivalue_line("markers", "gpu: needs the gpu module")


def pytest_collection_modifyitems(config, items):
    """Leaves tests that belong to another session to that session (deselected, with a line that says so)."""
    selected, left = [], []
    for item in items:
        other = session.mode == "background" and (
            item.get_closest_marker("window") or (item.get_closest_marker("gpu") and session.gpu_problem))
        (left if other else selected).append(item)
    items[:] = selected
    if left:
        config.hook.pytest_deselected(items=left)
        print(f"\n{len(left)} tests are left to a session with a window: {session.gpu_problem or 'marked `window`'}")


@pytest.fixture(scope="session")
def addon():
    """The add-on's package, whatever its name is here."""
    return session.addon()


@pytest.fixture(scope="session")
def native(addon):
    """The compiled module, found as the add-on finds it."""
    return session.part("core.native").module()


@pytest.fixture(scope="session")
def part():
    """part("host.shells"): a module of the add-on."""
    return session.part


@pytest.fixture(scope="session")
def made_samples(tmp_path_factory):
    """The folder of what make_samples.py, run by this very Blender as its first lines say, makes."""
    folder = tmp_path_factory.mktemp("samples")
    subprocess.run(
        [bpy.app.binary_path, "--background", "--factory-startup", "--python-exit-code", "1",
         "--python", str(SAMPLES / "make_samples.py"), "--", "--out", str(folder)],
        check=True, timeout=240)
    assert sorted(path.name for path in folder.iterdir()) == ["chain_torus.blend", "lizard.blend", "tiles.blend"]
    return folder


@pytest.fixture
def fresh():
    """The scene as it was, but for what the test adds; all that is removed afterwards."""
    before = scenes.everything()
    yield bpy.context.scene
    scenes.restore(before)


@pytest.fixture
def chain_scene(fresh):
    """A tile (a lattice of spheres) and a torus with UVs: see scenes.make_tile and scenes.make_torus."""
    tile = scenes.make_tile("SphereTile")
    torus = scenes.make_torus("MailTorus")
    bpy.context.view_layer.update()
    return SimpleNamespace(tile=tile, torus=torus, scene=fresh)


@pytest.fixture(scope="session")
def map_file(tmp_path_factory, native):
    """A small map of the lattice of spheres, baked once through the operator; all terms, so that nothing is truncated."""
    before = scenes.everything()
    path = tmp_path_factory.mktemp("maps") / "spheres.gdm.exr"
    tile = scenes.make_tile("SphereTileOnce")
    bpy.context.view_layer.update()
    assert bpy.ops.mesoshell.bake(tile=tile.name, filepath=str(path), **scenes.SMALL_BAKE) == {'FINISHED'}
    scenes.restore(before)
    return path


@pytest.fixture
def rng():
    return np.random.default_rng(2)
