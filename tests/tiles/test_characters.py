"""What makes each tile a test of its own: the weave interlaces, the grid is empty, scales and bark overhang, hairs are thin."""

from functools import cache

import mesoshell_native as native
import numpy as np

import tiles
from solids import solids

make = cache(tiles.make)


def baked(name, resolution=(32, 32, 16)):
    """The tile's GDM upward and downward and in between: float32 [nphi, ny, nx, ntheta, nz]; theta node 0 looks up."""
    tile = make(name)
    sample = native.Sample(tile.positions, tile.triangles, height=tile.height, aspect=tile.aspect)
    return native.bake_gdm(sample, resolution=resolution, directions=(4, 2)).values


def yarns():
    """Positions of the weave's eight yarns [n, 3]: four warps from left to right, four wefts from front to back."""
    tile = make("weave")
    parts = [tile.positions[np.unique(part)] for part, _ in solids(tile)]
    warps = [part for part in parts if np.ptp(part[:, 1]) > np.ptp(part[:, 0])]
    wefts = [part for part in parts if np.ptp(part[:, 1]) < np.ptp(part[:, 0])]
    return sorted(warps, key=lambda p: p[:, 0].mean()), sorted(wefts, key=lambda p: p[:, 1].mean())


def test_yarns_pass_over_and_under_in_turn():
    warps, wefts = yarns()
    assert len(warps) == len(wefts) == 4
    for i, warp in enumerate(warps):
        for j, weft in enumerate(wefts):
            x, y = warp[:, 0].mean(), weft[:, 1].mean()
            above = warp[np.abs(warp[:, 1] - y) < 0.03, 2].mean() - weft[np.abs(weft[:, 0] - x) < 0.03, 2].mean()
            assert above * (-1) ** (i + j) > 0.1


def test_yarns_do_not_touch():
    """Slices across one yarn are round: at every vertex of another yarn the nearest slice's center is farther than its rim."""
    warps, wefts = yarns()
    for warp in warps:
        slices = np.split(warp, len(warp) // 15)  # 15 vertices a ring
        centers = np.array([ring.mean(axis=0) for ring in slices])
        rim = max(np.linalg.norm(ring - center, axis=1).max() for ring, center in zip(slices, centers))
        for weft in wefts:
            apart = np.linalg.norm(weft[:, None] - centers[None], axis=-1).min()
            assert apart > rim, (apart, rim)


def test_grid_is_seen_through_and_empty_inside():
    up = baked("grid")[0, :, :, 0]
    height = make("grid").height
    assert (up[:, :, 0] > height * 0.999).mean() > 0.4, "rays from the base that leave through the top"
    assert (up[:, :, 8] == 0.0).mean() < 0.06, "solid at half height"


def test_scales_hide_the_skin_and_stand_off_it():
    up = baked("squama")[0, :, :, 0]
    tile = make("squama")
    from_skin = up[:, :, 4]  # a quarter of the height, above the skin
    free = from_skin[from_skin > 0.0]
    assert len(free) > 0.3 * from_skin.size, "the scales leave no hollow"
    to_top = tile.height * (1.0 - 4 / 15)
    assert (free < 0.99 * to_top).mean() > 0.8, "most of the hollows lie under a scale"


def test_bark_overhangs():
    tile = make("bark")
    relief = max((part for part, _ in solids(tile)), key=len)
    a, b, c = (tile.positions[relief[:, corner]] for corner in range(3))
    area = np.cross(b - a, c - a)[:, 2]
    assert -area[area < 0.0].sum() / area.sum() > 0.08, "of the tile, this share lies under an overhang"


def test_hairs_are_slanted_and_thinner_than_a_voxel_toward_the_tip():
    tile = make("fur")
    hairs = [tile.positions[np.unique(part)] for part, endless in solids(tile) if not endless]
    for hair in hairs:
        # 5 rings of 3 vertices, the root, the tip.
        rings, tip = hair[:15].reshape(5, 3, 3), hair[-1]
        across = np.linalg.norm(rings - np.roll(rings, 1, axis=1), axis=-1).max(axis=1)
        assert (np.diff(across) < 0.0).all() and across[-1] < 0.6 / 64 < across[0] < 3.0 / 64
        along = tip - hair[-2]
        assert 30 < np.degrees(np.arccos(along[2] / np.linalg.norm(along))) < 65
        assert along[0] > 0.0
