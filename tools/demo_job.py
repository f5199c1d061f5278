"""Runs inside Blender's window for ./dev demo: every stage from tile to pictures, each timed. Writes OUT/demo.json."""

import json
import os
import sys
import time
import traceback
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "tools"), str(ROOT / "tests")]

import demo_pictures as pictures  # noqa: E402

OUT = Path(sys.argv[sys.argv.index("--out") + 1])
SIZE = 512
TILE, SURFACE, CUBE = "ChainTile", "Torus", "Cube"
TRAVERSALS = ("refined", "sdf", "gdm")


class Stages:
    """Seconds and peak resident memory of each stage."""

    def __init__(self):
        self.rows = []

    @contextmanager
    def __call__(self, name):
        Path("/proc/self/clear_refs").write_text("5")  # the peak starts again from what is resident now
        start = time.perf_counter()
        row = {"name": name, "note": ""}
        yield row
        row["seconds"] = time.perf_counter() - start
        status = Path("/proc/self/status").read_text()
        row["peak_mb"] = int(status.split("VmHWM:")[1].split()[0]) / 1024
        self.rows.append(row)


def bake(stage, native, chosen_source):
    """Sample, map file and raw GDM's numbers; returns (sample, path of the map)."""
    tile = bpy.data.objects[TILE]
    with stage("read the tile") as row:
        choice = chosen_source.choose(bpy.context, source='OBJECT', tile=tile)
        arrays = chosen_source.read(choice, bpy.context.evaluated_depsgraph_get())
        sample = native.Sample(arrays.positions, arrays.triangles, height=arrays.height, aspect=arrays.aspect)
        row["note"] = f"{sample.triangle_count} triangles, height {sample.height:.2f} tile widths"
    with stage("bake GDM") as row:
        gdm = native.bake_gdm(sample, resolution=(64, 64, 32), directions=(16, 32))
    row["note"] = f"64x64x32 nodes, 16x32 directions: {gdm.ray_count / row['seconds'] / 1e6:.1f} million rays/s"
    with stage("bake SDF") as row:
        sdf = native.bake_sdf(sample, resolution=(64, 64, 33))
        row["note"] = "64x64x33 nodes"
    with stage("bake facets") as row:
        facets = native.bake_facets(sample)
        row["note"] = f"{facets.texels.nbytes / 2**20:.2f} MB"
    with stage("compress") as row:
        tile_map = native.compress(gdm, sdf=sdf, facets=facets)
        voxels = tile_map.resolution[0]
        row["note"] = (f"{tile_map.terms} SVD terms by nodes, RMSE {tile_map.rmse * voxels:.2f} voxels, "
                       f"largest error {tile_map.max_error * voxels:.0f}")
    path = OUT / "chain.gdm.exr"
    with stage("save") as row:
        tile_map.save(path)
        row["note"] = f"{path.stat().st_size / 1e6:.2f} MB, lossless"
    return sample, path


def add_shell(stage, shells, path):
    """Put the map on the torus through the operator; returns the ShellInstance that is drawn."""
    surface = bpy.data.objects[SURFACE]
    tiles = surface["mesoshell_tiles"]
    with stage("add shell") as row:
        bpy.ops.mesoshell.add_shell(object=SURFACE, filepath=str(path), levels=1, thickness=surface["mesoshell_thickness"],
                                    tiles_u=tiles[0], tiles_v=tiles[1])
        instance, = shells.visible(bpy.context.evaluated_depsgraph_get())
        row["note"] = f"{instance.shell.prism_count} prisms, one level of Catmull-Clark, limit surface"
    return instance


