"""The sun and the sky of a scene, as the shader wants them: linear, in world space."""

from typing import NamedTuple

import numpy as np

from ..core import shader_source
from . import versions


class Lights(NamedTuple):
    toward_sun: np.ndarray  # float64 [3], world space, unit length
    sun_color: np.ndarray  # float64 [3], the radiance of a white diffuse surface that faces the sun
    ambient: np.ndarray  # float64 [3], the radiance of the sky


def read(depsgraph):
    """The Lights of the depsgraph's scene: its first visible sun, by name, and its world's color.

    What the scene lacks is as the shader interface has it, whatever the view.
    """
    defaults = shader_source.shell_interface().defaults()
    toward_sun = np.array(defaults["light_world"][:3], np.float64)
    sun_color = np.array(defaults["light_color"][:3], np.float64)
    sun = _first_sun(depsgraph)
    if sun is not None:
        toward_sun = np.array(sun.matrix_world, np.float64)[:3, 2]
        # A sun's strength is an irradiance; a white diffuse surface returns it over pi (as Cycles does, measured).
        light = sun.data
        sun_color = versions.light_color(light) * (light.energy * versions.light_exposure(light) / np.pi)
    length = np.linalg.norm(toward_sun)
    toward_sun = toward_sun / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    return Lights(toward_sun, sun_color, _ambient(depsgraph.scene.world, defaults))


def _first_sun(depsgraph):
    def lit(obj):
        if depsgraph.mode == 'RENDER':
            return not obj.hide_render
        return obj.visible_get(view_layer=depsgraph.view_layer)

    suns = [obj for obj in depsgraph.view_layer.objects
            if obj.type == 'LIGHT' and obj.data.type == 'SUN' and lit(obj)]
    return min(suns, key=lambda obj: obj.name).evaluated_get(depsgraph) if suns else None


def _ambient(world, defaults):
    """The Background node's color times strength; a world of textures counts as its viewport color."""
    if world is None:
        return np.array(defaults["ambient_color"][:3], np.float64)
    tree = versions.world_nodes(world)
    output = tree.get_output_node('ALL') if tree is not None else None
    if output is None or not output.inputs["Surface"].is_linked:
        return np.array(world.color, np.float64) if tree is None else np.zeros(3)
    node = output.inputs["Surface"].links[0].from_node
    if node.type != 'BACKGROUND' or node.inputs["Color"].is_linked or node.inputs["Strength"].is_linked:
        return np.array(world.color, np.float64)
    return np.array(node.inputs["Color"].default_value, np.float64)[:3] * node.inputs["Strength"].default_value
