"""Splits long edges in two, so that what bends a mesh bends its faces too, whatever shape they have."""

import numpy as np

from .clipping import edge_keys

_MOST_ROUNDS = 12


def refined(surface, longest):
    """The TileSurface with no edge longer than `longest` (tile widths, seen from above); its shape stays.

    An edge is split by its own length alone, so that both its triangles agree on it, across the tile's borders too.
    """
    for _ in range(_MOST_ROUNDS):
        split = _split(surface, longest)
        if split is None:
            break
        surface = split
    return surface


def _split(surface, longest):
    triangles = surface.triangles.astype(np.int64)
    edges, ends_of = edge_keys(triangles)
    keys, places = np.unique(edges, return_inverse=True)
    start, end = ends_of(keys)
    along = surface.positions[end, :2] - surface.positions[start, :2]
    # A copy of an edge across the border differs in its last bits; no length that a model is likely to have lies here.
    long = np.einsum("ij,ij->i", along, along) > (longest * 0.98736) ** 2
    if not long.any():
        return None
    numbers = np.where(long, len(surface.positions) + np.cumsum(long) - 1, -1)
    middles = (surface.positions[start[long]] + surface.positions[end[long]]) / 2
    middle = numbers[places.ravel()].reshape(-1, 3)  # of the edge from corner k to the next one; -1: not split
    # Turned so that of one split edge it comes first, of two the edge that stays comes last.
    count = (middle >= 0).sum(axis=1)
    first = np.where(count == 1, (middle >= 0).argmax(axis=1), np.where(count == 2, (middle < 0).argmax(axis=1) + 1, 0))
    order = (first[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(triangles, order, axis=1).T
    ab, bc, ca = np.take_along_axis(middle, order, axis=1).T
    eye = np.eye(3)
    wa, wb, wc = eye
    wab, wbc, wca = (wa + wb) / 2, (wb + wc) / 2, (wc + wa) / 2
    patterns = {
        0: [((a, b, c), (wa, wb, wc))],
        1: [((a, ab, c), (wa, wab, wc)), ((ab, b, c), (wab, wb, wc))],
        2: [((ab, b, bc), (wab, wb, wbc)), ((a, ab, bc), (wa, wab, wbc)), ((a, bc, c), (wa, wbc, wc))],
        3: [((a, ab, ca), (wa, wab, wca)), ((ab, b, bc), (wab, wb, wbc)), ((ca, bc, c), (wca, wbc, wc)),
            ((ab, bc, ca), (wab, wbc, wca))],
    }
    parts, source, weights = [], [], []
    for splits, pieces in patterns.items():
        own = np.flatnonzero(count == splits)
        # Back from the turned corners to the triangle's own.
        turned = np.eye(3)[order[own]]
        for corners, shares in pieces:
            parts.append(np.stack(corners, axis=1)[own])
            source.append(own)
            weights.append(np.stack(shares) @ turned)
    return surface.rebuilt(np.concatenate([surface.positions, middles]), np.concatenate(parts), np.concatenate(source),
                           weights=np.concatenate(weights))
