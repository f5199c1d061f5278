"""Renders docs/pictures/lizard.png: scales on a part of the animated lizard, at four of its frames, without a GPU. Run in Blender:

    blender --background blend_samples/lizard.blend --python tools/lizard_sheet.py -- --out docs/pictures/lizard.png

The module and the add-on are those of the source tree (./dev build). The render engine Mesoshell draws it, as F12 does.
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
os.environ.setdefault("MESOSHELL_NATIVE_PATH", str(ROOT / "build/stage"))
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "tools"), str(ROOT / "tests")]

FRAMES = (1, 13, 25, 37)
SIZE = (560, 310)
SAMPLES = 32
BACKGROUND = np.array([0.045, 0.047, 0.052])  # linear
SKIN = (0.20, 0.24, 0.12)
SCALES = (0.42, 0.33, 0.14)


def add_shell(folder, traversal):
    """Bakes the tile and puts it on the cage: where `Scales` is, as thick as `Thickness`, without folds."""
    path = str(Path(folder) / "scales.gdm.exr")
    bpy.ops.mesoshell.bake(tile="SquamaTile", filepath=path)
    lizard = bpy.data.objects["Lizard"]
    tiles = lizard["mesoshell_tiles"]
    bpy.ops.mesoshell.add_shell(
        object="Lizard", filepath=path, surface='CAGE', levels=2, thickness=lizard["mesoshell_thickness"], tiles_u=tiles[0],
        tiles_v=tiles[1], part='VERTEX_GROUP', part_name="Scales", thickness_group="Thickness", repair=True, traversal=traversal)
    lizard.mesoshell.base_color = SCALES
    skin = bpy.data.materials.new("Plain skin")
    skin.use_nodes = True
    skin.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*SKIN, 1.0)
    lizard.data.materials.clear()
    lizard.data.materials.append(skin)


def set_up(scene):
    """A picture without sky, in a file of linear floats."""
    render = scene.render
    render.engine, render.film_transparent = 'MESOSHELL', True
    (render.resolution_x, render.resolution_y), render.resolution_percentage = SIZE, 100
    render.image_settings.file_format, render.image_settings.color_depth = 'OPEN_EXR', '32'
    render.image_settings.color_mode = 'RGBA'
    scene.mesoshell_render.samples = SAMPLES


def picture(scene, frame, path):
    """One frame before the background, linear RGB [h, w, 3], the bottom row first."""
    scene.frame_set(frame)
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.empty(SIZE[0] * SIZE[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    pixels = pixels.reshape(SIZE[1], SIZE[0], 4)
    return pixels[..., :3] + (1.0 - pixels[..., 3:]) * BACKGROUND


def main(arguments):
    parser = argparse.ArgumentParser(prog="lizard_sheet.py")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--traversal", default="sdf")
    options = parser.parse_args(arguments)
    import mesoshell

    mesoshell.register()
    import demo_pictures

    scene = bpy.context.scene
    with tempfile.TemporaryDirectory() as folder:
        add_shell(folder, options.traversal)
        set_up(scene)
        frames = [picture(scene, frame, Path(folder) / f"{frame}.exr") for frame in FRAMES]
    sheet = np.concatenate([np.concatenate(frames[2:], axis=1), np.concatenate(frames[:2], axis=1)], axis=0)
    demo_pictures.save_png(options.out.resolve(), sheet, encode=True)


main(sys.argv[sys.argv.index("--") + 1:])
