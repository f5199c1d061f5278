"""Reads Blender's mesh objects into arrays: the surface for a shell.

What is read is the evaluated object or its control cage (host/cages.py); in Edit mode, what is being edited. Arrays are
private copies.
"""

from typing import NamedTuple

import numpy as np

from ..core.tile_surface import check_finite
from . import cages, parts, versions

# Blender's subdivision takes a crease c for OpenSubdiv's sharpness 10 c^2.
_SHARPEST = 10.0


class UvProblem(ValueError):
    """A mesh whose UVs must be unwrapped first."""


class Reading(NamedTuple):
    """What read_surface() is to read."""

    cage: bool = False
    triangulate: bool = False  # make triangles of all faces
    polygons: bool = False  # leave faces with more than four corners whole
    creases: bool = False
    normals: bool = False
    part: str = 'ALL'  # shell_options.PARTS
    part_name: str = ""
    group: str = ""  # the vertex group of the thickness; empty: none


class SurfaceArrays(NamedTuple):
    """Arguments of the native build_shell; the first MOVING of them are those that update_shell takes as well."""

    positions: np.ndarray  # float32 [n, 3], object space
    normals: np.ndarray  # float32 [n, 3], or None
    thickness_factors: np.ndarray  # float32 [n], or None
    face_sizes: np.ndarray  # int32 [f]
    corners: np.ndarray  # int32 [c], the vertex of each corner
    uvs: np.ndarray  # float32 [c, 2]
    crease_edges: np.ndarray = None  # int32 [e, 2], or None as all that follows
    crease_sharpness: np.ndarray = None  # float32 [e], OpenSubdiv's
    corner_vertices: np.ndarray = None  # int32 [k]
    corner_sharpness: np.ndarray = None  # float32 [k]
    covered: np.ndarray = None  # int32 [f], 0 or 1


MOVING = 3


def read_surface(obj, depsgraph, reading=Reading(), *, known_weights=None):
    """The SurfaceArrays of a mesh object, in its own space; UVs are those of the layer active for render.

    Faces with more than four corners come as Blender's triangles, unless `reading` says otherwise. `known_weights` is a dict
    {vertex group: float32 [n]} of weights that stand as they were read before, and gets what is read now. Raises ValueError
    in a sentence that names the object, UvProblem where it has no UVs.
    """
    known_weights = {} if known_weights is None else known_weights
    groups = {reading.group} | ({reading.part_name} if reading.part == 'VERTEX_GROUP' else set()) - {""}
    with cages.mesh_of(obj, depsgraph, cage=reading.cage, layers=bool(groups - {""})) as mesh:
        face_count, corner_count = len(mesh.polygons), len(mesh.loops)
        if face_count == 0:
            raise ValueError(f'"{obj.name}" has no faces to put a shell on: add faces, or pick another object')
        layer = render_layer(mesh)
        if layer is None:
            raise UvProblem(f'"{obj.name}" has no UVs: unwrap it (Unwrap for the Shell, or Edit mode > UV > Unwrap), '
                            "then add the shell")
        uvs = versions.uv_array(layer, corner_count)
        positions = _array(mesh.vertices, "co", np.float32, 3)
        face_sizes = _array(mesh.polygons, "loop_total", np.int32)
        corners = _array(mesh.loops, "vertex_index", np.int32)
        evaluated = obj.evaluated_get(depsgraph)
        for group in groups - {""}:
            if len(known_weights.get(group, ())) != len(positions):
                known_weights[group] = parts.weights(mesh, evaluated, group)
        covered = None
        if reading.part != 'ALL':
            covered = parts.covered(mesh, evaluated, reading.part, reading.part_name, known_weights.get(reading.part_name))
        creases = _creases(mesh) if reading.creases else (None,) * 4
        normals = _normals(mesh, corners) if reading.normals else None
        to_split = np.full(face_count, True) if reading.triangulate else (face_sizes > 4) & (not reading.polygons)
        if np.any(to_split & (face_sizes > 3)):
            face_sizes, kept, faces = _split(mesh, face_sizes, to_split)
            corners, uvs = corners[kept], uvs[kept]
            covered = None if covered is None else covered[faces]
    check_finite(positions, f'"{obj.name}"')
    if not np.all(np.isfinite(uvs)):
        raise UvProblem(f'"{obj.name}" has UVs that are not finite numbers: unwrap it again')
    return SurfaceArrays(positions, normals, known_weights[reading.group] if reading.group else None, face_sizes,
                         np.ascontiguousarray(corners), np.ascontiguousarray(uvs), *creases,
                         None if covered is None else covered.astype(np.int32))


def render_layer(mesh):
    """The UV layer of a mesh that is active for render, or None."""
    return next((layer for layer in mesh.uv_layers if layer.active_render), None)


def _array(collection, name, kind, width=1):
    values = np.empty(len(collection) * width, kind)
    collection.foreach_get(name, values)
    return values if width == 1 else values.reshape(-1, width)


def _creases(mesh):
    """crease_edges, crease_sharpness, corner_vertices and corner_sharpness of a mesh; None where there are none."""
    of_edges, of_vertices = versions.edge_creases(mesh), versions.vertex_creases(mesh)
    edges = vertices = (None, None)
    if of_edges is not None and of_edges.any():
        sharp = np.flatnonzero(of_edges > 0.0)
        edges = (np.ascontiguousarray(_array(mesh.edges, "vertices", np.int32, 2)[sharp]), _SHARPEST * of_edges[sharp] ** 2)
    if of_vertices is not None and of_vertices.any():
        sharp = np.flatnonzero(of_vertices > 0.0)
        vertices = (sharp.astype(np.int32), _SHARPEST * of_vertices[sharp] ** 2)
    return (*edges, *vertices)


def _normals(mesh, corners):
    """float32 [n, 3]: Blender's normals of vertices; where it has custom ones, the mean over a vertex's corners."""
    normals = _array(mesh.vertex_normals, "vector", np.float32, 3)
    if not versions.has_custom_normals(mesh):
        return normals
    of_corners = versions.corner_normals(mesh)
    sums = np.stack([np.bincount(corners, of_corners[:, axis], len(normals)) for axis in range(3)], axis=1)
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.where(lengths > 1e-6, sums / np.maximum(lengths, 1e-6), normals).astype(np.float32)


def _split(mesh, face_sizes, to_split):
    """Replaces the faces `to_split` by triangles: new face sizes, and the old corner and face of each new one."""
    mesh.calc_loop_triangles()
    corners = _array(mesh.loop_triangles, "loops", np.int32, 3)
    faces = _array(mesh.loop_triangles, "polygon_index", np.int32)
    whole = np.flatnonzero(np.repeat(~to_split, face_sizes))
    split = to_split[faces]
    sizes = np.concatenate([face_sizes[~to_split], np.full(split.sum(), 3, np.int32)])
    return (sizes.astype(np.int32), np.concatenate([whole, corners[split].ravel()]),
            np.concatenate([np.flatnonzero(~to_split), faces[split]]))
