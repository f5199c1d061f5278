"""Makes arrays periodic that are not: heights and grids, float32 [..., ny, nx], node i at i / n along both last axes.

MIRROR: 2 x 2 mirrored copies, the first and last node of each doubled (as a texture that repeats mirrored has it).
        Everything is kept; the period is two widths.
BLEND:  the array cross-fades, along a strip at each border, into itself moved by half a period, where that border is its
        middle. The period stays. Weights sum to one, so that no value leaves the range of those it is made of: heights stay
        in their tile, and a distance field stays one up to its slope. The cost: in the middle of the strip, where two
        unrelated places meet, contrast falls (to 1 / sqrt 2 for noise); weights that kept the variance would leave the
        range instead.
"""

import numpy as np

MOST_BLEND = 0.45  # of a width: the strips of two borders must leave a middle, where the moved copy's own border is


def made(values, options):
    """(values, width in widths of the source) of TileOptions' `periodic`."""
    if options.periodic == 'MIRROR':
        return mirrored(values), 2.0
    if options.periodic == 'BLEND':
        return blended(values, options.blend_width), 1.0
    return values, 1.0


def mirrored(values):
    """[..., 2 ny, 2 nx]."""
    values = np.concatenate([values, values[..., ::-1]], axis=-1)
    return np.concatenate([values, values[..., ::-1, :]], axis=-2)


def blended(values, width):
    """[..., ny, nx]; `width` is in (0, MOST_BLEND]. ValueError otherwise."""
    if not 0.0 < width <= MOST_BLEND:
        raise ValueError(f"The blend's width is {width:g}: give more than 0 and at most {MOST_BLEND} of the tile")
    return _blended_along(_blended_along(values, width, -1), width, -2)


def _blended_along(values, width, axis):
    count = values.shape[axis]
    half = count // 2
    border = np.minimum(np.arange(count), np.arange(count)[::-1])  # nodes to the nearer end
    # The moved copy's border, between nodes count - half - 1 and count - half, must have no weight at all.
    strip = max(1, min(round(width * count), half - 1))
    t = np.clip(border / strip, 0.0, 1.0)
    weight = (t * t * (3.0 - 2.0 * t)).astype(values.dtype).reshape([-1 if a == axis else 1 for a in (-2, -1)])
    return weight * values + (1 - weight) * np.roll(values, -half, axis=axis)
