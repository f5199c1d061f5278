"""The lines, triangles and colors of a shell's overlays, from what the native module says of it. Knows no
Blender and no GPU.

Everything is in object space; vertices float32 [n, 3], indices uint32 [m, 2] or [m, 3], colors float32 [n, 4] linear RGBA.
"""

import numpy as np

# The edges of a prism: corners 0 to 2 of the base, 3 to 5 of the top above them.
_EDGES = np.array([[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]])


def wires(shell):
    """(vertices, edges) of all prisms, each edge once."""
    triangles = np.asarray(shell.triangles, np.int64)
    count = len(shell.positions)
    low, high = np.zeros((count, 3), np.float32), np.zeros((count, 3), np.float32)
    corners = np.asarray(shell.prisms)[:, :6, :3]
    low[triangles], high[triangles] = corners[:, :3], corners[:, 3:]
    pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    codes = np.unique(pairs[:, 0] * count + pairs[:, 1])
    base = np.stack([codes // count, codes % count], axis=1)
    used = np.unique(triangles)
    rising = np.stack([used, used + count], axis=1)
    return np.concatenate([low, high]), np.concatenate([base, base + count, rising]).astype(np.uint32)


def hulls(shell, marked):
    """(vertices, triangles, edges) of the prisms marked in `marked`, bool [p]."""
    numbers = np.flatnonzero(marked)
    vertices = np.asarray(shell.prisms)[numbers][:, :6, :3].reshape(-1, 3)
    own = np.asarray(shell.indices)[numbers].astype(np.int64) - 6 * numbers[:, None]  # corners 0 to 5
    start = 6 * np.arange(len(numbers))[:, None]
    return (np.ascontiguousarray(vertices), (own + start).reshape(-1, 3).astype(np.uint32),
            (_EDGES[None] + start[..., None]).reshape(-1, 2).astype(np.uint32))


def tops(shell, values):
    """(vertices, triangles, float64 [n]) of the shell's top: values [p] of prisms, averaged around each vertex."""
    triangles = np.asarray(shell.triangles, np.int64)
    count = len(shell.positions)
    vertices = np.zeros((count, 3), np.float32)
    vertices[triangles] = np.asarray(shell.prisms)[:, 3:6, :3]
    sums = np.bincount(triangles.ravel(), np.repeat(values, 3), count)
    return vertices, triangles.astype(np.uint32), sums / np.maximum(np.bincount(triangles.ravel(), minlength=count), 1)


def stretch_level(rms, most):
    """Stretch [p] as -1 (1 / most) to 1 (most), 0 where there is none."""
    safe = np.where(np.isfinite(rms) & (rms > 0.0), rms, most)
    return np.clip(np.log(safe) / np.log(most), -1.0, 1.0)


def angle_level(angle, most):
    """Angles [p] between texture axes as 0 (a right one) to 1 (`most` radians away from it)."""
    return np.clip(np.abs(np.where(np.isfinite(angle), angle, 0.0) - 0.5 * np.pi) / most, 0.0, 1.0)


def gradient(levels, low, even, high):
    """Colors of levels [n] from -1 (low) through 0 (even) to 1 (high)."""
    low, even, high = (np.asarray(color, np.float32) for color in (low, even, high))
    share = np.abs(levels).astype(np.float32)[:, None]
    return np.where(levels[:, None] < 0.0, even + share * (low - even), even + share * (high - even)).astype(np.float32)


def ribbons(edges, tops_of_edges):
    """(vertices, triangles, lines) of cut seams [s, 2, 3] at the base and at the top: a quad between the two."""
    edges, above = np.asarray(edges, np.float32), np.asarray(tops_of_edges, np.float32)
    vertices = np.concatenate([edges, above], axis=1).reshape(-1, 3)  # base 0 and 1, top 2 and 3
    start = 4 * np.arange(len(edges))[:, None]
    triangles = np.concatenate([start + [0, 1, 3], start + [0, 3, 2]]).astype(np.uint32)
    lines = np.concatenate([start + [0, 1], start + [2, 3]]).astype(np.uint32)
    return vertices, triangles, lines


def nearer(eye, share, reach):
    """The matrix [4, 4] that moves everything toward the eye, so that it is drawn before what lies in the same place.

    eye    homogeneous (native eye()): the center of projection, or the direction against the view of a parallel one
    share  of the distance from the eye; in a parallel projection of `reach`, a length
    """
    matrix = np.eye(4)
    if eye[3] != 0.0:
        point = np.asarray(eye[:3], np.float64) / eye[3]
        matrix[:3, :3] *= 1.0 - share
        matrix[:3, 3] = share * point
    else:
        matrix[:3, 3] = share * reach * np.asarray(eye[:3], np.float64) / np.linalg.norm(eye[:3])
    return matrix
