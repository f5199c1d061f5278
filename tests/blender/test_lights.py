"""The sun and the sky as the shader gets them."""

import bpy
import numpy as np
import pytest
from mathutils import Euler, Vector


def read(part):
    bpy.context.view_layer.update()
    return part("host.lights").read(bpy.context.evaluated_depsgraph_get())


def make_sun(name, energy, rotation=(0.0, 0.0, 0.0), color=(1.0, 1.0, 1.0)):
    data = bpy.data.lights.new(name, 'SUN')
    data.energy, data.color = energy, color
    obj = bpy.data.objects.new(name, data)
    obj.rotation_euler = rotation
    bpy.context.scene.collection.objects.link(obj)
    return obj


def test_a_sun_shines_down_its_own_axis(part, fresh):
    sun = make_sun("A sun", np.pi, (0.5, 0.2, 1.0), (1.0, 0.5, 0.25))
    sun.scale = (3.0, 3.0, 3.0)
    lights = read(part)
    expected = Euler((0.5, 0.2, 1.0)).to_matrix() @ Vector((0.0, 0.0, 1.0))
    np.testing.assert_allclose(lights.toward_sun, expected, atol=1e-6)
    np.testing.assert_allclose(lights.sun_color, [1.0, 0.5, 0.25], rtol=1e-6)


def test_the_first_visible_sun_counts(part, fresh):
    first, second = make_sun("A sun", 1.0), make_sun("B sun", 2.0)
    assert read(part).sun_color[0] == pytest.approx(1.0 / np.pi)
    first.hide_viewport = True
    assert read(part).sun_color[0] == pytest.approx(2.0 / np.pi)
    second.hide_set(True)
    assert read(part).sun_color[0] > 1.0, "without a sun, the default one"
    assert np.linalg.norm(read(part).toward_sun) == pytest.approx(1.0)


def test_ambient_is_the_worlds_background(part, fresh):
    before = fresh.world
    world = bpy.data.worlds.new("Test world")
    fresh.world = world
    try:
        if bpy.app.version < (5, 0, 0):
            world.color = (0.1, 0.2, 0.3)
            np.testing.assert_allclose(read(part).ambient, [0.1, 0.2, 0.3], rtol=1e-6)
            world.use_nodes = True
        nodes = world.node_tree.nodes
        nodes.clear()
        background, output = nodes.new("ShaderNodeBackground"), nodes.new("ShaderNodeOutputWorld")
        background.inputs["Color"].default_value = (0.5, 0.25, 0.125, 1.0)
        background.inputs["Strength"].default_value = 2.0
        world.node_tree.links.new(background.outputs[0], output.inputs["Surface"])
        np.testing.assert_allclose(read(part).ambient, [1.0, 0.5, 0.25], rtol=1e-6)
        world.node_tree.links.clear()
        np.testing.assert_allclose(read(part).ambient, 0.0)
        fresh.world = None
        assert (read(part).ambient > 0.0).all()
    finally:
        fresh.world = before
        bpy.data.worlds.remove(world)
