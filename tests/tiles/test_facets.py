"""Rays find a tile by its facets where they meet its triangles, and with about half the fetches of sphere tracing."""

import mesoshell_native as native
import numpy as np
import pytest

import tiles

SIZE, WIDTH = (96, 96), 4  # pixels; tiles of the plane along each side
VOXEL = 1 / 64


def plane(tile):
    """A flat shell of WIDTH x WIDTH tiles in which texture space, times the aspect, is object space."""
    u, v = WIDTH, WIDTH * tile.aspect
    positions = np.array([(0, 0, 0), (u, 0, 0), (u, v, 0), (0, v, 0)], np.float32)
    uvs = np.array([(0, 0), (WIDTH, 0), (WIDTH, WIDTH), (0, WIDTH)], np.float32)
    return native.build_shell(positions, np.array([4], np.int32), np.arange(4, dtype=np.int32), uvs, thickness=tile.height)


def view(tile, elevation, half_width):
    """Parallel rays toward the middle of the plane, from an azimuth that is no axis of the tile."""
    e, a = np.radians(elevation), np.radians(23.7)
    back = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    target = np.array([WIDTH / 2, WIDTH / 2 * tile.aspect, tile.height])
    rows = np.stack([right / half_width, np.cross(back, right) / half_width, -back / 10.0])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rows, -rows @ target
    return matrix


@pytest.mark.parametrize("name", ["chain", "weave"])
def test_refined_is_exact(name):
    tile = tiles.make(name)
    sample = native.Sample(tile.positions, tile.triangles, height=tile.height, aspect=tile.aspect)
    gdm = native.bake_gdm(sample, resolution=(4, 4, 3), directions=(4, 4))
    tile_map = native.compress(gdm, terms=1, sdf=native.bake_sdf(sample, resolution=(64, 64, 33)),
                               facets=native.bake_facets(sample, cells=56))
    shell = plane(tile)
    for elevation, half_width in ((65, 1.2), (35, 0.9), (15, 0.4)):
        def picture(traversal):
            return native.render(shell, tile_map, clip_from_object=view(tile, elevation, half_width), size=SIZE,
                                 traversal=traversal, sample=sample)

        exact, refined, sdf = picture("exact"), picture("refined"), picture("sdf")
        both = (exact["hit"] & refined["hit"]) == 1
        error = np.abs(exact["distance"][both] - refined["distance"][both])
        assert both.sum() >= 0.999 * (exact["hit"] | refined["hit"]).sum() > 4000
        assert error.mean() <= 0.03 * VOXEL
        assert (error <= VOXEL).mean() >= 0.998
        assert refined["fetches"].mean() <= 0.65 * sdf["fetches"].mean()


def test_without_boxes_only_empty_cells_differ():
    tile = tiles.make("chain", 0.5)
    sample = native.Sample(tile.positions, tile.triangles, height=tile.height, aspect=tile.aspect)
    boxes, alone = (native.bake_facets(sample, cells=16, boxes=given).texels for given in (True, False))
    empty = ~np.signbit(boxes).any(axis=-1)  # the kind of a texel is in its signs
    assert 500 < empty.sum() < empty.size
    assert np.array_equal(alone[~empty], boxes[~empty])
    reach = np.uint32(0x1fffffff)  # the bits of how far a box reaches
    assert not (alone[empty].view(np.uint32) & reach).any()
    assert (boxes[empty].view(np.uint32) & reach).any(axis=-1).mean() > 0.5
