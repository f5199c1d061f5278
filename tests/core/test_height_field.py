"""Laws of height fields: straight down it is as far as the numbers say, below is solid, and fewer nodes are means."""

import numpy as np
import pytest
from core import height_field
from core.tile_options import TileOptions
from surfaces import sample, sdf

OPTIONS = TileOptions(height_low=0.1, height_high=0.4)


def waves(ny, nx):
    y, x = np.meshgrid(np.arange(ny) / ny, np.arange(nx) / nx, indexing="ij")
    return (0.5 + 0.3 * np.sin(2 * np.pi * (x + y)) + 0.2 * np.cos(4 * np.pi * x)).astype(np.float32)


def straight_down(native, surface, resolution, engine):
    """float32 [ny, nx, nz]."""
    gdm = native.bake_gdm(sample(surface), resolution=resolution, directions=(4, 4), engine=engine)
    return np.array(gdm.values)[0, :, :, -1, :]


@pytest.mark.parametrize("engine", ["embree", "slices"])
def test_straight_down_is_the_difference_of_heights(native, engine):
    """At the nodes of the field itself the surface is the field, whatever lies between them; inside it is nought."""
    ny, nx, nz = 24, 16, 7
    heights = waves(ny, nx)
    surface = height_field.surface_of(heights, OPTIONS)
    assert surface.aspect == 1.5 and surface.height == pytest.approx(0.4, rel=1e-4)
    found = straight_down(native, surface, (nx, ny, nz), engine)
    level = (0.1 + 0.3 * heights)[:, :, None]
    expected = np.maximum(np.linspace(0.0, surface.height, nz) - level, 0.0)
    assert (expected > 0.1).any() and (expected == 0.0).any()
    np.testing.assert_allclose(found, expected, atol=2e-5)


def test_the_solid_reaches_down_to_the_base():
    values = sdf(height_field.surface_of(waves(24, 16), OPTIONS), (16, 24, 9))
    below = np.linspace(0.0, 0.4, 9)[:, None, None] < 0.1 + 0.3 * waves(24, 16) - 1e-3
    assert below.any() and not below.all()
    np.testing.assert_array_equal(values[1:] < 0.0, below[1:])
    np.testing.assert_allclose(values[0], 0.0, atol=1e-6)


def test_black_may_lie_on_the_base(native):
    """A quarter of the tile has nothing above the base plane at all."""
    heights = np.zeros((8, 8), np.float32)
    heights[:, 4:] = 1.0
    surface = height_field.surface_of(heights, OPTIONS._replace(height_low=0.0))
    found = straight_down(native, surface, (8, 8, 5), "auto")
    np.testing.assert_allclose(found[:, 1:4, :], np.broadcast_to(np.linspace(0.0, 0.4, 5), (8, 3, 5)), atol=2e-5)
    np.testing.assert_allclose(found[:, 5:8, :4], 0.0, atol=1e-6)


def test_dark_may_be_high(native):
    heights = waves(8, 8)
    dark = height_field.surface_of(1.0 - heights, OPTIONS._replace(height_low=0.4, height_high=0.1))
    light = height_field.surface_of(heights, OPTIONS)
    np.testing.assert_allclose(dark.positions, light.positions, atol=1e-7)
    assert dark.height == light.height


def test_borders_are_one_period_apart_to_the_bit():
    surface = height_field.surface_of(waves(11, 13), OPTIONS, aspect=0.7)
    grid = surface.positions.reshape(12, 14, 3)
    np.testing.assert_array_equal(grid[:, -1], grid[:, 0] + [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(grid[-1], grid[0] + [0.0, 0.7, 0.0])


def test_normals_are_those_of_the_waves():
    surface = height_field.surface_of(waves(64, 64), OPTIONS)
    x, y = np.moveaxis(surface.positions[surface.triangles][..., :2], -1, 0)
    along = 0.3 * 2 * np.pi * (0.3 * np.cos(2 * np.pi * (x + y)))
    slope = np.stack([-along + 0.3 * 0.2 * 4 * np.pi * np.sin(4 * np.pi * x), -along, np.ones_like(x)], axis=-1)
    np.testing.assert_allclose(surface.normals, slope / np.linalg.norm(slope, axis=-1, keepdims=True), atol=5e-3)


@pytest.mark.parametrize("most", [5, 16, 23, 31])
def test_fewer_nodes_keep_the_mean(rng, most):
    heights = rng.random((32, 48)).astype(np.float32)
    fewer = height_field.resampled(heights, most)
    assert fewer.shape == (most, most)
    assert fewer.mean() == pytest.approx(heights.mean(), rel=1e-5)


def test_fewer_nodes_stay_where_they_are():
    """The mean of three pixels around every third one of a cosine is that cosine at the very node, flattened evenly."""
    nodes = np.cos(2 * np.pi * np.arange(48) / 48)
    fewer = height_field.resampled(np.broadcast_to(nodes, (48, 48)).astype(np.float32), 16)
    flattened = (1.0 + 2.0 * np.cos(2 * np.pi / 48)) / 3.0
    np.testing.assert_allclose(fewer[3], flattened * np.cos(2 * np.pi * np.arange(16) / 16), atol=1e-6)


def test_windows_reach_over_the_border():
    heights = np.zeros((4, 8), np.float32)
    heights[:, 7] = 1.0
    np.testing.assert_allclose(height_field.resampled(heights, 4)[0], [0.25, 0.0, 0.0, 0.25], atol=1e-6)


def test_mirroring_keeps_the_relief_in_proportion():
    """Twice as wide a tile: what was 0.4 of a width is 0.2, and the relief is the same from all four sides."""
    surface = height_field.surface_of(np.linspace(0, 1, 12 * 20, dtype=np.float32).reshape(12, 20),
                                      OPTIONS._replace(periodic='MIRROR'))
    assert surface.height == pytest.approx(0.2, rel=1e-4) and surface.aspect == pytest.approx(0.6)
    levels = surface.positions.reshape(25, 41, 3)[:24, :40, 2]
    np.testing.assert_array_equal(levels, levels[::-1])
    np.testing.assert_array_equal(levels, levels[:, ::-1])
    assert levels.min() == pytest.approx(0.05) and levels.max() == pytest.approx(0.2)
    sample(surface)


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (3, 2)])
def test_the_smallest_fields_bake(native, shape):
    surface = height_field.surface_of(np.full(shape, 0.5, np.float32), OPTIONS)
    found = straight_down(native, surface, (4, 4, 3), "auto")
    np.testing.assert_allclose(found[:, :, -1], 0.4 - 0.25, atol=2e-5)


@pytest.mark.parametrize("heights, words", [
    (np.zeros((0, 4)), "heights"), (np.zeros(4), "heights"), (np.array([[0.5, np.nan]]), "row 0, column 1")])
def test_what_is_no_field_is_refused(heights, words):
    with pytest.raises(ValueError, match=words):
        height_field.surface_of(heights, OPTIONS)


def test_a_field_without_height_is_refused():
    with pytest.raises(ValueError, match="white"):
        height_field.surface_of(np.ones((4, 4)), TileOptions(height_low=0.0, height_high=0.0))
