"""The solids that a tile consists of, found from its arrays alone."""

import numpy as np


def places(tile):
    """Of each vertex: the number of its place modulo the periods [n], and the periods from there [n, 2]; all exact."""
    period = np.array([1.0, tile.aspect])
    shift = np.floor(tile.positions[:, :2] / period)
    wrapped = np.concatenate([tile.positions[:, :2] - shift * period, tile.positions[:, 2:]], axis=1)
    return np.unique(wrapped, axis=0, return_inverse=True)[1], shift.astype(int)


def solids(tile):
    """Triangles [k, 3] of each connected part, and whether it goes on for ever: it holds a vertex and its own copy."""
    place, _ = places(tile)
    corner = place[tile.triangles]
    label = np.arange(place.max() + 1)
    while True:
        least = label.copy()
        np.minimum.at(least, corner.ravel(), np.repeat(label[corner].min(axis=1), 3))
        least = least[least]
        if (least == label).all():
            break
        label = least
    own = label[corner[:, 0]]
    parts = [tile.triangles[own == number] for number in np.unique(own)]
    return [(part, len(np.unique(part)) > len(np.unique(place[part]))) for part in parts]
