"""Which faces of a mesh a shell covers, and the weights of its vertices: by material, vertex group or attribute."""

import numpy as np

# Attribute types that can mark: what an element's number is called.
_VALUES = {'BOOLEAN': "value", 'INT': "value", 'INT8': "value", 'FLOAT': "value"}
_WHOLE = {'BOOLEAN', 'INT', 'INT8'}
_MARKED = 0.5  # the least weight

# Modifiers that change weights as time goes by.
_WEIGHING = {'VERTEX_WEIGHT_EDIT', 'VERTEX_WEIGHT_MIX', 'VERTEX_WEIGHT_PROXIMITY', 'DYNAMIC_PAINT', 'NODES'}


def weights_may_move(obj):
    """Whether an object's weights may change while nobody edits them."""
    return any(modifier.type in _WEIGHING for modifier in obj.modifiers)


def weights(mesh, evaluated, name):
    """float32 [n], one a vertex, 0 where it is not in the group. ValueError if the object has no such group."""
    group = evaluated.vertex_groups.get(name)
    if group is None:
        raise ValueError(f'"{evaluated.name}" has no vertex group "{name}": choose one of its own')
    index = group.index
    # Blender hands out weights only one by one.
    return np.array([next((entry.weight for entry in vertex.groups if entry.group == index), 0.0)
                     for vertex in mesh.vertices], np.float32)


def covered(mesh, evaluated, kind, name, group_weights):
    """bool [faces] of a part, as shell_options.PARTS names them; ValueError if that has no face.

    `group_weights` are weights() of the group where the part is a VERTEX_GROUP, and else None.
    """
    if kind == 'MATERIAL':
        marks = np.isin(_material_indices(mesh), _slots(evaluated, name))
    elif kind == 'VERTEX_GROUP':
        marks = _of_all_corners(mesh, group_weights[_corners(mesh)] >= _MARKED)
    else:
        marks = _attribute(mesh, evaluated.name, name)
    if not marks.any():
        what = {'MATERIAL': "material", 'VERTEX_GROUP': "vertex group", 'ATTRIBUTE': "attribute"}[kind]
        raise ValueError(f'No face of "{evaluated.name}" is marked by the {what} "{name}": mark some, or set Part to '
                         "Whole Mesh")
    return marks


def _slots(evaluated, name):
    """Numbers of the slots that hold a material of that name, or the slot whose number it is."""
    found = [index for index, slot in enumerate(evaluated.material_slots) if slot.material is not None and slot.name == name]
    if not found and name.isdigit() and int(name) < max(1, len(evaluated.material_slots)):
        found = [int(name)]
    if not found:
        raise ValueError(f'"{evaluated.name}" has no material "{name}": choose one of its own, or the number of a slot')
    return found


def _material_indices(mesh):
    indices = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("material_index", indices)
    return np.clip(indices, 0, max(0, len(mesh.materials) - 1))  # as Blender shows them


def _attribute(mesh, owner, name):
    attribute = mesh.attributes.get(name)
    if attribute is None:
        raise ValueError(f'"{owner}" has no attribute "{name}": choose one of its own')
    if attribute.data_type not in _VALUES or attribute.domain not in {'FACE', 'POINT', 'CORNER'}:
        raise ValueError(f'The attribute "{name}" of "{owner}" can mark no faces: choose one of faces, vertices or corners '
                         "whose values are true or false, or numbers")
    values = np.empty(len(attribute.data), bool if attribute.data_type == 'BOOLEAN' else
                      np.float32 if attribute.data_type == 'FLOAT' else np.int32)
    attribute.data.foreach_get(_VALUES[attribute.data_type], values)
    marks = values != 0 if attribute.data_type in _WHOLE else values >= _MARKED
    if attribute.domain == 'FACE':
        return marks
    return _of_all_corners(mesh, marks if attribute.domain == 'CORNER' else marks[_corners(mesh)])


def _corners(mesh):
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return corners


def _of_all_corners(mesh, marks):
    """bool [faces]: whether all corners of a face are marked."""
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    return np.logical_and.reduceat(marks, starts)
