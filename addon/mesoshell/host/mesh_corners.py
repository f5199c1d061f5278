"""What one evaluated mesh says at the corners of its triangles: where, which way, which color, which part of an image.

All of it comes by foreach_get; every array is a private copy.
"""

from typing import NamedTuple

import numpy as np

from . import versions

# Attribute types that can be a color: the member of an element, and how many numbers it has.
_VALUES = {"FLOAT_COLOR": ("color", 4), "BYTE_COLOR": ("color", 4), "FLOAT_VECTOR": ("vector", 3), "FLOAT": ("value", 1)}


class MeshCorners(NamedTuple):
    positions: np.ndarray  # float32 [n, 3], the mesh's own space
    triangles: np.ndarray  # int32 [m, 3]
    normals: np.ndarray  # float32 [m, 3, 3], unit length, as the object is shaded
    slots: np.ndarray  # int32 [m], the material slot
    loops: np.ndarray  # int32 [m, 3], the corner of the mesh that each corner of a triangle is
    faces: np.ndarray  # int32 [m]


def read(mesh):
    """The MeshCorners of a mesh; its normals are computed if need be."""
    normals = versions.corner_normals(mesh)
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    positions = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", positions)
    arrays = {}
    for name, width in (("vertices", 3), ("loops", 3), ("polygon_index", 1), ("material_index", 1)):
        arrays[name] = np.empty(count * width, np.int32)
        mesh.loop_triangles.foreach_get(name, arrays[name])
    loops = arrays["loops"].reshape(-1, 3)
    return MeshCorners(positions.reshape(-1, 3), arrays["vertices"].reshape(-1, 3), normals[loops],
                       arrays["material_index"], loops, arrays["polygon_index"])


def colors(mesh, corners, name):
    """Linear RGB float32 [m, 3, 3] of a color attribute, or None if the mesh has no such.

    An empty name asks for the active one.
    """
    attribute = _color_attribute(mesh, name)
    if attribute is None or attribute.data_type not in _VALUES or attribute.domain not in {'POINT', 'CORNER', 'FACE'}:
        return None
    member, width = _VALUES[attribute.data_type]
    values = np.empty(len(attribute.data) * width, np.float32)
    attribute.data.foreach_get(member, values)
    values = values.reshape(-1, width)[:, :3]
    element = {'POINT': corners.triangles, 'CORNER': corners.loops}.get(attribute.domain)
    if element is None:
        element = np.repeat(corners.faces[:, None], 3, axis=1)
    picked = values[element]
    return np.ascontiguousarray(np.broadcast_to(picked, (*picked.shape[:2], 3)), np.float32)


def uvs(mesh, corners, name):
    """UVs float32 [m, 3, 2] of a layer, or None if the mesh has no such; an empty name asks for the one that renders."""
    layer = _uv_layer(mesh, name)
    if layer is None:
        return None
    return versions.uv_array(layer, len(mesh.loops))[corners.loops]


def uv_name(mesh):
    """Name of the UV layer that renders; empty if there is none."""
    layer = _uv_layer(mesh, "")
    return "" if layer is None else layer.name


def color_name(mesh):
    """Name of the color attribute that an empty name asks for; empty if there is none."""
    attribute = _color_attribute(mesh, "")
    return "" if attribute is None else attribute.name


def _uv_layer(mesh, name):
    layers = mesh.uv_layers
    return layers.get(name) if name else next((layer for layer in layers if layer.active_render), None)


def _color_attribute(mesh, name):
    if name:
        return mesh.attributes.get(name)
    attributes = mesh.color_attributes
    active = attributes.active_color
    if active is None and len(attributes) > 0:  # nodes store colors without making one active
        active = attributes[0]
    return active
