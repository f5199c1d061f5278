"""A realized mesh as an object of Blender's: beside the object whose shell it is, with the tile's materials."""

import bpy
import numpy as np

from . import versions

_PLAIN_COLOR, _PLAIN_UVS = "Color", "UVMap"


def add_object(obj, realized, surface, name):
    """A mesh object of a Realized of a TileSurface, in the collections and at the place of `obj`; it becomes the active one."""
    mesh = bpy.data.meshes.new(name)
    made = None
    try:
        _fill(mesh, realized)
        _paint(mesh, realized, surface)
        _shade(mesh, realized)
        made = bpy.data.objects.new(name, mesh)
    except BaseException:
        bpy.data.meshes.remove(mesh)
        raise
    made.matrix_world = obj.matrix_world
    for collection in obj.users_collection:
        collection.objects.link(made)
    return made


def activate(context, obj):
    """Selects an object alone, if the view layer shows it."""
    context.view_layer.update()
    if obj.name not in context.view_layer.objects:
        return
    for other in context.view_layer.objects:
        if other.select_get():
            other.select_set(False)
    obj.select_set(True)
    context.view_layer.objects.active = obj


def _fill(mesh, realized):
    count = len(realized.triangles)
    mesh.vertices.add(len(realized.positions))
    mesh.vertices.foreach_set("co", realized.positions.ravel())
    mesh.loops.add(3 * count)
    mesh.loops.foreach_set("vertex_index", realized.triangles.astype(np.int32).ravel())
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    if not versions.FACE_SIZES_FOLLOW:
        mesh.polygons.foreach_set("loop_total", np.full(count, 3, np.int32))
    mesh.update(calc_edges=True)


def _paint(mesh, realized, surface):
    if realized.uvs is not None:
        layer = mesh.uv_layers.new(name=surface.uv_name or _PLAIN_UVS, do_init=False)
        versions.set_uv_array(layer, realized.uvs)
    if realized.colors is not None:
        attribute = mesh.color_attributes.new(surface.color_name or _PLAIN_COLOR, 'FLOAT_COLOR', 'CORNER')
        colors = np.concatenate([realized.colors, np.ones((*realized.colors.shape[:2], 1), np.float32)], axis=-1)
        attribute.data.foreach_set("color", colors.ravel())
    if realized.slots is None or set(surface.slot_names) == {None}:
        return
    for name in surface.slot_names:
        # Full names: of what is linked, with its library's.
        found = next((material for material in bpy.data.materials if material.name_full == name), None)
        mesh.materials.append(found)
    mesh.polygons.foreach_set("material_index", realized.slots.astype(np.int32))


def _shade(mesh, realized):
    if realized.normals is None:
        versions.shade_flat(mesh)
        return
    mesh.polygons.foreach_set("use_smooth", np.ones(len(realized.triangles), bool))
    versions.set_corner_normals(mesh, realized.normals.reshape(-1, 3))
