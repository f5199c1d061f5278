"""In each of the six tiles no ray of a baked GDM meets the surface before its leap ends."""

import mesoshell_native as native
import numpy as np
import pytest

import tiles

NODES, DIRECTIONS = (23, 19, 9), (8, 13)


def rays(gdm):
    """Positions in texture space [n, 3] and unit directions [n, 3], in the order of gdm.values."""
    (nx, ny, nz), (ntheta, nphi) = gdm.resolution, gdm.directions
    phi, y, x, theta, z = np.meshgrid(np.arange(nphi) / nphi * 2 * np.pi, np.arange(ny) / ny, np.arange(nx) / nx,
                                      np.arange(ntheta) / (ntheta - 1) * np.pi, np.arange(nz) / (nz - 1), indexing="ij")
    across = np.sin(theta)
    return (np.stack([x, y, z], axis=-1).reshape(-1, 3),
            np.stack([across * np.cos(phi), across * np.sin(phi), np.cos(theta)], axis=-1).reshape(-1, 3))


@pytest.mark.parametrize("name", tiles.NAMES)
def test_no_ray_of_the_gdm_is_shorter(name):
    tile = tiles.make(name)
    sample = native.Sample(tile.positions, tile.triangles, height=tile.height, aspect=tile.aspect)
    gdm = native.bake_gdm(sample, resolution=NODES, directions=DIRECTIONS, engine="embree")
    leaps = native.bake_leaps(sample)
    positions, directions = rays(gdm)
    distance = gdm.values.ravel()
    with np.errstate(divide="ignore"):
        rise = directions[:, 2] / tile.height
        way_out = np.where(rise > 0, (1 - positions[:, 2]) / rise, -positions[:, 2] / rise)
    hits = (distance > 0.0) & (distance < way_out - 1e-4) & (distance < 2.0)  # 0 is inside
    leap = leaps.lookup(positions[hits], directions[hits])
    assert hits.sum() > 20000
    # Positions are rounded, and with them the way to the end of a cell.
    assert (leap - distance[hits]).max() <= 2e-6
    assert (leap > 0.0).mean() > 0.2
