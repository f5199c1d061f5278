"""The lamps and the world of a scene as a render takes them: linear colors, world space."""

import numpy as np

from . import images, versions


def read(depsgraph):
    """The list of dicts that the native render_scene takes as `lights`: every visible lamp, copies by instancing too."""
    lights = []
    for instance in depsgraph.object_instances:
        obj = instance.object
        if obj.type == 'LIGHT' and instance.show_self:
            matrix = np.array(instance.matrix_world, np.float64)
            if np.linalg.det(matrix[:3, :3]) != 0.0:  # one scaled to nothing shines nowhere
                lights.append(_light(obj.data, matrix))
    return lights


def world(depsgraph, notices):
    """The dict that the native render_scene takes as `world`, or None for black; `notices` gets what cannot be followed.

    A Background node counts, with a color or an environment texture; other worlds have their viewport color.
    """
    data = depsgraph.scene.world
    if data is None:
        return None
    tree = versions.world_nodes(data)
    if tree is None:
        return {"color": np.array(data.color, np.float64)}
    output = tree.get_output_node('ALL')
    if output is None or not output.inputs["Surface"].is_linked:
        return None
    node = output.inputs["Surface"].links[0].from_node
    if node.type != 'BACKGROUND' or node.inputs["Strength"].is_linked:
        return _plain(data, f'the node "{node.name}"', notices)
    strength = node.inputs["Strength"].default_value
    if not node.inputs["Color"].is_linked:
        return {"color": np.maximum(np.array(node.inputs["Color"].default_value, np.float64)[:3] * strength, 0.0)}
    source = node.inputs["Color"].links[0].from_node
    if source.type != 'TEX_ENVIRONMENT' or source.image is None or images.is_empty(source.image):
        return _plain(data, f'the node "{source.name}"', notices)
    if source.projection != 'EQUIRECTANGULAR':
        return _plain(data, f'the projection of the node "{source.name}"', notices)
    if source.inputs["Vector"].is_linked:
        notices.append(f'World "{data.name}": what is linked to the vector of "{source.name}" can not be followed, so that '
                       "its image is not turned; unlink it")
    return {"image": images.linear_pixels(source.image) * np.float32(max(strength, 0.0))}


def _plain(data, what, notices):
    notices.append(f'World "{data.name}": {what} can not be followed, so that its viewport color is the sky; link a color '
                   "or an equirectangular Environment Texture to a Background node")
    return {"color": np.array(data.color, np.float64)}


def _light(data, matrix):
    """A lamp at `matrix`, whose -z it shines along."""
    power = data.energy * versions.light_exposure(data) * versions.light_gain(data) * data.diffuse_factor
    color = versions.light_color(data) * power
    light = {"type": data.type, "position": matrix[:3, 3], "direction": -matrix[:3, 2], "color": np.maximum(color, 0.0),
             "cast_shadow": data.use_shadow}
    if data.type == 'SUN':
        light["angle"] = min(data.angle, versions.WIDEST_SUN)
    elif data.type == 'AREA':
        axes = np.ascontiguousarray(matrix[:3, :2].T)
        sides = data.size, data.size_y if data.shape in {'RECTANGLE', 'ELLIPSE'} else data.size
        light |= {"shape": data.shape, "size": np.linalg.norm(axes, axis=1) * sides, "axes": axes}
    else:
        light["radius"] = data.shadow_soft_size
        if data.type == 'SPOT':
            light |= {"spot_size": data.spot_size, "spot_blend": data.spot_blend, "spot_cosine": versions.SPOTS_HAVE_COSINE}
    return light
