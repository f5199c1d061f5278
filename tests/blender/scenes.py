"""Small objects for the tests, made by arrays, and what is true of them in closed form."""

import gc
import os
from pathlib import Path

import bpy
import numpy as np

# The lattice of spheres, in tile widths: one sphere a tile, that stays clear of the slab's top and bottom.
RADIUS, HEIGHT, ASPECT = 0.3, 0.8, 1.25
CENTER = np.array([0.5, 0.5 * ASPECT, 0.5 * HEIGHT])
WIDTH = 2.0  # object units of one tile width: settings and positions must be divided by it

# 8 directions times 8 heights: 64 terms are all there are.
SMALL_BAKE = dict(resolution=(16, 20, 8), directions=(8, 16), sdf_resolution=(32, 40, 27), terms=64, layout="paper",
                  precision="float")


def resident():
    """Bytes of this process that are in memory."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def everything():
    """What is in the file, by collection and pointer."""
    return {name: {item.as_pointer() for item in getattr(bpy.data, name)}
            for name in ("objects", "meshes", "lights", "images", "collections", "curves", "volumes", "armatures", "actions",
                         "cameras", "materials", "node_groups")}


def restore(before):
    """Removes what came since everything(), and the scene's settings."""
    added = [item for name, known in before.items() for item in getattr(bpy.data, name)
             if item.as_pointer() not in known]
    bpy.data.batch_remove(added)
    bpy.context.scene.property_unset("mesoshell")
    bpy.context.view_layer.update()


def make_object(name, positions, faces, uvs=None):
    """A mesh object in the scene; faces is a list of vertex lists, uvs [corners, 2]."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(p) for p in np.asarray(positions, float)], [], [list(map(int, face)) for face in faces])
    if uvs is not None:
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", np.asarray(uvs, np.float32).ravel())
    mesh.update()
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def make_sphere_mesh(rings=96, segments=192):
    """A unit sphere: positions [n, 3] and triangles; its faces lie within 1e-3 of the true sphere (relative)."""
    theta = np.linspace(0.0, np.pi, rings + 1)[1:-1]
    phi = np.arange(segments) * (2 * np.pi / segments)
    grid = np.stack([np.sin(theta)[:, None] * np.cos(phi), np.sin(theta)[:, None] * np.sin(phi),
                     np.repeat(np.cos(theta)[:, None], segments, axis=1)], axis=-1).reshape(-1, 3)
    positions = np.vstack([grid, [[0, 0, 1]], [[0, 0, -1]]])
    i, j = np.meshgrid(np.arange(rings - 2), np.arange(segments), indexing="ij")
    a, b = i * segments + j, i * segments + (j + 1) % segments
    c, d = a + segments, b + segments
    k = np.arange(segments)
    north, south = len(grid), len(grid) + 1
    last = (rings - 2) * segments
    triangles = np.vstack([
        np.stack([a, c, d], -1).reshape(-1, 3), np.stack([a, d, b], -1).reshape(-1, 3),
        np.stack([np.full(segments, north), k, (k + 1) % segments], -1),
        np.stack([np.full(segments, south), last + (k + 1) % segments, last + k], -1)])
    return positions, triangles


def make_tile(name, radius=RADIUS, center=CENTER):
    """The tile object of the lattice of spheres, WIDTH object units wide, moved and turned as no bake may care about."""
    positions, triangles = make_sphere_mesh()
    obj = make_object(name, (positions * radius + center) * WIDTH, triangles)
    tile = obj.mesoshell_tile
    tile.is_tile, tile.period_u, tile.period_v, tile.height = True, WIDTH, WIDTH * ASPECT, WIDTH * HEIGHT
    obj.location, obj.rotation_euler, obj.scale = (3.0, -2.0, 1.0), (0.3, 0.2, 1.0), (0.7, 0.7, 0.7)
    return obj


def make_torus(name, major=1.0, minor=0.4, around=32, across=16):
    """A torus of quads with UVs in [0, 1], u around and v across."""
    u, v = np.meshgrid(np.arange(around) / around, np.arange(across) / across, indexing="ij")
    ring = major + minor * np.cos(2 * np.pi * v)
    positions = np.stack([ring * np.cos(2 * np.pi * u), ring * np.sin(2 * np.pi * u),
                          minor * np.sin(2 * np.pi * v)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    i2, j2 = (i + 1) % around, (j + 1) % across
    faces = np.stack([i * across + j, i2 * across + j, i2 * across + j2, i * across + j2], -1).reshape(-1, 4)
    uvs = np.stack([np.stack([i, j], -1), np.stack([i + 1, j], -1), np.stack([i + 1, j + 1], -1),
                    np.stack([i, j + 1], -1)], axis=2).reshape(-1, 2) / [around, across]
    return make_object(name, positions, faces, uvs)


def make_grid(name, side=4, size=2.0):
    """A flat grid of side x side quads, in rows along x, with UVs in [0, 1]."""
    ticks = np.linspace(0.0, 1.0, side + 1)
    places = np.array([(x, y, 0.0) for y in ticks for x in ticks])
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    faces = np.stack([first, first + 1, first + side + 2, first + side + 1], axis=1)
    return make_object(name, places * size, faces, places[faces.ravel()][:, :2])


def add_shell(obj, path, **settings):
    """Puts a shell on an object by the operator."""
    bpy.context.view_layer.update()
    assert bpy.ops.mesoshell.add_shell(object=obj.name, filepath=str(path), **settings) == {'FINISHED'}


def make_bone(name, obj):
    """An armature of one bone along +z that holds all of `obj`, whose modifier is the first of its stack."""
    armature = bpy.data.armatures.new(name)
    rig = bpy.data.objects.new(name, armature)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode='EDIT')
    armature.edit_bones.new("Bone").tail = (0.0, 0.0, 1.0)
    bpy.ops.object.mode_set(mode='OBJECT')
    obj.vertex_groups.new(name="Bone").add(range(len(obj.data.vertices)), 1.0, 'REPLACE')
    modifier = obj.modifiers.new("Armature", 'ARMATURE')
    modifier.object = rig
    rig.pose.bones["Bone"].rotation_mode = 'XYZ'
    return rig


def animate_bone(rig, frames, location=(3.0, -1.0, 2.0), rotation=(0.3, 0.5, 2.0)):
    """Moves the rig's bone from rest at frame 1 to `location` and `rotation` at the last of `frames`."""
    bone = rig.pose.bones["Bone"]
    for frame, share in ((1, 0.0), (frames, 1.0)):
        bone.location = np.array(location) * share
        bone.rotation_euler = np.array(rotation) * share
        bone.keyframe_insert("location", frame=frame)
        bone.keyframe_insert("rotation_euler", frame=frame)


