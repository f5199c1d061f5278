"""A grid of values as a tile's surface: a density, or a level set, solid on one side of a threshold.

For scripts too: surface_of(values, 0.0, inside='below') is a TileSurface, which bake_tile.BakeRequest takes as any other.
"""

import numpy as np

from . import native, periodic
from .tile_options import TileOptions
from .tile_surface import TileSurface


def surface_of(values, threshold, height=None, aspect=None, *, inside='above', options=TileOptions(), name="grid",
               threads=0):
    """The TileSurface of values [nz, ny, nx] where they cross `threshold`; made periodic as `options` say.

    values    any real numbers; node i at i / n along u and v, which are periodic, at i / (n - 1) along w
    inside    'above' (a density) or 'below' (a level set): which values are solid
    height    of the grid, in its widths; None: voxels are cubes
    aspect    period v / period u; None: voxels are squares
    Raises ValueError in a sentence that starts with the name: values that are not finite, or nothing at the threshold.
    """
    values = np.asarray(values)
    if values.ndim != 3 or min(values.shape) < 2:
        raise ValueError(f'"{name}" has the shape {values.shape}: give a grid [nz, ny, nx] of at least two nodes along each '
                         "axis")
    if values.dtype.kind not in "biuf":
        raise ValueError(f'"{name}" holds {values.dtype}: give a grid of real numbers')
    if inside not in {'above', 'below'}:
        raise ValueError(f'inside is {inside!r}: give "above" or "below"')
    nz, ny, nx = values.shape
    height = (nz - 1) / nx if height is None else height
    aspect = ny / nx if aspect is None else aspect
    values, width = periodic.made(values.astype(np.float32), options)
    least, most = float(np.min(values)), float(np.max(values))
    if np.isfinite(least + most) and not least <= threshold <= most:
        raise ValueError(f'"{name}" has no surface at the threshold {threshold:g}: its values are between {least:g} and '
                         f"{most:g}, choose a threshold among them")
    if inside == 'below':
        values, threshold = -values, -threshold
    try:
        positions, triangles = native.module().contour(values, threshold, height=height / width, aspect=aspect,
                                                       threads=threads)
    except ValueError as error:
        raise ValueError(f'"{name}": {error}') from error
    return TileSurface(name, np.array(positions, np.float64), np.array(triangles), height / width, aspect)
