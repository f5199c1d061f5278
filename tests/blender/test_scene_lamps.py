"""render_scene's lamps beside Cycles': a white floor under one lamp each."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Euler

PIXELS = 9
WIDTH = 4.0
POWER = 100.0
TILT = Euler((0.4, 0.2, 0.3))
AXES = np.array(TILT.to_matrix()).T  # rows: where the lamp's own axes point

LAMPS = {
    "sun": (dict(type='SUN', energy=3.0, angle=0.0), dict(color=(3.0, 3.0, 3.0))),
    "wide sun": (dict(type='SUN', energy=3.0, angle=0.8), dict(color=(3.0, 3.0, 3.0), angle=0.8)),
    "point": (dict(type='POINT', energy=POWER, shadow_soft_size=0.1), dict(radius=0.1)),
    "spot": (dict(type='SPOT', energy=POWER, shadow_soft_size=0.0, spot_size=1.6, spot_blend=0.4),
             dict(spot_size=1.6, spot_blend=0.4)),
    "square": (dict(type='AREA', energy=POWER, shape='SQUARE', size=0.5), dict(size=(0.5, 0.5))),
    "rectangle": (dict(type='AREA', energy=POWER, shape='RECTANGLE', size=1.0, size_y=0.4), dict(size=(1.0, 0.4))),
    "ellipse": (dict(type='AREA', energy=POWER, shape='ELLIPSE', size=1.0, size_y=0.4), dict(size=(1.0, 0.4))),
    "disk": (dict(type='AREA', energy=POWER, shape='DISK', size=0.5), dict(size=(0.5, 0.5))),
}


def cycles_picture(folder, attributes):
    """Cycles' picture of the floor, float [h, w], direct light alone; a scene of its own that is gone afterwards."""
    scene = bpy.data.scenes.new("Floor")
    try:
        scene.render.engine = 'CYCLES'
        scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = 256, False, False
        scene.cycles.max_bounces = 0
        scene.render.resolution_x = scene.render.resolution_y = PIXELS
        scene.render.image_settings.file_format, scene.render.image_settings.color_depth = 'OPEN_EXR', '32'
        scene.render.filepath = str(folder / "floor.exr")
        white = bpy.data.materials.new("White")
        white.use_nodes = True
        nodes = white.node_tree.nodes
        nodes.clear()
        diffuse, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
        diffuse.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        white.node_tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
        mesh = bpy.data.meshes.new("Floor")
        mesh.from_pydata([(-50, -50, 0), (50, -50, 0), (50, 50, 0), (-50, 50, 0)], [], [(0, 1, 2, 3)])
        mesh.materials.append(white)
        camera = bpy.data.cameras.new("Above")
        camera.type, camera.ortho_scale = 'ORTHO', WIDTH
        kind = attributes["type"]
        light = bpy.data.lights.new("Lamp", kind)
        for name, value in attributes.items():
            if name != "type":
                setattr(light, name, value)
        lamp = bpy.data.objects.new("Lamp", light)
        lamp.location, lamp.rotation_euler, lamp.visible_camera = (0.0, 0.0, 2.0), TILT, False
        above = bpy.data.objects.new("Above", camera)
        above.location = (0.0, 0.0, 10.0)
        for obj in (bpy.data.objects.new("Floor", mesh), lamp, above):
            scene.collection.objects.link(obj)
        scene.camera = above
        bpy.ops.render.render(write_still=True, scene=scene.name)
        image = bpy.data.images.load(scene.render.filepath)
        pixels = np.empty(PIXELS * PIXELS * 4, np.float32)
        image.pixels.foreach_get(pixels)
        return pixels.reshape(PIXELS, PIXELS, 4)[..., 0]
    finally:
        bpy.data.scenes.remove(scene)


def our_picture(native, lamp):
    view = np.diag([2 / WIDTH, 2 / WIDTH, -0.1, 1.0])
    floor = dict(positions=[(-50, -50, 0), (50, -50, 0), (50, 50, 0), (-50, 50, 0)], triangles=[(0, 1, 2), (0, 2, 3)],
                 base_color=(1, 1, 1))
    given = dict(position=(0, 0, 2), direction=-AXES[2], color=(POWER,) * 3, axes=AXES[:2])
    return native.render_scene(clip_from_world=view, size=(PIXELS, PIXELS), meshes=[floor], lights=[{**given, **lamp}],
                               samples=1024)["color"][..., 0]


@pytest.mark.parametrize("name", LAMPS)
def test_lamps_are_cycles(fresh, part, native, tmp_path, name):
    """With what the add-on knows of how Blender's versions differ."""
    attributes, ours = LAMPS[name]
    expected = cycles_picture(tmp_path, attributes)
    lamp = dict(ours, type=attributes["type"])
    if "shape" in attributes:
        lamp["shape"] = attributes["shape"]
    versions = part("host.versions")
    gain = versions.light_gain(SimpleNamespace(type=lamp["type"], angle=lamp.get("angle", 0.0)))
    lamp["color"] = np.multiply(gain, lamp.get("color", (POWER,) * 3))
    picture = our_picture(native, dict(lamp, spot_cosine=versions.SPOTS_HAVE_COSINE))
    assert expected.max() > 0.1
    assert picture.sum() == pytest.approx(expected.sum(), rel=0.01)
    np.testing.assert_allclose(picture, expected, atol=0.02 * expected.max())
