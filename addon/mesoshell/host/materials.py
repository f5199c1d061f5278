"""What a material says of its surface: constants, and where its base color comes from.

Followed are a Principled BSDF (or a plain Diffuse or Glossy one) at the material's output, and into its color an image
texture, a color attribute, an Attribute node or an RGB node. What a bake cannot follow becomes a notice, and the socket's own
value is taken.
"""

from typing import NamedTuple

import numpy as np

from . import images, versions

_DEFAULT_COLOR, _DEFAULT_ROUGHNESS = (0.8, 0.8, 0.8), 0.5


class Surface(NamedTuple):
    color: tuple = _DEFAULT_COLOR  # linear RGB
    roughness: float = _DEFAULT_ROUGHNESS
    metallic: float = 0.0
    image: object = None  # bpy.types.Image that is the base color
    uv_map: str = ""  # the UV map that the image is on; empty: the one that renders
    # The attribute that is the base color; empty: the active one. None: no attribute is asked for by name.
    attribute: str = None
    follows: bool = False  # whether the base color is linked to something (image or attribute)


def read(material, notices):
    """The Surface of a material (None: the default one); what it cannot follow is appended to `notices` as sentences."""
    if material is None:
        return Surface()
    tree = versions.material_nodes(material)
    plain = Surface(tuple(material.diffuse_color)[:3], material.roughness, material.metallic)
    if tree is None:
        return plain
    shader = _shader(tree)
    if shader is None:
        notices.append(f'Material "{material.name}" ends in no Principled BSDF: its viewport color is baked')
        return plain
    unknown = []
    color = shader.inputs.get("Base Color") or shader.inputs.get("Color")
    surface = Surface(
        tuple(color.default_value)[:3],
        _number(shader, "Roughness", _DEFAULT_ROUGHNESS, unknown),
        _number(shader, "Metallic", 1.0 if shader.type == 'BSDF_GLOSSY' else 0.0, unknown))
    surface = _follow(surface, _source(color), unknown)
    if unknown:
        notices.append(f'Material "{material.name}": {" and ".join(unknown)} can not be followed, so that plain values are '
                       "baked; link an image texture or a color attribute to Base Color")
    return surface


def table_entry(surface):
    """The dict that the native module takes for a Surface."""
    image = None if surface.image is None else images.linear_pixels(surface.image)
    return {"color": tuple(float(c) for c in surface.color), "roughness": float(surface.roughness),
            "metallic": float(surface.metallic), "image": image}


def _shader(tree):
    output = tree.get_output_node('ALL')
    if output is None:
        return None
    node = _source(output.inputs["Surface"])
    return node if node is not None and node.type in {'BSDF_PRINCIPLED', 'BSDF_DIFFUSE', 'BSDF_GLOSSY'} else None


def _source(socket):
    """The node that feeds a socket, past reroutes; None if none does."""
    while socket.is_linked:
        node = socket.links[0].from_node
        if node.type != 'REROUTE':
            return node
        socket = node.inputs[0]
    return None


def _number(shader, name, default, unknown):
    socket = shader.inputs.get(name)
    if socket is None:
        return default
    if socket.is_linked:
        unknown.append(f"what is linked to {name}")
    return socket.default_value


def _follow(surface, node, unknown):
    """The Surface with its base color from `node`, if that is one of the nodes that can be baked."""
    if node is None:
        return surface
    if node.type == 'RGB':
        return surface._replace(color=tuple(node.outputs[0].default_value)[:3])
    if node.type == 'VERTEX_COLOR':
        return surface._replace(attribute=node.layer_name, follows=True)
    if node.type == 'ATTRIBUTE' and getattr(node, "attribute_type", 'GEOMETRY') == 'GEOMETRY':
        return surface._replace(attribute=node.attribute_name, follows=True)
    if node.type == 'TEX_IMAGE' and node.image is not None:
        vector = _source(node.inputs["Vector"])
        if vector is not None and vector.type not in {'UVMAP', 'TEX_COORD'}:
            unknown.append(f'the node "{vector.name}" between UVs and image')
        uv_map = vector.uv_map if vector is not None and vector.type == 'UVMAP' else ""
        if images.is_empty(node.image):
            unknown.append(f'the image "{node.image.name}", which has no pixels,')
            return surface
        return surface._replace(image=node.image, uv_map=uv_map, follows=True)
    unknown.append(f'the node "{node.name}"')
    return surface
