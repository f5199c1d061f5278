# runs in Blender, whose Subdivision Surface and Solidify modifiers make the nearest thing to a shell
"""What a shell costs to build and to update, beside Blender's own modifiers refining the same cages to the same levels in one run.

Cages are tori of quads with two UV seams; a prism is a triangle of the refined cage, two a quad, and Blender's time a prism counts
the same. A build starts from arrays, or from a new object; updates follow one another, as in playback, and move every vertex. Shared
machines are noisy: rounds are interleaved, and every figure is the least of its rounds, which others disturb least.
"""

import gc
import json
import sys
import time
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "addon")]

from mesoshell.core import native as module  # noqa: E402

native = module.module()
OUT = Path(sys.argv[sys.argv.index("--out") + 1])
ROUNDS = 7
# Quads around the axis, around the tube, level: 100 thousand to 2 million prisms.
CAGES = ((80, 40, 2), (256, 128, 2), (64, 32, 4), (360, 176, 2), (90, 44, 4), (704, 710, 0))
COMPARED = {(256, 128, 2), (64, 32, 4), (90, 44, 4)}


def torus(around, along):
    """Vertices [n, 3], corners [f, 4] and UVs [4 f, 2]."""
    j, i = np.mgrid[0:along, 0:around]
    a, b = 2.0 * np.pi * i / around, 2.0 * np.pi * j / along
    out = 1.0 + 0.4 * np.cos(b)
    positions = np.stack([out * np.cos(a), out * np.sin(a), 0.4 * np.sin(b)], -1).reshape(-1, 3).astype(np.float32)
    steps = ((0, 0), (1, 0), (1, 1), (0, 1))
    corners = np.stack([(j + dj) % along * around + (i + di) % around for di, dj in steps], -1).reshape(-1, 4)
    uvs = np.stack([np.stack([(i + di) * 4.0 / around, (j + dj) * 2.0 / along], -1) for di, dj in steps], 2).reshape(-1, 2)
    return positions, corners.astype(np.int32), uvs.astype(np.float32)


def moved(positions, step):
    """The cage bent as a cloth would be; every vertex moves."""
    return (positions + 0.02 * np.sin(3.0 * positions[:, [1, 2, 0]] + 0.3 * step)).astype(np.float32)


def timed(call):
    start = time.perf_counter()
    result = call()
    return result, time.perf_counter() - start


def resident():
    """Bytes of memory that this process holds."""
    return 4096 * int(Path("/proc/self/statm").read_text().split()[1])


def blender_object(positions, corners, uvs, levels):
    """An object with both modifiers, not yet evaluated."""
    mesh = bpy.data.meshes.new("cage")
    mesh.from_pydata(positions.tolist(), [], corners.tolist())
    mesh.uv_layers.new().data.foreach_set("uv", uvs.ravel())
    cage = bpy.data.objects.new("cage", mesh)
    subdivision = cage.modifiers.new("subdivision", "SUBSURF")
    subdivision.levels = levels
    subdivision.boundary_smooth = "PRESERVE_CORNERS"
    solidify = cage.modifiers.new("solidify", "SOLIDIFY")
    solidify.thickness, solidify.offset = 0.05, 1.0
    return cage


def evaluate(cage):
    """Faces of the evaluated object."""
    bpy.context.view_layer.update()
    return len(cage.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.polygons)


def blender_times(positions, corners, uvs, levels):
    """Seconds of a first evaluation and of one after every vertex moved."""
    cage = blender_object(positions, corners, uvs, levels)

    def build():
        bpy.context.collection.objects.link(cage)
        return evaluate(cage)

    faces, first = timed(build)
    assert faces >= 2 * len(corners) * 4 ** levels, "the modifiers did not refine the cage"
    co = moved(positions, 1)

    def update():
        cage.data.vertices.foreach_set("co", co.ravel())
        cage.data.update()
        return evaluate(cage)

    later = timed(update)[1]
    mesh = cage.data
    bpy.data.objects.remove(cage)
    bpy.data.meshes.remove(mesh)
    return first, later


