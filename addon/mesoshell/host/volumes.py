"""Blender's volumes, which are OpenVDB grids, as meshes: by Blender's own OpenVDB, in the modifier Volume to Mesh.

The modifier works on an object in a scene of its own, with a depsgraph of its own, and all of that is gone afterwards:
nothing that a user sees is touched. A density is solid where it is above the threshold, a level set where it is below. Its
surface is where Blender puts it: on OpenVDB's own nodes in 5.2, half a voxel on from them in 3.4 and 4.3.
"""

import os
from contextlib import contextmanager

import bpy
import numpy as np

from . import tile_box


def grid_of(obj, options):
    """The name of the grid of an evaluated volume object that TileOptions mean; ValueError."""
    _check_openvdb(f'The volume "{obj.name}"')
    if options.threshold < 0.0:
        raise ValueError(f'The volume "{obj.name}" can not be read at the threshold {options.threshold:g}: Blender takes '
                         "zero or more, so shrink a level set before you bake it")
    grids = obj.data.grids
    if not grids.is_loaded and not grids.load():
        raise ValueError(f'The volume "{obj.name}" can not be read ({grids.error_message}): choose its file again')
    names = [grid.name for grid in grids]
    if not names:
        raise ValueError(f'The volume "{obj.name}" has no grids: choose a file that has some, or give it a modifier')
    if options.grid_name:
        if options.grid_name not in names:
            known = ", ".join(f'"{name}"' for name in names)
            raise ValueError(f'The volume "{obj.name}" has no grid "{options.grid_name}": choose one of {known}')
        return options.grid_name
    return "density" if "density" in names else names[min(max(grids.active_index, 0), len(names) - 1)]


@contextmanager
def as_meshes(grids, scene, options):
    """{volume object: evaluated object whose mesh is the volume's surface, in the volume's own space} while the block runs.

    `grids` is {volume object: name of its grid}, of originals; `scene` says which frame it is. ValueError.
    """
    scene_of_its_own = bpy.data.scenes.new("Mesoshell volumes")
    added = {}
    try:
        scene_of_its_own.frame_current = scene.frame_current
        for obj, grid in grids.items():
            added[obj] = _mesh_object(obj, grid, scene_of_its_own, options.threshold)
        view_layer = scene_of_its_own.view_layers[0]
        view_layer.update()
        evaluated = {obj: copy.evaluated_get(view_layer.depsgraph) for obj, copy in added.items()}
        for obj, copy in evaluated.items():
            if len(copy.data.polygons) == 0:
                raise ValueError(f'The volume "{obj.name}" has no surface at the threshold {options.threshold:g} in its '
                                 f'grid "{grids[obj]}": choose a threshold among its values, such as 0 for a level set')
        yield evaluated
    finally:
        for copy in added.values():
            mesh = copy.data
            bpy.data.objects.remove(copy)
            bpy.data.meshes.remove(mesh)
        bpy.data.scenes.remove(scene_of_its_own)


@contextmanager
def from_file(path):
    """A volume object of a file of grids (.vdb), in no scene; gone after the block. ValueError."""
    name = os.path.basename(path)
    _check_openvdb(name)
    volume = bpy.data.volumes.new(name)
    obj = None
    try:
        volume.filepath = path
        if not volume.grids.load():
            raise ValueError(f"The grid {path} can not be read ({volume.grids.error_message}): choose another file")
        obj = bpy.data.objects.new(name, volume)
        yield obj
    finally:
        if obj is not None:
            bpy.data.objects.remove(obj)
        bpy.data.volumes.remove(volume)


def box_around(name, mesh_object):
    """The TileBox of a mesh's bounds, in its own space."""
    corners = np.array(mesh_object.bound_box, np.float64)
    low, high = corners.min(axis=0), corners.max(axis=0)
    high[2] += tile_box.SNAP_MARGIN * (high[2] - low[2])
    return tile_box.TileBox(name, np.eye(4), low, high)


def _mesh_object(obj, grid, scene, threshold):
    copy = bpy.data.objects.new(obj.name, bpy.data.meshes.new(obj.name))
    scene.collection.objects.link(copy)
    # The modifier gives the volume's surface in the space of its own object.
    copy.matrix_world = obj.matrix_world
    modifier = copy.modifiers.new("Surface", 'VOLUME_TO_MESH')
    modifier.object, modifier.grid_name, modifier.threshold = obj, grid, threshold
    modifier.resolution_mode, modifier.adaptivity, modifier.use_smooth_shade = 'GRID', 0.0, True
    return copy


def _check_openvdb(who):
    if not bpy.app.build_options.openvdb:
        raise ValueError(f"{who} can not be read, because this Blender is built without OpenVDB: use one that has it, or "
                         "save the grid as an array of NumPy's (.npy)")
