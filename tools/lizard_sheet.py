"""Renders docs/pictures/lizard.png: scales on a part of the animated lizard, at four of its frames, without a GPU. Run in Blender:

    blender --background blend_samples/lizard.blend --python tools/lizard_sheet.py -- --out docs/pictures/lizard.png

The module and the add-on are those of the source tree (./dev build). The shell is drawn by the reference renderer; the plain
base, which is Blender's own evaluated mesh, by Embree with a Lambert shading.
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
SIZE = (1120, 620)  # of which each 2 x 2 pixels become one
BACKGROUND = np.array([0.045, 0.047, 0.052])  # linear
SKIN = np.array([0.20, 0.24, 0.12])


def add_shell(folder, traversal):
    """Bakes the tile and puts it on the cage: where `Scales` is, as thick as `Thickness`, without folds."""
    path = str(Path(folder) / "scales.gdm.exr")
    bpy.ops.mesoshell.bake(tile="SquamaTile", filepath=path)
    lizard = bpy.data.objects["Lizard"]
    tiles = lizard["mesoshell_tiles"]
    bpy.ops.mesoshell.add_shell(
        object="Lizard", filepath=path, surface='CAGE', levels=2, thickness=lizard["mesoshell_thickness"], tiles_u=tiles[0],
        tiles_v=tiles[1], part='VERTEX_GROUP', part_name="Scales", thickness_group="Thickness", repair=True, traversal=traversal)
    lizard.mesoshell.base_color = (0.42, 0.33, 0.14)
    return lizard


def base_picture(native, obj, depsgraph, clip_from_world, lit):
    """Color [h, w, 3] and distance [h, w] of the evaluated mesh."""
    mesh = obj.evaluated_get(depsgraph).to_mesh()
    mesh.calc_loop_triangles()
    positions = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", positions)
    normals = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("normal", normals)
    triangles = np.empty(len(mesh.loop_triangles) * 3, np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    obj.evaluated_get(depsgraph).to_mesh_clear()
    world = np.array(obj.matrix_world)
    points = positions.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]
    seen = native.trace(points, triangles.reshape(-1, 3), clip_from_object=clip_from_world, size=SIZE)
    cosine = np.maximum(seen["normal"] @ lit.toward_sun, 0.0)[..., None]
    return SKIN * (lit.ambient + lit.sun_color * cosine), np.array(seen["distance"])


def picture(native, shells, draw, lights):
    """The current frame, linear RGB [h, w, 3], the bottom row first."""
    scene = bpy.context.scene
    depsgraph = bpy.context.evaluated_depsgraph_get()
    camera = scene.camera
    view = np.linalg.inv(np.array(camera.evaluated_get(depsgraph).matrix_world))
    clip_from_world = np.array(camera.calc_matrix_camera(depsgraph, x=SIZE[0], y=SIZE[1])) @ view
    lit = lights.read(depsgraph)
    instance, = shells.visible(depsgraph)
    record = draw.settings_record(traversal=instance.settings.traversal, base_color=instance.settings.base_color, lights=lit,
                                  world_from_object=instance.world_from_object)
    seen = native.render(instance.shell, instance.map, clip_from_object=clip_from_world @ instance.world_from_object, size=SIZE,
                         settings=record.tobytes())
    base, base_distance = base_picture(native, bpy.data.objects["Lizard"], depsgraph, clip_from_world, lit)
    color = np.where(np.isfinite(base_distance)[..., None], base, BACKGROUND)
    front = (seen["hit"] == 1) & (seen["distance"] < base_distance)
    return np.where(front[..., None], seen["color"][..., :3], color)


def main(arguments):
    parser = argparse.ArgumentParser(prog="lizard_sheet.py")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--traversal", default="sdf")
    options = parser.parse_args(arguments)
    import mesoshell

    mesoshell.register()
    import demo_pictures
    from mesoshell.core import native as finder
    from mesoshell.gpu import draw
    from mesoshell.host import lights, shells

    native = finder.module()
    with tempfile.TemporaryDirectory() as folder:
        add_shell(folder, options.traversal)
        frames = []
        for frame in FRAMES:
            bpy.context.scene.frame_set(frame)
            frames.append(picture(native, shells, draw, lights))
    frames = [frame.reshape(SIZE[1] // 2, 2, SIZE[0] // 2, 2, 3).mean(axis=(1, 3)) for frame in frames]
    sheet = np.concatenate([np.concatenate(frames[2:], axis=1), np.concatenate(frames[:2], axis=1)], axis=0)
    demo_pictures.save_png(options.out.resolve(), sheet, encode=True)


main(sys.argv[sys.argv.index("--") + 1:])
