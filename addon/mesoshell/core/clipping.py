"""Cuts a mesh at planes across its axes: every triangle's part on one side, and which part of which triangle it is.

Two triangles that share an edge share what a plane makes of it, so that what was joined stays joined. Cuts are left open.
"""

from typing import NamedTuple

import numpy as np

# Tile widths. What is this near to a plane lies in it: the native Sample takes places this near for one.
SNAP = 1e-5


class Parts(NamedTuple):
    positions: np.ndarray  # float64 [n, 3]
    triangles: np.ndarray  # int [m, 3]
    source: np.ndarray  # int [m], the triangle that each is part of
    weights: np.ndarray  # float64 [m, 3, 3], its corners as means of the corners of that one


def edge_keys(triangles):
    """Numbers of the edges of triangles [m, 3], from corner k to the next, the same whichever way it runs: int64 [m, 3].

    And a function that gives the lower and the higher vertex of such numbers.
    """
    base = np.int64(triangles.max(initial=0)) + 1
    ends = triangles.astype(np.int64), np.roll(triangles, -1, axis=1).astype(np.int64)
    return np.minimum(*ends) * base + np.maximum(*ends), lambda keys: np.divmod(keys, base)


def whole(positions, triangles):
    """The Parts of a mesh that nothing has cut yet."""
    count = len(triangles)
    return Parts(np.array(positions, np.float64), np.asarray(triangles, np.int64), np.arange(count),
                 np.broadcast_to(np.eye(3), (count, 3, 3)))


def cut(parts, axis, limit, side):
    """What lies on one side of the plane at `limit` across `axis`: beyond it for side 1, below it for side -1.

    Triangles in the plane itself are dropped: where a mirror stands there, its two sides are one solid.
    """
    positions = parts.positions.copy()
    distance = side * (positions[:, axis] - limit)
    near = np.abs(distance) <= SNAP
    positions[near, axis], distance[near] = limit, 0.0
    sign = np.sign(distance)[parts.triangles]
    kept = (sign >= 0).all(axis=1) & (sign > 0).any(axis=1)
    crossing = np.flatnonzero((sign < 0).any(axis=1) & (sign > 0).any(axis=1))
    inside = sign[crossing] >= 0
    # Turned so that the corner that is alone on its side comes first: a triangle there, or what it leaves of one.
    alone = inside.sum(axis=1) == 1
    first = np.where(alone, inside.argmax(axis=1), (~inside).argmax(axis=1))
    order = (first[:, None] + np.arange(3)) % 3
    corners = np.take_along_axis(parts.triangles[crossing], order, axis=1)
    own = np.take_along_axis(parts.weights[crossing], order[:, :, None], axis=1)
    ends = [_on_edge(distance, corners[:, 0], corners[:, k], own[:, 0], own[:, k]) for k in (1, 2)]
    numbers, positions = _numbered(positions, distance, corners, axis, limit)
    rest = ~alone
    pieces = [
        (parts.triangles[kept], parts.source[kept], parts.weights[kept]),
        _piece(parts, crossing, alone, (corners[:, 0], numbers[0], numbers[1]), (own[:, 0], ends[0], ends[1])),
        _piece(parts, crossing, rest, (numbers[0], corners[:, 1], corners[:, 2]), (ends[0], own[:, 1], own[:, 2])),
        _piece(parts, crossing, rest, (numbers[0], corners[:, 2], numbers[1]), (ends[0], own[:, 2], ends[1])),
    ]
    triangles, source, weights = (np.concatenate([piece[k] for piece in pieces]) for k in range(3))
    # Where a corner lies in the plane, a quadrangle is a triangle, and one of its halves is none.
    real = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return Parts(positions, triangles[real], source[real], weights[real])


def compact(parts):
    """The same without vertices that no triangle uses."""
    used, numbers = np.unique(parts.triangles, return_inverse=True)
    return parts._replace(positions=parts.positions[used], triangles=numbers.reshape(-1, 3))


def _on_edge(distance, start, end, at_start, at_end):
    """Weights [k, 3] of the places where edges meet the plane."""
    share = (distance[start] / (distance[start] - distance[end]))[:, None]
    return at_start * (1.0 - share) + at_end * share


def _numbered(positions, distance, corners, axis, limit):
    """The vertices where the edges from corner 0 to corners 1 and 2 meet the plane, int [2, k], and all positions."""
    edges, ends_of = edge_keys(corners)
    keys, places = np.unique(edges[:, [0, 2]].T, return_inverse=True)
    low, high = ends_of(keys)
    share = (distance[low] / (distance[low] - distance[high]))[:, None]
    added = positions[low] * (1.0 - share) + positions[high] * share
    added[:, axis] = limit
    numbers = np.arange(len(keys)) + len(positions)
    # An edge that ends in the plane has its vertex there already.
    numbers = np.where(distance[low] == 0.0, low, np.where(distance[high] == 0.0, high, numbers))
    return numbers[places.ravel()].reshape(2, -1), np.concatenate([positions, added])


def _piece(parts, crossing, chosen, corners, weights):
    return (np.stack(corners, axis=1)[chosen], parts.source[crossing][chosen], np.stack(weights, axis=1)[chosen])
