"""Laws of the six tiles of blend_samples/tiles: closed, facing outward, periodic to the bit, as fine as asked."""

import hashlib
from functools import cache

import mesoshell_native as native
import numpy as np
import pytest

import tiles
from solids import places, solids

DETAILS = (0.33, 1.0, 2.0)
make = cache(tiles.make)


def directed_edges(tile):
    """Edges as triangles run along them, and the same edges backwards: from, to, periods between; int [3 m, 4]."""
    place, shift = places(tile)
    start, end = tile.triangles.ravel(), np.roll(tile.triangles, -1, axis=1).ravel()
    span = shift[end] - shift[start]
    return (np.column_stack([place[start], place[end], span]), np.column_stack([place[end], place[start], -span]))


def rewrapped(tile, offset):
    """The tile moved by `offset` [2], then each triangle by the whole periods that bring its first corner into the box."""
    corners = tile.positions[tile.triangles] + [*offset, 0.0]
    period = np.array([1.0, tile.aspect])
    corners[..., :2] -= (np.floor(corners[:, :1, :2] / period)) * period
    return corners.reshape(-1, 3), np.arange(corners.shape[0] * 3, dtype=np.int32).reshape(-1, 3)


def sample(positions, triangles, tile):
    return native.Sample(positions, triangles, height=tile.height, aspect=tile.aspect)


@pytest.fixture(params=tiles.NAMES)
def name(request):
    return request.param


@pytest.mark.parametrize("detail", DETAILS)
def test_closed_modulo_the_periods_to_the_bit(name, detail):
    """Every edge is run along once in each direction, where vertices are one only if they differ by exact periods."""
    tile = make(name, detail)
    forward, backward = directed_edges(tile)
    edges, count = np.unique(forward, axis=0, return_counts=True)
    assert count.max() == 1
    np.testing.assert_array_equal(edges, np.unique(backward, axis=0))


def test_faces_outward(name):
    """The volume within the tile, by the flux of z through its faces, is positive and less than the box."""
    tile = make(name)
    a, b, c = (tile.positions[tile.triangles[:, corner]] for corner in range(3))
    flux = np.cross(b - a, c - a)[:, 2] / 2 * (a + b + c)[:, 2] / 3
    assert 0.05 * tile.aspect * tile.height < flux.sum() < 0.9 * tile.aspect * tile.height


def test_every_solid_faces_outward(name):
    """What does not go on for ever, as yarns and sheets do, has a volume of its own, a positive one."""
    tile = make(name)
    finite = [part for part, endless in solids(tile) if not endless]
    for part in finite:
        a, b, c = np.moveaxis(tile.positions[part] - tile.positions[part[0, 0]], 1, 0)
        assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0.0
    assert len(finite) == {"weave": 0, "grid": 40, "chain": 4, "squama": 16, "bark": 0, "fur": 361}[name]


def test_float32_keeps_positions_and_both_periods(name):
    tile = make(name)
    for offset in ((0, 0), (1, 0), (0, tile.aspect), (0.5, tile.aspect / 2), (-1, -tile.aspect)):
        moved = tile.positions + [*offset, 0]
        single = tile.positions.astype(np.float32) + np.array([*offset, 0], np.float32)
        np.testing.assert_array_equal(single.astype(float), moved)


def test_triangles_are_the_same_to_the_bit_half_a_period_on_and_back(name):
    """In float32, as a sample stores them: moved by half a period, wrapped, moved on and wrapped again, they are the same."""
    tile = make(name)
    period = np.array([1.0, tile.aspect, 1.0], np.float32)
    corners = tile.positions.astype(np.float32)[tile.triangles]
    there = corners
    for _ in range(2):
        there = there + period / 2 * [1, 1, 0]
        there = (there - np.floor(there[:, :1] / period) * period * [1, 1, 0]).astype(np.float32)
    here = corners - np.floor(corners[:, :1] / period) * period * [1, 1, 0]
    np.testing.assert_array_equal(here, there)


def test_lies_within_its_height(name):
    """Nothing is clipped, and nothing touches the planes where rays start."""
    tile = make(name)
    assert 0.001 < tile.positions[:, 2].min() < tile.positions[:, 2].max() < tile.height - 0.001


@pytest.mark.parametrize("detail, low, high", [(0.33, 500, 2500), (1.0, 8500, 12500), (2.0, 30_000, 55_000)])
def test_triangles_grow_with_the_square_of_detail(name, detail, low, high):
    tile = make(name, detail)
    assert low <= len(tile.triangles) <= high
    assert tile.height == make(name).height and tile.aspect == make(name).aspect


def test_no_triangle_without_area(name):
    corners = make(name).positions[make(name).triangles]
    assert np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).min() > 1e-9


def test_colors_are_reflectances_that_vary(name):
    colors = make(name).colors
    assert colors.min() >= 0.0 and colors.max() <= 0.95
    assert colors.std(axis=0).max() > 0.02
    assert make(name).corner_colors.shape == (len(make(name).triangles), 3, 3)


def test_same_every_time(name):
    first, second = (hashlib.sha256(tiles.make(name).positions.tobytes()).digest() for _ in range(2))
    assert first == second


def assert_same_but_for_roundings(first, second):
    """Equal to four roundings of float32. Not to the bit: Embree finishes a ray of a packet alone when few others are left,
    which the order of triangles decides, and rounds differently then."""
    np.testing.assert_allclose(first, second, rtol=4 * 2.0**-23, atol=4 * 2.0**-23)


def test_bakes_the_same_after_rewrapping(name):
    """Which copy of a triangle stands for it decides nothing."""
    tile = make(name, 0.5)
    first, second = (native.bake_gdm(sample(*mesh, tile), resolution=(16, 16, 8), directions=(6, 8)).values
                     for mesh in ((tile.positions, tile.triangles), rewrapped(tile, (0.0, 0.0))))
    assert_same_but_for_roundings(first, second)


def test_half_a_period_on_bakes_the_same_half_the_nodes_on(name):
    tile = make(name, 0.5)
    size = {"resolution": (16, 16, 8), "directions": (6, 8)}
    here = native.bake_gdm(sample(tile.positions, tile.triangles, tile), **size).values
    there = native.bake_gdm(sample(*rewrapped(tile, (0.5, tile.aspect / 2)), tile), **size).values
    assert_same_but_for_roundings(np.roll(here, (8, 8), axis=(1, 2)), there)


def test_refuses_a_detail_that_is_not_positive(name):
    with pytest.raises(ValueError, match="positive"):
        make(name, 0.0)


def test_refuses_a_name_it_does_not_know():
    with pytest.raises(ValueError, match="weave"):
        tiles.make("velvet")
