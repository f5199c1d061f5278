# runs in Blender, whose bundled add-on Tissue repeats a component over the faces of a base
"""What realizing a tile costs, beside Tissue on the same component and base in one run: seconds, memory, and open edges.

The base is a torus of quads with one tile a quad, which is what Tissue can do. Its component is the tile as it is modeled,
reaching over the sides of its box, or ("trimmed") cut there, with vertices at the same places on opposite sides; Tissue
merges what meets. Times are those of the operators, from objects to an object; memory is how far the process's peak rises
above what it held. Shared machines are noisy: rounds are interleaved and every figure is the least of its rounds. Without
Tissue, which 4.2 and later do not bundle, only our own are measured.
"""

import gc
import json
import os
import sys
import tempfile
import time
from pathlib import Path

import addon_utils
import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "blend_samples")]

import mesoshell  # noqa: E402
import tiles  # noqa: E402
from mesoshell.core import clipping  # noqa: E402
from mesoshell.core import native as module  # noqa: E402

native = module.module()
OUT = Path(sys.argv[sys.argv.index("--out") + 1])
ROUNDS = 2
THICKNESS = 0.15
# Tile, its detail, quads around the axis and around the tube.
CASES = (("weave", 0.33, 20, 10), ("weave", 0.33, 40, 20), ("chain", 0.33, 20, 10), ("chain", 0.33, 40, 20))


def torus(around, across):
    """An object of quads, u along the axis, one tile a quad."""
    j, i = np.mgrid[0:across, 0:around]
    a, b = 2.0 * np.pi * i / around, 2.0 * np.pi * j / across
    out = 1.0 + 0.4 * np.cos(b)
    positions = np.stack([out * np.cos(a), out * np.sin(a), 0.4 * np.sin(b)], -1).reshape(-1, 3)
    steps = ((0, 0), (1, 0), (1, 1), (0, 1))
    corners = np.stack([(j + dj) % across * around + (i + di) % around for di, dj in steps], -1).reshape(-1, 4)
    uvs = np.stack([np.stack([i + di, j + dj], -1) for di, dj in steps], 2).reshape(-1, 2)
    obj = add_object("Base", positions, corners)
    obj.data.uv_layers.new(name="UVMap").data.foreach_set("uv", uvs.astype(np.float32).ravel())
    return obj


def add_object(name, positions, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(positions.tolist(), [], faces.tolist())
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(obj)
    return obj


def add_tile(tile):
    obj = add_object("Tile", tile.positions, tile.triangles)
    settings = obj.mesoshell_tile
    settings.is_tile, settings.period_u, settings.period_v, settings.height = True, 1.0, tile.aspect, tile.height
    return obj


def add_component(tile):
    """The tile with x and y from 0 to 1, which Tissue takes for a quad."""
    return add_object("Component", tile.positions / [1.0, tile.aspect, 1.0], tile.triangles)


def add_trimmed(tile):
    """The same of what lies in the tile's box, of all copies around it."""
    shifts = [(x, y, 0.0) for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0)]
    copies = np.concatenate([tile.positions / [1.0, tile.aspect, 1.0] + shift for shift in shifts])
    numbers = np.concatenate([tile.triangles + k * len(tile.positions) for k in range(len(shifts))])
    parts = clipping.whole(copies, numbers)
    for axis in (0, 1):
        for limit, side in ((0.0, 1), (1.0, -1)):
            parts = clipping.cut(parts, axis, limit, side)
    parts = clipping.compact(parts)
    return add_object("Trimmed", parts.positions, parts.triangles)


def save_map(tile, path):
    """Any map with the tile's proportions: a shell must have one, realizing reads none."""
    sample = native.Sample(tile.positions.astype(np.float32), tile.triangles, height=tile.height, aspect=tile.aspect)
    gdm = native.bake_gdm(sample, resolution=(8, 8, 4), directions=(4, 8))
    native.compress(gdm, sdf=native.bake_sdf(sample, resolution=(8, 8, 5)), terms=4).save(path)


def measured(make):
    """(what make() returns, seconds, bytes that the peak rose by)."""
    gc.collect()
    Path("/proc/self/clear_refs").write_text("5")  # the peak starts again from what is resident now
    before = status("VmRSS")
    start = time.perf_counter()
    made = make()
    return made, time.perf_counter() - start, status("VmHWM") - before


def status(name):
    return 1024 * int(Path("/proc/self/status").read_text().split(f"{name}:")[1].split()[0])


def open_edges(mesh):
    edges = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", edges)
    return int((np.bincount(edges) != 2).sum())


