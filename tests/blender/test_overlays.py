"""Overlays against what Embree sees of the same prisms: drawn offscreen, wherever there is a GPU."""

import sys
from pathlib import Path

import bpy
import gpu
import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[1]))
import mail_scenes  # noqa: E402  (shared with the tests outside Blender)

pytestmark = pytest.mark.gpu

SIZE = (320, 320)
TURNED = np.array([[0.9, 0.2, 0.0, 0.1], [-0.2, 1.1, 0.0, 0.0], [0.0, 0.0, 1.2, 0.05], [0.0, 0.0, 0.0, 1.0]])


@pytest.fixture
def settings(fresh):
    """The scene's overlays, opaque and all off."""
    overlays = fresh.mesoshell_overlays
    overlays.fold_color, overlays.base_fold_color, overlays.seam_color = (1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1)
    overlays.prism_color = (1, 1, 1, 1)
    overlays.low_color, overlays.even_color, overlays.high_color = (0, 0, 1, 1), (0, 1, 0, 1), (1, 0, 0, 1)
    yield overlays
    fresh.property_unset("mesoshell_overlays")


@pytest.fixture
def instance(part, native):
    """instance(**found): the chain-mail torus of which host/shell_checks.py has found that already."""
    shells = part("host.shells")
    versions = iter(range(-1000, 0))

    def make(**found):
        look = shells.ShellSettings("sdf", (0.6, 0.5, 0.4, 1.0))
        return shells.ShellInstance("Torus", mail_scenes.torus_shell(native), mail_scenes.chain_map(native), TURNED, look,
                                    next(versions), -1, ("overlays",), found)
    return make


def draw(part, instance, settings, view="above", occluder=None):
    """The overlays alone, color [h, w, 4]."""
    def paint():
        if occluder is not None:
            occluder()
        part("gpu.overlays").draw(instance, settings, mail_scenes.VIEWS[view], SIZE)
    return part("gpu.offscreen").picture([], mail_scenes.VIEWS[view], SIZE, before=paint)[0]


def seen(native, shell, marked, view="above"):
    """Where Embree sees hulls of the marked prisms, bool [h, w]."""
    numbers = np.flatnonzero(marked)
    positions = np.asarray(shell.prisms)[:, :6, :3].reshape(-1, 3)
    triangles = np.asarray(shell.indices)[numbers].reshape(-1, 3).astype(np.int32)
    return native.trace(positions, triangles, clip_from_object=mail_scenes.VIEWS[view] @ TURNED, size=SIZE)["hit"] == 1


def spread(picture, pixels=2):
    """The largest of each pixel's neighbors."""
    steps = range(-pixels, pixels + 1)
    return np.max([np.roll(picture, (dy, dx), axis=(0, 1)) for dy in steps for dx in steps], axis=0)


def projected(points, view="above"):
    """Columns, rows and depths of points in object space."""
    clip = (mail_scenes.VIEWS[view] @ TURNED) @ np.column_stack([points, np.ones(len(points))]).T
    place = clip[:3] / clip[3]
    return *((place[:2] + 1.0) * 0.5 * np.array(SIZE)[:, None]).astype(int), place[2]


@pytest.mark.parametrize("view", ["above", "orthographic"])
def test_folds_are_drawn_where_they_are(part, native, settings, instance, view):
    shell = mail_scenes.torus_shell(native)
    numbers = np.arange(shell.prism_count)
    inverted, crossing, base = (numbers % 61 == 0).astype(np.uint8), (numbers % 83 == 5).astype(np.uint8), numbers % 97 == 2
    drawn = instance(folds={"inverted": inverted, "intersecting": crossing | base, "base": base.astype(np.uint8)})
    settings.show_folds = True
    color = draw(part, drawn, settings, view)
    wrong = (inverted | crossing).astype(bool)
    shown, expected = color[..., 3] > 0.5, seen(native, shell, wrong | base, view)
    assert expected.mean() > 0.02
    assert shown[expected].mean() > 0.999 and spread(expected)[shown].all()  # outlines reach a pixel beyond
    only_base = seen(native, shell, base, view) & ~seen(native, shell, wrong & ~base, view)
    only_own = seen(native, shell, wrong & ~base, view) & ~seen(native, shell, base, view)
    assert np.median(color[only_base], axis=0)[:3].tolist() == [0, 1, 0]
    assert np.median(color[only_own], axis=0)[:3].tolist() == [1, 0, 0]


def test_hidden_folds_shine_through(part, native, settings, instance):
    """Behind what hides them all, edges of folds are still seen, fainter than in front."""
    shell = mail_scenes.torus_shell(native)
    one = (np.arange(shell.prism_count) == 40).astype(np.uint8)
    drawn = instance(folds={"inverted": one, "intersecting": 0 * one, "base": 0 * one})
    settings.show_folds = True
    plain = draw(part, drawn, settings)[..., 0]
    hidden = draw(part, drawn, settings, occluder=lambda: gpu.state.active_framebuffer_get().clear(depth=0.0))[..., 0]
    assert (hidden > 0.0).sum() > 20 and hidden.sum() < 0.5 * plain.sum()
    assert spread(plain > 0.0)[hidden > 0.0].all()


