"""Walks what a depsgraph shows of some objects: their own meshes and all that they instance.

Curves, text, surfaces and metaballs come as the meshes that Blender makes of them; Geometry Nodes, particles and collection
instances as one visit for each copy.
"""

from contextlib import contextmanager

import bpy
import numpy as np

# What evaluates to a mesh, or shows copies of what does.
SOURCE_TYPES = {'MESH', 'CURVE', 'SURFACE', 'FONT', 'META', 'CURVES', 'POINTCLOUD', 'VOLUME', 'EMPTY'}
MESH_TYPES = {'MESH', 'CURVE', 'SURFACE', 'FONT', 'META'}


def visit(depsgraph, objects, see, see_volume):
    """Calls `see(obj, matrix_world)` for each mesh that `objects` (originals) show, evaluated.

    `obj` lives as long as the call. Volumes go to `see_volume(obj, matrix_world)`. An object that is asked for alone counts
    even if it is hidden; among several, one that is drawn as wires or bounds (a cutter, say) does not. Returns how many such
    were left out.
    """
    wanted = set(objects)
    seen, shown, volumes, converted, left_out = set(), set(), [], [], 0
    for instance in depsgraph.object_instances:
        obj = instance.object
        owner = instance.parent if instance.is_instance else obj
        if owner is None or owner.original not in wanted or not instance.show_self:
            continue
        if obj.type not in MESH_TYPES and obj.type != 'VOLUME':
            continue
        if len(wanted) > 1 and obj.display_type in {'WIRE', 'BOUNDS'}:
            left_out += 1
            continue
        matrix = np.array(instance.matrix_world, np.float64)
        if obj.type == 'VOLUME':
            seen.add(owner.original)
            volumes.append((obj.original, matrix))
            continue
        if not isinstance(obj.data, bpy.types.Mesh):
            # A curve is there twice: as it is edited, and as an instance of the mesh that it becomes.
            converted.append(owner.original)
            continue
        seen.add(owner.original)
        shown.add(obj.original)
        see(obj, matrix)
    for original, matrix in volumes:
        # One that becomes a mesh is there twice too, as what is left of it and as an instance of the mesh.
        if original.type != 'VOLUME' or original not in shown:
            see_volume(original.evaluated_get(depsgraph), matrix)
    missing = [owner for owner in converted if owner not in seen]
    if len(wanted) == 1 and not seen:
        missing = list(wanted)
    for owner in missing:
        evaluated = owner.evaluated_get(depsgraph)
        if evaluated.type in MESH_TYPES:
            see(evaluated, np.array(evaluated.matrix_world, np.float64))
        elif evaluated.type == 'VOLUME':
            see_volume(evaluated, np.array(evaluated.matrix_world, np.float64))
    return left_out


@contextmanager
def mesh_of(obj):
    """The mesh of an evaluated object for as long as the block runs, or None."""
    try:
        mesh = obj.to_mesh()
    except RuntimeError:
        mesh = None
    try:
        yield mesh
    finally:
        obj.to_mesh_clear()


def slot_material(obj, index):
    """The original of the material in a slot of an evaluated object, or None."""
    slot = obj.material_slots[index] if index < len(obj.material_slots) else None
    if slot is not None and slot.link == 'OBJECT':
        material = slot.material
    else:  # the evaluated mesh knows what nodes assigned, the slots may not
        material = obj.data.materials[index] if index < len(obj.data.materials) else None
    return None if material is None else material.original


def is_evaluated(obj, depsgraph):
    """Whether the depsgraph knows an object; what is disabled in viewports or in an excluded collection it does not."""
    return obj.evaluated_get(depsgraph).is_evaluated