def run():
    import mesoshell

    mesoshell.register()
    from mesoshell.core import native as finder
    from mesoshell.gpu import draw, offscreen
    from mesoshell.host import chosen_source, lights, shells

    native = finder.module()
    stage = Stages()
    sample, path = bake(stage, native, chosen_source)
    instance = add_shell(stage, shells, path)

    with stage("viewport (first frame)") as row:
        crop = pictures.set_view(bpy.data.objects["Camera"], SIZE)
    with stage("viewport (frame)") as row:
        bpy.ops.wm.redraw_timer(type='DRAW_WIN_SWAP', iterations=1)
        row["note"] = "the whole window"
    viewport = pictures.read_window(crop)
    clip_from_world = crop.clip_from_world
    clip_from_object = clip_from_world @ instance.world_from_object
    lit = lights.read(bpy.context.evaluated_depsgraph_get())

    drawn = {}
    for traversal in TRAVERSALS:
        traced = instance._replace(settings=instance.settings._replace(traversal=traversal))
        with stage(f"draw {traversal} (GLSL)"):
            color, depth = offscreen.picture([traced], clip_from_world, (SIZE, SIZE), lit)
        data, _ = offscreen.picture([traced], clip_from_world, (SIZE, SIZE), lit, output="texture")
        drawn[traversal] = {"color": color, "hit": depth < 1.0, "distance": data[..., 3]}

    rendered = {}
    for traversal in TRAVERSALS:
        record = draw.settings_record(traversal=traversal, base_color=instance.settings.base_color, lights=lit,
                                      world_from_object=instance.world_from_object)
        with stage(f"render {traversal} (C++)") as row:
            picture = native.render(instance.shell, instance.map, clip_from_object=clip_from_object, size=(SIZE, SIZE),
                                    traversal=traversal, settings=record.tobytes())
        fetched = picture["fetches"][picture["fetches"] > 0]
        row["note"] = f"{fetched.mean():.1f} fetches a ray"
        rendered[traversal] = {name: np.array(picture[name]) for name in ("color", "hit", "distance")}

    with stage("realize") as row:
        mesh = native.realize(instance.shell, sample)
        row["note"] = f"{len(mesh['triangles']) / 1e6:.2f} million triangles"
    with stage("trace realized (Embree)"):
        truth = native.trace(mesh["positions"], mesh["triangles"], clip_from_object=clip_from_object, size=(SIZE, SIZE))
    realized = {"hit": truth["hit"], "distance": truth["distance"],
                "color": pictures.shade(truth["normal"], truth["hit"], native.eye(clip_from_object), instance, lit)}

    files = {"viewport.png": viewport, "draw.png": drawn["refined"]["color"],
             "reference.png": rendered["refined"]["color"],
             "realized.png": realized["color"], "draw_gdm.png": drawn["gdm"]["color"]}
    for name, pixels in files.items():
        encode = name != "viewport.png"
        pictures.save_png(OUT / name, pictures.over_background(pixels) if encode else pixels, encode=encode)

    voxel = bpy.data.objects[SURFACE]["mesoshell_thickness"] / instance.map.height / instance.map.sdf.shape[2]
    solid = pictures.solid_distance(native, [bpy.data.objects[name] for name in (SURFACE, CUBE)], clip_from_world, SIZE)
    report = {
        "blender": bpy.app.version_string,
        "renderer": pictures.renderer(),
        "stages": stage.rows,
        "differences": [
            *(pictures.compare(f"draw {name}", drawn[name], f"reference {name}", rendered[name], voxel) for name in TRAVERSALS),
            *(pictures.compare(f"reference {name}", rendered[name], "realized", realized, voxel) for name in TRAVERSALS),
            pictures.compare_window("viewport", viewport, "draw refined", drawn["refined"], solid),
        ],
        "files": [str((OUT / name).relative_to(ROOT)) for name in ("chain.gdm.exr", *files)],
    }
    (OUT / "demo.json").write_text(json.dumps(report, indent=1))


def main():
    status = 1
    try:
        run()
        status = 0
    except BaseException:
        traceback.print_exc()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # Blender's own way out would ask whether to save


bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(main, first_interval=1.0)
