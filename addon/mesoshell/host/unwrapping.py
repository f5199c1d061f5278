"""UVs for a mesh that has none, by Blender's own operators.

They work on what is in Edit mode, and on what is selected there. So they get a copy of the mesh in a scene of its own, which
is gone afterwards: the user's mode, selection and hidden faces stay as they are.
"""

import bmesh
import bpy
import numpy as np

from . import cages, meshes, versions

METHODS = (
    ('SMART', "Smart Project", "Islands of faces that look the same way; needs no seams"),
    ('ANGLE', "Angle Based", "Along the seams that are marked, with little change of angles"),
    ('CONFORMAL', "Conformal", "Along the seams that are marked, faster"),
    ('CUBE', "Cube Projection", "From the six sides of a cube, all in one scale"),
)
_NAME = "UVMap"


def unwrap(obj, method, *, angle_limit, margin):
    """Writes UVs to a mesh object's layer that is active for render, or to a layer that is made; ValueError in a sentence.

    angle_limit  radians, of faces in one island of Smart Project; margin between islands, in UV units
    """
    mesh = obj.data
    if len(mesh.polygons) == 0 and not mesh.is_editmode:
        raise ValueError(f'"{obj.name}" has no faces to unwrap: add faces, or pick another object')
    uvs = _unwrapped(obj, method, angle_limit, margin)
    if not mesh.is_editmode:
        layer = meshes.render_layer(mesh) or mesh.uv_layers.new(name=_NAME)
        if layer is None:
            raise ValueError(f'"{obj.name}" can have no more UV maps: remove one')
        versions.set_uv_array(layer, uvs)
        mesh.update()
        return
    layer = meshes.render_layer(mesh)
    edited = bmesh.from_edit_mesh(mesh)
    layers = edited.loops.layers.uv
    target = (layers.get(layer.name) if layer is not None else None) or layers.active or layers.new(_NAME)
    corners = iter(uvs.tolist())
    for face in edited.faces:
        for loop in face.loops:
            loop[target].uv = next(corners)
    bmesh.update_edit_mesh(mesh)


def _unwrapped(obj, method, angle_limit, margin):
    """UVs float32 [corners, 2] of an object's mesh, as Blender unwraps them."""
    scene = bpy.data.scenes.new("Mesoshell unwrapping")
    mesh = _copy(obj)
    copy = bpy.data.objects.new(obj.name, mesh)
    copy.scale = obj.scale  # Blender corrects for it
    try:
        scene.collection.objects.link(copy)
        view_layer = scene.view_layers[0]
        view_layer.objects.active = copy
        copy.select_set(True, view_layer=view_layer)
        view_layer.update()
        with bpy.context.temp_override(scene=scene, view_layer=view_layer, object=copy, active_object=copy,
                                       selected_objects=[copy]):
            bpy.ops.object.mode_set(mode='EDIT')
            try:
                with bpy.context.temp_override(edit_object=copy, objects_in_mode=[copy],
                                               objects_in_mode_unique_data=[copy]):
                    _run(method, angle_limit, margin)
            finally:
                bpy.ops.object.mode_set(mode='OBJECT')
        return versions.uv_array(meshes.render_layer(mesh), len(mesh.loops))
    finally:
        bpy.data.objects.remove(copy)
        bpy.data.meshes.remove(mesh)
        bpy.data.scenes.remove(scene)


def _copy(obj):
    """The object's own mesh as a data-block of its own, all of it visible and selected, with one UV layer."""
    mesh = obj.data.copy()
    if obj.data.is_editmode:
        bmesh.from_edit_mesh(obj.data).to_mesh(mesh)
    for elements in (mesh.vertices, mesh.edges, mesh.polygons):
        elements.foreach_set("hide", np.zeros(len(elements), bool))
        elements.foreach_set("select", np.ones(len(elements), bool))
    while mesh.uv_layers:
        mesh.uv_layers.remove(mesh.uv_layers[0])
    mesh.uv_layers.new(name=_NAME)
    return mesh


def _run(method, angle_limit, margin):
    if method == 'SMART':
        bpy.ops.uv.smart_project(angle_limit=angle_limit, island_margin=margin)
    elif method == 'CUBE':
        bpy.ops.uv.cube_project(cube_size=1.0, correct_aspect=False)
    else:
        bpy.ops.uv.unwrap(method='ANGLE_BASED' if method == 'ANGLE' else 'CONFORMAL', margin=margin)
