"""Reads Blender's mesh objects into arrays: the surface for a shell.

What is read is the evaluated object: modifiers apply, and in Edit mode the mesh is what is being edited. Arrays are
private copies.
"""

from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from ..core.tile_surface import check_finite
from . import versions


class SurfaceArrays(NamedTuple):
    positions: np.ndarray  # float32 [n, 3], object space
    face_sizes: np.ndarray  # int32 [f]
    corners: np.ndarray  # int32 [c], the vertex of each corner
    uvs: np.ndarray  # float32 [c, 2], in tiles


def read_surface(obj, depsgraph, *, tiles=(1.0, 1.0), triangulate=False, polygons=False):
    """A SurfaceArrays of a mesh object, in its own space; UVs (the layer active for render) times `tiles`.

    Faces with more than four corners come as Blender's triangles, unless `polygons` allows them; `triangulate` makes
    triangles of all. Raises ValueError, in a sentence that names the object.
    """
    evaluated = _evaluated(obj, depsgraph)
    with _temporary_mesh(evaluated) as mesh:
        face_count, corner_count = len(mesh.polygons), len(mesh.loops)
        if face_count == 0:
            raise ValueError(f'"{obj.name}" has no faces to put a shell on: add faces, or pick another object')
        layer = next((layer for layer in mesh.uv_layers if layer.active_render), None)
        if layer is None:
            raise ValueError(f'"{obj.name}" has no UVs: unwrap it (Edit mode > UV > Unwrap), then add the shell')
        uvs = versions.uv_array(layer, corner_count)
        positions = _positions(mesh)
        face_sizes = np.empty(face_count, np.int32)
        mesh.polygons.foreach_get("loop_total", face_sizes)
        corners = np.empty(corner_count, np.int32)
        mesh.loops.foreach_get("vertex_index", corners)
        to_split = np.full(face_count, True) if triangulate else (face_sizes > 4) & (not polygons)
        if np.any(to_split & (face_sizes > 3)):
            face_sizes, kept = _split(mesh, face_sizes, to_split)
            corners, uvs = corners[kept], uvs[kept]
    check_finite(positions, f'"{obj.name}"')
    if not np.all(np.isfinite(uvs)):
        raise ValueError(f'"{obj.name}" has UVs that are not finite numbers: unwrap it again')
    uvs = np.ascontiguousarray(uvs * np.asarray(tiles, np.float32), np.float32)
    return SurfaceArrays(positions, face_sizes, np.ascontiguousarray(corners), uvs)


def mean_unit_length(surface, name):
    """The mean length in object space of one tile along u, weighted by area; `name` is for the sentence of ValueError."""
    faces = np.repeat(np.arange(len(surface.face_sizes)), surface.face_sizes)
    starts = np.cumsum(surface.face_sizes) - surface.face_sizes
    within = np.arange(len(faces)) - starts[faces]
    last = np.flatnonzero(within >= 2)  # a fan: each corner from the third on closes a triangle
    fan = np.stack([starts[faces[last]], last - 1, last], axis=1)
    points = surface.positions.astype(np.float64)[surface.corners[fan]]
    uvs = surface.uvs.astype(np.float64)[fan]
    edge1, edge2 = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    uv1, uv2 = uvs[:, 1] - uvs[:, 0], uvs[:, 2] - uvs[:, 0]
    determinant = uv1[:, 0] * uv2[:, 1] - uv2[:, 0] * uv1[:, 1]
    area = np.linalg.norm(np.cross(edge1, edge2), axis=1)
    usable = (np.abs(determinant) > 1e-12) & (area > 0.0)
    if not np.any(usable):
        raise ValueError(f'The UVs of "{name}" cover no area: unwrap it again')
    along_u = (edge1 * uv2[:, 1:] - edge2 * uv1[:, 1:])[usable] / determinant[usable, None]
    return float(np.average(np.linalg.norm(along_u, axis=1), weights=area[usable]))


def _evaluated(obj, depsgraph):
    evaluated = obj.evaluated_get(depsgraph)
    # An object that is not part of the depsgraph is read as it is; with modifiers that would be the wrong shape.
    if not evaluated.is_evaluated and len(obj.modifiers) > 0:
        raise ValueError(f'Surface "{obj.name}" is disabled in viewports or in an excluded collection, so that its '
                         "modifiers are not evaluated: enable it (hiding it with H is fine), or apply them")
    return evaluated


@contextmanager
def _temporary_mesh(evaluated):
    try:
        mesh = evaluated.to_mesh()
    except RuntimeError as error:
        raise ValueError(f'"{evaluated.name}" has no mesh: pick a mesh object') from error
    try:
        yield mesh
    finally:
        evaluated.to_mesh_clear()


def _positions(mesh):
    positions = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", positions)
    return positions.reshape(-1, 3)


def _triangles(mesh):
    """Blender's triangulation: vertices, corners (both int32 [m, 3]) and faces (int32 [m])."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    vertices, corners, faces = np.empty(count * 3, np.int32), np.empty(count * 3, np.int32), np.empty(count, np.int32)
    mesh.loop_triangles.foreach_get("vertices", vertices)
    mesh.loop_triangles.foreach_get("loops", corners)
    mesh.loop_triangles.foreach_get("polygon_index", faces)
    return vertices.reshape(-1, 3), corners.reshape(-1, 3), faces


def _split(mesh, face_sizes, to_split):
    """Replaces the faces `to_split` by triangles: new face sizes, and the old corner of each new one."""
    _, corners, faces = _triangles(mesh)
    whole = np.flatnonzero(np.repeat(~to_split, face_sizes))
    split = corners[to_split[faces]]
    sizes = np.concatenate([face_sizes[~to_split], np.full(len(split), 3, np.int32)])
    return sizes.astype(np.int32), np.concatenate([whole, split.ravel()])
