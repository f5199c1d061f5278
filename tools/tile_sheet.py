"""Renders docs/pictures/tiles.png: the six tiles of tiles.blend, each repeated, by Cycles on the CPU. Run in Blender:

    blender --background blend_samples/tiles.blend --python tools/tile_sheet.py -- --out docs/pictures/tiles.png

A picture of 256 colors, so that it stays small.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).resolve().parent))
from png import write_indexed_png  # noqa: E402

SIZE, SAMPLES, COLUMNS = 264, 64, 3
NAMES = ["Weave", "Grid", "Chain", "Squama", "Bark", "Fur"]
REPEATS = 2.2  # periods across a picture
# From the middle of the picture to the camera; grazing enough to show what lies beneath.
TOWARD = Vector((0.0, -0.62, 1.0)).normalized()


def render(obj, folder):
    """A picture of the object's tile and its copies, sRGB uint8 [SIZE, SIZE, 3]; the top row first."""
    scene = bpy.context.scene
    period, height = obj["mesoshell_period"], obj["mesoshell_height"]
    copies = []
    for i in range(-3, 5):
        for j in range(-3, 6):
            copy = obj.copy()
            copy.location = i * period[0], j * period[1], 0.0
            scene.collection.objects.link(copy)
            copies.append(copy)
    center = Vector((period[0], 1.2 * period[1], height / 2))
    camera = scene.camera
    camera.data.lens = 60.0
    camera.location = center + TOWARD * REPEATS * camera.data.lens / camera.data.sensor_width
    camera.rotation_euler = TOWARD.to_track_quat("Z", "Y").to_euler()
    scene.render.filepath = str(folder / f"{obj.name}.png")
    bpy.ops.render.render(write_still=True)
    for copy in copies:
        bpy.data.objects.remove(copy)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(SIZE * SIZE * 4, np.float32)
    image.pixels.foreach_get(pixels)
    return np.round(pixels.reshape(SIZE, SIZE, 4)[::-1, :, :3] * 255).astype(np.uint8)


def palette_of(pixels, count=256, rounds=12):
    """Colors [count, 3] that serve the pixels [n, 3] well (k-means), and which of them serves each pixel [n]."""
    random = np.random.default_rng(1)
    sample = pixels[random.choice(len(pixels), 20_000)].astype(np.float32)
    palette = sample[random.choice(len(sample), count, replace=False)]

    def nearest(points):
        return np.concatenate([((palette**2).sum(1) - 2 * part @ palette.T).argmin(1) for part in
                               np.array_split(points.astype(np.float32), 1 + len(points) // 50_000)])

    for _ in range(rounds):
        own = nearest(sample)
        used = np.bincount(own, minlength=count)
        sums = np.stack([np.bincount(own, channel, count) for channel in sample.T], -1)
        palette = np.where(used[:, None] > 0, sums / np.maximum(used, 1)[:, None], palette).astype(np.float32)
    return np.round(palette).astype(np.uint8), nearest(pixels).astype(np.uint8)


def main(arguments):
    parser = argparse.ArgumentParser(prog="tile_sheet.py")
    parser.add_argument("--out", type=Path, required=True, help="the PNG to write")
    out = parser.parse_args(arguments).out
    scene = bpy.context.scene
    scene.render.engine = 'CYCLES'
    scene.cycles.samples, scene.cycles.use_denoising = SAMPLES, False
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    tiles = [scene.objects[name] for name in NAMES]
    for obj in tiles:
        scene.collection.objects.unlink(obj)
    with tempfile.TemporaryDirectory() as folder:
        pictures = [render(obj, Path(folder)) for obj in tiles]
    rows = [np.concatenate(pictures[first:first + COLUMNS], axis=1) for first in range(0, len(pictures), COLUMNS)]
    picture = np.concatenate(rows)
    palette, index = palette_of(picture.reshape(-1, 3))
    write_indexed_png(out, palette, index.reshape(picture.shape[:2]))


main(sys.argv[sys.argv.index("--") + 1:])