def test_stretch_colors_the_top(part, native, settings, instance):
    """Even stretch has one color: that of its logarithm between 1 / most and most."""
    shell = mail_scenes.torus_shell(native)
    settings.show_stretch, settings.most_stretch = True, 4.0
    top = seen(native, shell, np.ones(shell.prism_count, bool))
    for rms, expected in ((1.0, (0, 1, 0)), (2.0, (0.5, 0.5, 0)), (9.0, (1, 0, 0)), (0.5, (0, 0.5, 0.5)), (0.01, (0, 0, 1))):
        stretch = {"rms": np.full(shell.prism_count, rms, np.float32), "angle": np.zeros(shell.prism_count, np.float32)}
        color = draw(part, instance(stretch=stretch), settings)
        assert ((color[..., 3] > 0.5) != top).mean() < 0.01
        np.testing.assert_allclose(np.median(color[top], axis=0)[:3], expected, atol=0.01)
    settings.measure, settings.most_angle = "angle", 0.5
    stretch["angle"] = np.full(shell.prism_count, 0.5 * np.pi - 0.25, np.float32)
    color = draw(part, instance(stretch=stretch), settings)
    np.testing.assert_allclose(np.median(color[top], axis=0)[:3], (0.5, 0.5, 0), atol=0.01)


def test_seams_are_lines(part, native, settings, instance):
    """One edge across the view: pixels on its projection are of its color, and nothing far from it."""
    edges = np.array([[[-1.0, 0.0, 0.0], [1.0, 0.3, 0.2]]], np.float32)
    settings.show_seams = True
    color = draw(part, instance(seams={"edges": edges, "tops": edges + [0, 0, 1e-4], "count": 1}), settings)
    columns, rows, _ = projected(np.linspace(0.05, 0.95, 50)[:, None] * (edges[0, 1] - edges[0, 0]) + edges[0, 0])
    assert (color[rows, columns, 2] > 0.5).all()
    assert (color[..., 3] > 0.1).mean() < 0.03


def test_edges_of_prisms_are_drawn_once(part, native):
    """Euler: a torus of p triangles has 3 p / 2 edges, as many above them, and p / 2 vertices with an edge upward each."""
    shell = mail_scenes.torus_shell(native)
    vertices, edges = part("core.overlay_shapes").wires(shell)
    count = shell.prism_count
    assert len(edges) == 3 * count // 2 * 2 + count // 2
    assert len(np.unique(np.sort(edges, axis=1), axis=0)) == len(edges)
    lengths = np.linalg.norm(vertices[edges[:, 1]] - vertices[edges[:, 0]], axis=1)
    np.testing.assert_allclose(lengths[-count // 2:], 0.31, rtol=1e-3)


def test_what_is_nearer_hides_overlays_and_what_is_in_their_place_does_not(part, native, settings, instance):
    shell = mail_scenes.torus_shell(native)
    settings.show_prisms = True
    drawn = instance()
    plain = draw(part, drawn, settings)[..., 3] > 0.5
    assert plain.mean() > 0.1
    hidden = draw(part, drawn, settings, occluder=lambda: gpu.state.active_framebuffer_get().clear(depth=0.0))
    assert not hidden[..., 3].any()
    # Edges of the shell's top lie on its stretch.
    settings.show_stretch = True
    stretch = {"rms": np.ones(shell.prism_count, np.float32), "angle": np.ones(shell.prism_count, np.float32)}
    color = draw(part, drawn._replace(found={"stretch": stretch}), settings)
    corners = np.asarray(shell.prisms)[:, 3:6, :3]
    columns, rows, _ = projected((0.5 * (corners + np.roll(corners, 1, axis=1))).reshape(-1, 3))
    # A convex patch that nothing else covers: the tops nearest the eye.
    eye = np.asarray(native.eye(mail_scenes.VIEWS["above"] @ TURNED))[:3]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    to_eye = eye - corners[:, 0]
    distance = np.linalg.norm(to_eye, axis=1)
    toward = (to_eye * normals).sum(1) / np.linalg.norm(normals, axis=1) / distance
    near = distance < distance.min() + 0.5
    inside = (np.stack([columns, rows]) > 2).all(axis=0) & (np.stack([columns, rows]) < SIZE[0] - 2).all(axis=0)
    visible = np.repeat((toward > 0.3) & near, 3) & inside
    assert visible.sum() > 100
    assert (spread(color[..., 0], 1)[rows[visible], columns[visible]] > 0.1).mean() > 0.99


def test_state_is_as_before(part, settings, instance):
    settings.show_prisms = True
    gpu.state.depth_test_set('ALWAYS')
    gpu.state.depth_mask_set(True)
    try:
        draw(part, instance(), settings)
        assert (gpu.state.depth_test_get(), gpu.state.depth_mask_get(), gpu.state.blend_get()) == ('ALWAYS', True, 'NONE')
    finally:
        gpu.state.depth_test_set('NONE')
        gpu.state.depth_mask_set(False)


def test_batches_of_a_place_are_those_of_its_last_version(part, settings, instance):
    overlays = part("gpu.overlays")
    settings.show_prisms = True
    draw(part, instance(), settings)
    count = len(overlays._batches)
    for _ in range(20):
        draw(part, instance(), settings)
    assert len(overlays._batches) == count
