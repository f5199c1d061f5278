"""Makes any tile periodic: 2 x 2 mirrored copies of what its box holds.

What stands over a side of the box is cut off there and left open: its mirror image closes it. A mesh that hangs together
across the borders, as one that is periodic already does, keeps what it is: what is over one side is what is missing at the
other, and comes back there first.
"""

from dataclasses import replace

import numpy as np

from . import clipping

_TURNED = [2, 1, 0]  # corners of a triangle in a mirror: its outside stays out


def mirrored(surface):
    """The TileSurface of 2 x 2 mirrored copies; its period is two widths of the given one, and lengths are in those.

    ValueError if the box holds nothing.
    """
    parts = clipping.whole(surface.positions, surface.triangles)
    period = np.array([1.0, surface.aspect])
    if _open_edges(surface, period) < _open_edges(surface, None):
        parts = _come_back(parts, period)
    for axis, limit, side in ((0, 0.0, 1), (0, 1.0, -1), (1, 0.0, 1), (1, surface.aspect, -1)):
        parts = clipping.cut(parts, axis, limit, side)
    parts = clipping.compact(parts)
    if len(parts.triangles) == 0:
        raise ValueError(f'Tile "{surface.name}" has nothing within the sides of its box: move the box')
    inside = surface.rebuilt(parts.positions, parts.triangles, parts.source, weights=parts.weights)
    half = _joined(inside, _reflected(inside, 0, 1.0))
    whole = _joined(half, _reflected(half, 1, surface.aspect))
    return replace(whole, positions=whole.positions / 2, height=surface.height / 2, thickness=surface.thickness / 2)


def _open_edges(surface, period):
    """How many edges have an odd number of triangles, where vertices at one place (modulo `period`, if given) are one."""
    places = surface.positions
    if period is not None:
        places = np.column_stack([places[:, :2] - np.floor(places[:, :2] / period + clipping.SNAP) * period, places[:, 2]])
    numbers = np.unique(np.round(places / clipping.SNAP).astype(np.int64), axis=0, return_inverse=True)[1]
    edges = clipping.edge_keys(numbers.ravel()[surface.triangles])[0]
    return int((np.unique(edges, return_counts=True)[1] % 2).sum())


def _come_back(parts, period):
    """Parts with the copies by whole periods of all that stands over a side."""
    corners = parts.positions[parts.triangles][..., :2] / period
    low, high = corners.min(axis=1), corners.max(axis=1)
    first, last = np.floor(low.min(axis=0)).astype(int), np.ceil(high.max(axis=0)).astype(int)
    copies = []
    for column in range(first[0], last[0]):
        for row in range(first[1], last[1]):
            cell = np.array([column, row])
            own = ((high > cell) & (low < cell + 1)).all(axis=1)
            copy = clipping.compact(clipping.Parts(
                parts.positions, parts.triangles[own], parts.source[own], parts.weights[own]))
            copies.append(copy._replace(positions=copy.positions - [*(cell * period), 0.0]))
    starts = np.cumsum([0, *(len(copy.positions) for copy in copies[:-1])])
    return clipping.Parts(np.concatenate([copy.positions for copy in copies]),
                          np.concatenate([copy.triangles + start for copy, start in zip(copies, starts)]),
                          np.concatenate([copy.source for copy in copies]),
                          np.concatenate([copy.weights for copy in copies]))


def _reflected(surface, axis, limit):
    """The image of a surface in a mirror at `limit` across an axis."""
    positions = surface.positions.copy()
    positions[:, axis] = 2.0 * limit - positions[:, axis]
    normals = None
    if surface.normals is not None:
        normals = surface.normals[:, _TURNED].copy()
        normals[..., axis] *= -1.0
    return surface.rebuilt(positions, surface.triangles[:, _TURNED], np.arange(len(surface.triangles)), corners=_TURNED,
                           normals=normals)


def _joined(first, second):
    triangles = np.concatenate([first.triangles, second.triangles + len(first.positions)])
    both = np.concatenate([first.positions, second.positions])
    arrays = {name: None if getattr(first, name) is None else np.concatenate([getattr(first, name), getattr(second, name)])
              for name in ("normals", "colors", "uvs", "material_indices", "slots")}
    return replace(first, positions=both, triangles=triangles, **arrays)
