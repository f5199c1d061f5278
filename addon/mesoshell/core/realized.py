"""The realized mesh of a tile in a shell, with what the tile's surface says of its corners; NumPy only."""

from dataclasses import dataclass

import numpy as np

from . import native

# Triangles whose corners are looked at together: some hundred bytes each meanwhile.
_AT_ONCE = 1 << 18

# Of the pieces that prisms cut a tile's triangles into, how many triangles each becomes: between 1.3 and 1.7 for chain, weave,
# squama, bark and fur on tori.
_TRIANGLES_A_PIECE = 1.5


@dataclass(frozen=True)
class Realized:
    """A closed triangle mesh in object space.

    positions   float32 [n, 3]
    triangles   uint32 [m, 3]
    uvs         float32 [m, 3, 2], of the tile's own UVs; or None
    colors      float32 [m, 3, 3], linear; or None
    normals     float32 [m, 3, 3], unit length, where the tile's faces are smooth; or None: flat everywhere
    slots       int32 [m], into TileSurface.slot_names; or None
    texture     float32 [m, 3, 3], (u, v, w)
    open_edges  int
    notices     sentences
    """

    positions: np.ndarray
    triangles: np.ndarray
    uvs: np.ndarray
    colors: np.ndarray
    normals: np.ndarray
    slots: np.ndarray
    texture: np.ndarray
    open_edges: int
    notices: tuple


def estimated_triangles(prisms, surface):
    """About how many triangles the realized mesh will have, before edges are split: the number of pairs of a prism and a
    triangle of the tile that meet, if triangles lie at random (Santaló 1976, "Integral Geometry and Geometric Probability",
    I.6: for convex sets, areas and the product of perimeters over 2 pi).

    prisms   float32 [n, 8, 4], a Shell's
    surface  a TileSurface
    """
    corners = np.stack([np.stack([prisms[:, i, 3], prisms[:, 6, i]], -1) for i in range(3)], 1).astype(float)
    tile = surface.positions[surface.triangles][..., :2] / [1.0, surface.aspect]
    areas, perimeters = _measure(corners)
    own_areas, own_perimeters = _measure(tile)
    pairs = len(tile) * areas.sum() + len(corners) * own_areas.sum() + perimeters.sum() * own_perimeters.sum() / (2 * np.pi)
    return int(_TRIANGLES_A_PIECE * pairs)


def _measure(triangles):
    """Areas and perimeters of triangles [n, 3, 2]."""
    a, b = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    areas = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return areas, np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=-1).sum(axis=1)


def realize(shell, surface, *, error=0.001, caps=True, threads=0, progress=None):
    """The Realized of a TileSurface in a native Shell; raises what the native module raises.

    error  how far edges may lie beside the map's curves, tile widths
    caps   close what the slab, the shell's border and cut seams cut open
    """
    module = native.module()
    sample = module.Sample(surface.positions, surface.triangles, height=surface.height, aspect=surface.aspect,
                           thickness=surface.thickness)
    mesh = module.realize(shell, sample, error=error, caps=caps, normals=_smooth_normals(surface), threads=threads,
                          progress=progress)
    source, weights = mesh["source"], _all_weights(mesh["weights"])
    notices = list(surface.notices)
    if mesh["open_edges"]:
        notices.append(f"{mesh['open_edges']} edges of the realized mesh are open"
                       + ("" if caps else ": its cuts have no caps"))
    return Realized(
        mesh["positions"], mesh["triangles"], _carried(surface.uvs, source, weights),
        _carried(surface.colors, source, weights), mesh.get("normals"),
        None if surface.slots is None else surface.slots[source], mesh["texture"], mesh["open_edges"], tuple(notices))


def _all_weights(two):
    """Three weights [m, 3, 3] of the two [m, 3, 2] of the second and third corners."""
    return np.concatenate([1.0 - two.sum(axis=-1, keepdims=True), two], axis=-1)


def _carried(values, source, weights):
    """[m, 3, k] of a source's values at corners, or None."""
    if values is None:
        return None
    carried = np.empty((*weights.shape[:2], values.shape[-1]), np.float32)
    for start in range(0, len(source), _AT_ONCE):
        own = slice(start, start + _AT_ONCE)
        carried[own] = np.einsum("mij,mjk->mik", weights[own], values[source[own]])
    return carried


def _smooth_normals(surface):
    """Normals [3 m, 3] of a TileSurface's corners, or None if all are those of its faces."""
    if surface.normals is None:
        return None
    faces = _unit(_face_normals(surface.positions[surface.triangles]))
    if ((surface.normals * faces[:, None]).sum(axis=-1) > 1.0 - 1e-6).all():
        return None
    return np.ascontiguousarray(surface.normals.reshape(-1, 3), np.float32)


def _face_normals(corners):
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-30)
