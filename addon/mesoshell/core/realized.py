"""The realized mesh of a tile in a shell, with what the tile's surface says of its corners; NumPy only."""

from dataclasses import dataclass

import numpy as np

from . import native

# Corners whose normals are made at once: a few hundred bytes each meanwhile.
_AT_ONCE = 1 << 18

# A face shows its source where it lies in the source's plane to this cosine; a cap, which has no source, hardly ever does.
_IN_PLANE = 0.99

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
    mesh = module.realize(shell, sample, error=error, caps=caps, threads=threads, progress=progress)
    source, weights = mesh["source"], _all_weights(mesh["weights"])
    notices = list(surface.notices)
    if mesh["open_edges"]:
        notices.append(f"{mesh['open_edges']} edges of the realized mesh are open"
                       + ("" if caps else ": its cuts have no caps"))
    return Realized(
        mesh["positions"], mesh["triangles"], _carried(surface.uvs, source, weights),
        _carried(surface.colors, source, weights), _normals(shell.prisms, surface, mesh, weights),
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


def _normals(prisms, surface, mesh, weights):
    """Corner normals [m, 3, 3] as the tile's are shaded, by the inverse transpose of the map's Jacobian; None if all are flat."""
    if surface.normals is None:
        return None
    faces = _unit(_face_normals(surface.positions[surface.triangles]))
    smooth = (surface.normals * faces[:, None]).sum(axis=-1).min(axis=1) < 1.0 - 1e-6
    if not smooth.any():
        return None
    flat = _unit(_face_normals(mesh["positions"][mesh["triangles"]].astype(float)))
    normals = np.repeat(flat[:, None], 3, axis=1).astype(np.float32)
    source = mesh["source"]
    scale = np.array([1.0, surface.aspect, surface.height])
    for start in range(0, len(source), _AT_ONCE):
        own = np.flatnonzero(smooth[source[start:start + _AT_ONCE]]) + start
        lies = _unit(_face_normals(mesh["texture"][own].astype(float) * scale))
        # Mirrored prisms turn triangles over, and repair may have turned the tile's.
        side = (lies * faces[source[own]]).sum(axis=1)
        own, side = own[np.abs(side) > _IN_PLANE], side[np.abs(side) > _IN_PLANE]
        tile = np.einsum("mij,mjk->mik", weights[own], surface.normals[source[own]])
        mapped = _unit(np.einsum("mikl,mil->mik", _cofactors(prisms[mesh["prism"][own]], mesh["texture"][own], scale), tile))
        # On the side of the face, whichever way prism and tile are turned.
        back = (mapped * flat[own][:, None]).sum(axis=-1).sum(axis=1) < 0.0
        mapped[back] *= -1.0
        normals[own] = mapped
    return normals


def _cofactors(prisms, texture, scale):
    """Cofactor matrices [m, 3, 3, 3] of the map from metric texture space, at texture coordinates [m, 3, 3] in prisms [m, 8, 4]."""
    base, top = prisms[:, :3, :3].astype(float), prisms[:, 3:6, :3].astype(float)
    uv = np.stack([prisms[:, :3, 3], prisms[:, 6, :3]], -1).astype(float)
    uv_top = np.stack([prisms[:, 3:6, 3], np.concatenate([prisms[:, 6, 3:], prisms[:, 7, :2]], 1)], -1).astype(float)
    w = texture[..., 2:].astype(float)

    def at_height(low, high):
        """[m, corners of the triangle, corners of the prism, k] of what is linear in the height."""
        return low[:, None] + (high - low)[:, None] * w[..., None]

    columns, tiles = at_height(base, top), at_height(uv, uv_top)
    along, across = (np.stack([values[:, :, 1] - values[:, :, 0], values[:, :, 2] - values[:, :, 0]], -1)
                     for values in (columns, tiles))
    to_weights = np.linalg.inv(across)
    by_uv = along @ to_weights  # [m, 3, 3, 2]
    two = np.einsum("mikl,mil->mik", to_weights, texture[..., :2] - tiles[:, :, 0])
    three = np.concatenate([1.0 - two.sum(axis=-1, keepdims=True), two], -1)
    slant = np.einsum("mij,mjk->mik", three, uv_top - uv)
    by_w = np.einsum("mij,mjk->mik", three, top - base) - np.einsum("mikl,mil->mik", by_uv, slant)
    a, b, c = by_uv[..., 0] / scale[0], by_uv[..., 1] / scale[1], by_w / scale[2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], -1)


def _face_normals(corners):
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-30)
