"""A height field as a tile's surface: one sheet over the whole period, with everything below it solid."""

import numpy as np

from . import periodic
from .tile_surface import TileSurface

# Of the height: what reaches it exactly, white, stays below the plane where rays start.
_MARGIN = 1e-5
_FEWEST_NODES = 4  # a side, so that no triangle spans half a period


def surface_of(heights, options, *, name="height field", aspect=None, notices=()):
    """The TileSurface of heights [ny, nx] in [0, 1], row 0 at v = 0, pixel i at node i / n; made periodic as `options` say.

    0 is `height_low` and 1 is `height_high` above the base, in widths of the field; the tile is as high as the greater of
    the two, and what exceeds it is clipped by the bake. `aspect` is height / width of the field; None: pixels are squares.
    ValueError: no heights, or some that are not finite.
    """
    heights = np.asarray(heights, np.float32)
    if heights.ndim != 2 or heights.size == 0:
        raise ValueError(f'"{name}" is no height field: give heights [ny, nx]')
    bad = np.argwhere(~np.isfinite(heights))
    if len(bad):
        raise ValueError(f'"{name}" has {len(bad)} heights that are not finite numbers (the first is at row {bad[0][0]}, '
                         f"column {bad[0][1]}): paint over them")
    top = max(options.height_low, options.height_high)
    if not top > 0.0:
        raise ValueError(f'"{name}" has no height: set the height of black or of white to more than zero')
    if aspect is None:
        aspect = heights.shape[0] / heights.shape[1]
    heights, width = periodic.made(heights, options)
    heights = resampled(heights, int(options.most_nodes * width))
    levels = (options.height_low + heights.astype(np.float64) * (options.height_high - options.height_low)) / width
    positions, triangles, normals = _sheet(levels, aspect)
    return TileSurface(name, positions, triangles, top * (1.0 + _MARGIN) / width, aspect, normals=normals,
                       notices=tuple(notices))


def resampled(heights, most):
    """Heights with at most `most` nodes a side, and at least a few: means of windows around each node, across borders."""
    for axis in (0, 1):
        count = heights.shape[axis]
        if count > most:
            heights = _averaged(heights, most, axis)
        elif count < _FEWEST_NODES:
            heights = np.repeat(heights, -(-_FEWEST_NODES // count), axis=axis)
    return heights


def _averaged(values, count, axis):
    """Means over `count` windows of a periodic axis, each around its node and as wide as nodes are apart."""
    values = np.moveaxis(values, axis, -1).astype(np.float64)
    pixels = values.shape[-1]
    sums = np.concatenate([np.zeros((*values.shape[:-1], 1)), np.cumsum(values, axis=-1)], axis=-1)
    # Pixel j covers [j, j + 1), with node j / n in its middle.
    edges = (np.arange(count + 1) - 0.5) * (pixels / count) + 0.5
    turns = np.floor(edges / pixels)
    rest = edges - turns * pixels
    whole = np.minimum(rest.astype(int), pixels - 1)
    integral = turns * sums[..., -1:] + sums[..., whole] + (rest - whole) * values[..., whole]
    return np.moveaxis(np.diff(integral, axis=-1) * (count / pixels), -1, axis).astype(np.float32)


def _sheet(levels, aspect):
    """Positions [n, 3], triangles [m, 3] and corner normals [m, 3, 3] of levels float64 [ny, nx], tile widths."""
    ny, nx = levels.shape
    closed = np.pad(levels, ((0, 1), (0, 1)), mode="wrap")
    # Divided before they are multiplied: borders are one period apart to the bit.
    x, y = np.meshgrid(np.arange(nx + 1) / nx, np.arange(ny + 1) / ny * aspect)
    positions = np.stack([x, y, closed], axis=-1)
    number = np.arange((nx + 1) * (ny + 1), dtype=np.int32).reshape(ny + 1, nx + 1)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    # Along the diagonal whose ends are the nearer in height, a ridge or groove stays one.
    level = closed.ravel()
    straight = np.abs(level[a] - level[c]) <= np.abs(level[b] - level[d])
    first = np.where(straight[..., None], np.stack([a, b, c], -1), np.stack([a, b, d], -1))
    second = np.where(straight[..., None], np.stack([a, c, d], -1), np.stack([b, c, d], -1))
    triangles = np.stack([first, second], axis=2).reshape(-1, 3)
    slope_x = (np.roll(levels, -1, axis=1) - np.roll(levels, 1, axis=1)) * (0.5 * nx)
    slope_y = (np.roll(levels, -1, axis=0) - np.roll(levels, 1, axis=0)) * (0.5 * ny / aspect)
    normal = np.stack([-slope_x, -slope_y, np.ones_like(levels)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    normal = np.pad(normal, ((0, 1), (0, 1), (0, 0)), mode="wrap").reshape(-1, 3).astype(np.float32)
    return positions.reshape(-1, 3), triangles, normal[triangles]