def bone_motion(rig):
    """The rigid motion [4, 4] of the rig's bone from rest, in the scene's current frame, in the rig's space."""
    bone = rig.evaluated_get(bpy.context.evaluated_depsgraph_get()).pose.bones["Bone"]
    return np.array(bone.matrix) @ np.linalg.inv(np.array(bone.bone.matrix_local))


def make_plane(name, size=2.0, uv_scale=1.0):
    """One quad in the plane z = 0 whose UVs run from 0 to `uv_scale`."""
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    return make_object(name, np.hstack([corners * size, np.zeros((4, 1))]), [[0, 1, 2, 3]], corners * uv_scale)


def lattice_distance(position, direction, reach=8):
    """Along one ray in metric texture space: (distance to the first sphere or out of the slab, clearance).

    The clearance is how far the ray stays from grazing any sphere; 0 distance inside a sphere.
    """
    direction = direction / np.linalg.norm(direction)
    exit_distance = ((HEIGHT if direction[2] > 0 else 0.0) - position[2]) / direction[2]
    shifts = np.stack(np.meshgrid(np.arange(-reach, reach + 1), np.arange(-reach, reach + 1)), -1).reshape(-1, 2)
    centers = CENTER + np.column_stack([shifts * [1.0, ASPECT], np.zeros(len(shifts))])
    toward = centers - position
    along = toward @ direction
    off = np.sqrt(np.maximum(np.sum(toward ** 2, axis=1) - along ** 2, 0.0))
    half = np.sqrt(np.maximum(RADIUS ** 2 - off ** 2, 0.0))
    clearance = np.min(np.abs(off - RADIUS))
    if np.any(np.linalg.norm(toward, axis=1) < RADIUS):
        return 0.0, clearance
    entries = (along - half)[(off < RADIUS) & (along - half > 0)]
    return min([exit_distance, *entries]), clearance
