"""Geometry Nodes that make a tile of copies: of a skin and of templates, placed by attributes of points. Blender 3.4 to 5.2.

The mesh under the modifier holds the skin's faces and, as loose vertices, the roots. What a root's attributes say goes into an
Instance on Points node; the skin goes around it.
"""

import bpy
import numpy as np

from scene_parts import COLORS

# Attributes of the roots.
IS_ROOT, TURN, SCALE, VARIANT, TINT = "is_root", "turn", "scale", "variant", "tint"
SHADE = "shade"  # of a template's vertices: what their copies' tint is multiplied by
COLUMN = 200.0  # between nodes, in the editor


def set_attribute(mesh, name, kind, values):
    """A vertex attribute; values [n] or [n, 3]."""
    values = np.asarray(values)
    attribute = mesh.attributes.new(name, kind, 'POINT')
    dtype = {'BOOLEAN': bool, 'INT': np.int32}.get(kind, np.float32)
    attribute.data.foreach_set("vector" if kind == 'FLOAT_VECTOR' else "value", values.astype(dtype).ravel())


def set_roots(mesh, skin_vertices, turns, scales, variants, tints=None):
    """Marks the mesh's vertices after the first `skin_vertices` as roots and says how copies stand on them."""
    def padded(values):
        values = np.asarray(values)
        return np.concatenate([np.zeros((skin_vertices, *values.shape[1:]), values.dtype), values])

    set_attribute(mesh, IS_ROOT, 'BOOLEAN', padded(np.ones(len(turns), bool)))
    set_attribute(mesh, TURN, 'FLOAT_VECTOR', padded(np.outer(turns, (0.0, 0.0, 1.0))))
    set_attribute(mesh, SCALE, 'FLOAT', padded(scales))
    set_attribute(mesh, VARIANT, 'INT', padded(variants))
    if tints is not None:
        set_attribute(mesh, TINT, 'FLOAT_VECTOR', padded(tints))


class Tree:
    """A node group with one geometry in and one out, put together from left to right."""

    def __init__(self, name):
        self.group = bpy.data.node_groups.new(name, "GeometryNodeTree")
        if hasattr(self.group, "interface"):  # since 4.0
            for direction in ("INPUT", "OUTPUT"):
                self.group.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
        else:
            self.group.inputs.new("NodeSocketGeometry", "Geometry")
            self.group.outputs.new("NodeSocketGeometry", "Geometry")

    def node(self, kind, column, row=0, **settings):
        node = self.group.nodes.new(kind)
        node.location = column * COLUMN, -row * COLUMN
        for name, value in settings.items():
            setattr(node, name, value)
        return node

    def link(self, output, target):
        self.group.links.new(output, target)

    def attribute(self, name, kind, column, row):
        """The output that gives the attribute of that name and kind."""
        node = self.node("GeometryNodeInputNamedAttribute", column, row, data_type=kind)
        node.inputs["Name"].default_value = name
        return socket_of_kind(node.outputs, kind)


def socket_of_kind(sockets, kind):
    """Of sockets the one for that kind of attribute: up to 3.x a node has one for each kind, most of them hidden."""
    wanted = {'FLOAT': 'VALUE', 'FLOAT_VECTOR': 'VECTOR', 'FLOAT_COLOR': 'RGBA'}.get(kind, kind)
    return next(socket for socket in sockets if socket.type == wanted and socket.name in ("Attribute", "Value"))


def copies_on_roots(name, templates, tinted):
    """A node group: the skin, and on every root a copy of one of the objects in the collection `templates`.

    tinted: the copies become one mesh, colored by TINT times SHADE; otherwise they stay instances.
    """
    tree = Tree(name)
    source, result = tree.node("NodeGroupInput", 0), tree.node("NodeGroupOutput", 8)
    parted = tree.node("GeometryNodeSeparateGeometry", 2, domain='POINT')
    tree.link(source.outputs[0], parted.inputs["Geometry"])
    tree.link(tree.attribute(IS_ROOT, 'BOOLEAN', 1, 1), parted.inputs["Selection"])

    objects = tree.node("GeometryNodeCollectionInfo", 2, 1)
    objects.inputs["Collection"].default_value = templates
    objects.inputs["Separate Children"].default_value = True
    objects.inputs["Reset Children"].default_value = True
    copies = tree.node("GeometryNodeInstanceOnPoints", 3)
    tree.link(parted.outputs["Selection"], copies.inputs["Points"])
    tree.link(objects.outputs[0], copies.inputs["Instance"])
    copies.inputs["Pick Instance"].default_value = True
    tree.link(tree.attribute(VARIANT, 'INT', 2, 2), copies.inputs["Instance Index"])
    tree.link(tree.attribute(TURN, 'FLOAT_VECTOR', 2, 3), copies.inputs["Rotation"])
    tree.link(tree.attribute(SCALE, 'FLOAT', 2, 4), copies.inputs["Scale"])

    placed = copies.outputs["Instances"]
    if tinted:
        realized = tree.node("GeometryNodeRealizeInstances", 4)
        tree.link(placed, realized.inputs["Geometry"])
        color = tree.node("ShaderNodeVectorMath", 5, 1, operation='MULTIPLY')
        tree.link(tree.attribute(TINT, 'FLOAT_VECTOR', 4, 1), color.inputs[0])
        tree.link(tree.attribute(SHADE, 'FLOAT_VECTOR', 4, 2), color.inputs[1])
        stored = tree.node("GeometryNodeStoreNamedAttribute", 6, data_type='FLOAT_COLOR', domain='POINT')
        tree.link(realized.outputs["Geometry"], stored.inputs["Geometry"])
        stored.inputs["Name"].default_value = COLORS
        tree.link(color.outputs["Vector"], socket_of_kind(stored.inputs, 'FLOAT_COLOR'))
        placed = stored.outputs["Geometry"]

    joined = tree.node("GeometryNodeJoinGeometry", 7)
    tree.link(placed, joined.inputs["Geometry"])
    tree.link(parted.outputs["Inverted"], joined.inputs["Geometry"])
    tree.link(joined.outputs["Geometry"], result.inputs[0])
    return tree.group
