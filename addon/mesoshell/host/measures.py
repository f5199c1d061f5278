"""How large UVs are on a surface: tiles per meter, and a thickness that keeps the tile's proportions.

Both are measured on the mesh at rest, without modifiers, so that a texture neither breathes while the surface is animated
nor depends on the frame at which a file was opened. What the mesh at rest has no UVs for is measured as it is shown.
"""

from typing import NamedTuple

import numpy as np

from . import cages, meshes, versions

_SMALLEST = 1e-12  # of a determinant in UVs


class Fit(NamedTuple):
    """What a shell takes from the measures of its surface; all native build_shell's."""

    thickness: float  # object units
    uv_scale: tuple  # tiles per UV unit, along u and v


def fit(obj, surface, *, thickness, tiles, rotation, metric, tile_height):
    """The Fit of a surface (SurfaceArrays). UvProblem where it must be measured and its UVs have no area.

    thickness  None: tile_height tile widths
    tiles      per UV unit, or per meter where `metric` is not None
    metric     [3, 3], squares of lengths in meters of vectors in object space
    """
    if thickness is not None and metric is None:
        return Fit(thickness, tuple(tiles))
    positions, corners, face_sizes, uvs = _at_rest(obj, surface)
    if metric is not None:
        lengths = mean_unit_lengths(positions @ _root(metric), face_sizes, corners, uvs, obj.name)
        tiles = tuple(np.float32(count * length) for count, length in zip(tiles, lengths))
    if thickness is None:
        cosine, sine = np.cos(rotation), np.sin(rotation)
        placed = (uvs * np.asarray(tiles, np.float64)) @ np.array([[cosine, sine], [-sine, cosine]])
        thickness = tile_height * mean_unit_lengths(positions, face_sizes, corners, placed, obj.name)[0]
    return Fit(float(np.float32(thickness)), tuple(float(count) for count in tiles))


def _root(metric):
    """The symmetric matrix whose square is `metric`."""
    values, vectors = np.linalg.eigh(metric)
    return vectors * np.sqrt(np.maximum(values, 0.0)) @ vectors.T


def mean_unit_lengths(positions, face_sizes, corners, uvs, name):
    """The mean lengths of one unit along u and along v, weighted by area; `name` is for the sentence of UvProblem."""
    faces = np.repeat(np.arange(len(face_sizes)), face_sizes)
    starts = np.cumsum(face_sizes) - face_sizes
    within = np.arange(len(faces)) - starts[faces]
    last = np.flatnonzero(within >= 2)  # a fan: each corner from the third on closes a triangle
    fan = np.stack([starts[faces[last]], last - 1, last], axis=1)
    points = np.asarray(positions, np.float64)[corners[fan]]
    uvs = np.asarray(uvs, np.float64)[fan]
    edge1, edge2 = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    uv1, uv2 = uvs[:, 1] - uvs[:, 0], uvs[:, 2] - uvs[:, 0]
    determinant = uv1[:, 0] * uv2[:, 1] - uv2[:, 0] * uv1[:, 1]
    area = np.linalg.norm(np.cross(edge1, edge2), axis=1)
    usable = (np.abs(determinant) > _SMALLEST) & (area > 0.0)
    if not np.any(usable):
        raise meshes.UvProblem(f'The UVs of "{name}" cover no area: unwrap it again')
    edge1, edge2, uv1, uv2 = (values[usable] for values in (edge1, edge2, uv1, uv2))
    lengths = []
    for axis in (0, 1):
        other = 1 - axis
        along = (edge1 * uv2[:, other:other + 1] - edge2 * uv1[:, other:other + 1]) / determinant[usable, None]
        lengths.append(float(np.average(np.linalg.norm(along, axis=1), weights=area[usable])))
    return tuple(lengths)


def _at_rest(obj, surface):
    """Positions, corners, face sizes and UVs of the mesh at rest; of `surface` where that has no UVs."""
    with cages.rest_mesh(obj) as mesh:
        layer = meshes.render_layer(mesh)
        if layer is None or len(mesh.polygons) == 0:
            return surface.positions, surface.corners, surface.face_sizes, surface.uvs
        positions = np.empty(len(mesh.vertices) * 3, np.float32)
        mesh.vertices.foreach_get("co", positions)
        corners, face_sizes = np.empty(len(mesh.loops), np.int32), np.empty(len(mesh.polygons), np.int32)
        mesh.loops.foreach_get("vertex_index", corners)
        mesh.polygons.foreach_get("loop_total", face_sizes)
        return positions.reshape(-1, 3), corners, face_sizes, versions.uv_array(layer, len(corners))