def bench(around, along, levels):
    positions, corners, uvs = torus(around, along)
    sizes = np.full(len(corners), 4, np.int32)

    def build(where):
        return native.build_shell(where, sizes, corners.ravel(), uvs, thickness=0.05, levels=levels)

    build(positions)  # libraries are loaded, threads started
    gc.collect()
    before = resident()
    shell = build(positions)
    held = resident() - before
    arrays = ("prisms", "indices", "positions", "directors", "tangents", "thickness", "triangles", "uv_triangles", "uvs", "faces")
    computed = sum(getattr(shell, name).nbytes for name in arrays)
    frame = native.update_shell(shell, moved(positions, 0))  # from here on two tables exist, which take turns
    times = []
    for step in range(1, ROUNDS + 1):
        where = moved(positions, step)
        seconds = [timed(lambda: build(where))[1]]
        updates = []
        for k in range(max(3, 1_000_000 // shell.prism_count)):
            def update():
                return native.update_shell(frame, moved_now)
            moved_now = moved(positions, step + 0.05 * k)
            frame, spent = timed(update)
            updates.append(spent)
        seconds.append(min(updates))
        if (around, along, levels) in COMPARED:
            seconds += blender_times(where, corners, uvs, levels)
        times.append(seconds)
    least = np.min(times, axis=0)
    count = shell.prism_count
    row = {"quads": len(corners), "levels": levels, "prisms": count, "build_seconds": float(least[0]),
           "update_seconds": float(least[1]), "ratio": float(least[0] / least[1]),
           "bytes_a_prism": held / count, "array_bytes_a_prism": computed / count}
    if len(least) > 2:
        row |= {"blender_build_seconds": float(least[2]), "blender_update_seconds": float(least[3]),
                "build_ratio": float(least[2] / least[0]), "update_ratio": float(least[3] / least[1])}
    return row


def main():
    for name in list(bpy.data.objects):
        bpy.data.objects.remove(name)
    rows = []
    print("Million prisms a second (best of rounds); Blender: Subdivision Surface and Solidify")
    print("Bytes a prism: memory held, arrays alone")
    print(f"{'prisms':>9}{'level':>6}{'build':>8}{'update':>8}{'ratio':>7}{'Blender':>9}{'again':>7}{'bytes':>7}{'arrays':>8}")
    for cage in CAGES:
        row = bench(*cage)
        rows.append(row)
        rate = [row["prisms"] / row[f"{name}_seconds"] / 1e6 if f"{name}_seconds" in row else float("nan")
                for name in ("build", "update", "blender_build", "blender_update")]
        print(f"{row['prisms']:>9}{row['levels']:>6}{rate[0]:>8.2f}{rate[1]:>8.2f}{row['ratio']:>7.1f}{rate[2]:>9.2f}{rate[3]:>7.2f}"
              f"{row['bytes_a_prism']:>7.0f}{row['array_bytes_a_prism']:>8.0f}", flush=True)
    refined = [row for row in rows if row["levels"] > 0]
    compared = [row for row in rows if "update_ratio" in row]
    costs = [row["build_seconds"] / row["prisms"] for row in refined]
    again = [row["update_seconds"] / row["prisms"] for row in refined]
    goals = [
        {"name": "rebuild over update, refined cages, least", "value": round(min(row["ratio"] for row in refined), 1), "goal": ">= 10",
         "holds": min(row["ratio"] for row in refined) >= 10.0},
        {"name": "time a prism of a build, 100 thousand to 2 million, greatest over least", "value": round(max(costs) / min(costs), 2),
         "goal": "<= 2", "holds": max(costs) <= 2.0 * min(costs)},
        {"name": "time a prism of an update, greatest over least", "value": round(max(again) / min(again), 2), "goal": "<= 2",
         "holds": max(again) <= 2.0 * min(again)},
        {"name": "Blender's modifiers over a build, least", "value": round(min(row["build_ratio"] for row in compared), 2), "goal": ">= 1",
         "holds": min(row["build_ratio"] for row in compared) >= 1.0},
        {"name": "Blender's modifiers over an update, least", "value": round(min(row["update_ratio"] for row in compared), 2),
         "goal": ">= 1", "holds": min(row["update_ratio"] for row in compared) >= 1.0},
    ]
    OUT.write_text(json.dumps({"bench": "shell", "rows": rows, "goals": goals}, indent=1))


main()