def active_after(answer):
    assert answer == {'FINISHED'}, answer
    return bpy.context.view_layer.objects.active


def realize():
    return active_after(bpy.ops.mesoshell.realize(object="Base", tile="Tile"))


def tessellate(component, tile):
    """Tissue with the component's own coordinates, merged."""
    base = bpy.data.objects["Base"]
    bpy.context.view_layer.objects.active = base
    return active_after(bpy.ops.object.tissue_tessellate(
        generator="Base", component=component, component_mode='OBJECT', mode='LOCAL', fill_mode='QUAD', rotation_mode='UV',
        scale_mode='CONSTANT', zscale=THICKNESS / tile.height, normals_mode='VERTS', merge=True, com_modifiers=False,
        gen_modifiers=False))


def remove(obj):
    mesh = obj.data
    bpy.data.objects.remove(obj)
    bpy.data.meshes.remove(mesh)


def bench(name, detail, around, across, with_tissue, folder):
    tile = tiles.make(name, detail)
    path = str(Path(folder) / f"{name}.gdm.exr")
    save_map(tile, path)
    added = [torus(around, across), add_tile(tile), add_component(tile), add_trimmed(tile)]
    bpy.context.view_layer.update()
    assert bpy.ops.mesoshell.add_shell(object="Base", filepath=path, thickness=THICKNESS) == {'FINISHED'}
    makers = {"ours": realize}
    if with_tissue:
        makers |= {"tissue": lambda: tessellate("Component", tile), "trimmed": lambda: tessellate("Trimmed", tile)}
    rows = {}
    for _ in range(ROUNDS):
        for who, make in makers.items():
            made, seconds, peak = measured(make)
            row = {"who": who, "tile": name, "tiles": around * across, "faces": len(made.data.polygons), "seconds": seconds,
                   "peak": peak, "open_edges": open_edges(made.data)}
            remove(made)
            known = rows.setdefault(who, row)
            known["seconds"], known["peak"] = min(known["seconds"], seconds), min(known["peak"], peak)
    for obj in added:
        remove(obj)
    return list(rows.values())


def least_ratio(rows, name):
    """The least over all cases of what Tissue takes a face to what we take."""
    cost = {(row["who"], row["tile"], row["tiles"]): row[name] / row["faces"] for row in rows}
    return min(value / cost["ours", tile, count] for (who, tile, count), value in cost.items() if who != "ours")


def tissue():
    """Whether Blender has Tissue, which is enabled then."""
    if "mesh_tissue" not in {found.__name__ for found in addon_utils.modules()}:
        print(f"Blender {bpy.app.version_string} has no Tissue (mesh_tissue): only our own figures")
        return False
    # As if ticked in the preferences, where it looks itself up; nothing is saved.
    return addon_utils.enable("mesh_tissue", default_set=True) is not None


def main():
    mesoshell.register()
    with_tissue = tissue()
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    rows = []
    print(f"{'':8}{'tile':>8}{'tiles':>7}{'faces':>10}{'seconds':>9}{'M faces/s':>10}{'peak MB':>9}{'open edges':>12}")
    with tempfile.TemporaryDirectory() as folder:
        for case in CASES:
            for row in bench(*case, with_tissue, folder):
                rows.append(row)
                print(f"{row['who']:8}{row['tile']:>8}{row['tiles']:>7}{row['faces']:>10}{row['seconds']:>9.2f}"
                      f"{row['faces'] / row['seconds'] / 1e6:>10.2f}{row['peak'] / 2**20:>9.0f}{row['open_edges']:>12}",
                      flush=True)
    ours = [row for row in rows if row["who"] == "ours"]
    most = max(row["open_edges"] for row in ours)
    goals = [{"name": "open edges of the realized mesh, most", "value": most, "goal": "= 0", "holds": most == 0}]
    if with_tissue:
        time_ratio, memory_ratio = least_ratio(rows, "seconds"), least_ratio(rows, "peak")
        print(f"Tissue's seconds a face over ours, least: {time_ratio:.2f}")
        # Where both are as quick as each other, noise decides: no goal.
        goals.append({"name": "Tissue's memory a face over ours, least", "value": round(memory_ratio, 2), "goal": ">= 1",
                      "holds": memory_ratio >= 1.0})
    OUT.write_text(json.dumps({"bench": "realize", "rows": rows, "goals": goals}, indent=1))
    if with_tissue:  # with which Blender 3.4 crashes at its end
        sys.stdout.flush()
        os._exit(0)


main()
