# runs in Blender, which has what an add-on author would reach for: mathutils.bvhtree
"""Rays per second of a GDM bake of the chain-mail tile, beside Embree alone and BVHTree.ray_cast, in one run.

Paper preset (64 x 64 x 32 nodes, 16 x 32 directions), all cores, over the very same rays. The bake's figure has everything
in it: the BVHs, inside or outside, writing to memory. BVHTree is one thread, as Python calls it, on a
random sample of the rays. Shared machines are noisy: read the ratios.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "blend_samples")]

from mesoshell.core import native  # noqa: E402
from tiles import chain  # noqa: E402

OUT = Path(sys.argv[sys.argv.index("--out") + 1])
PROGRAM = ROOT / "build" / "native" / "bench" / "bake_rays"
HEIGHT, ASPECT = 0.5, 1.0
RESOLUTION, DIRECTIONS = (64, 64, 32), (16, 32)
ROUNDS = 3
BVHTREE_RAYS = 200_000


def cpu_name():
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    flags = set(next(line for line in lines if line.startswith("flags")).split())
    units = [unit for unit in ("sse4_2", "avx2", "avx512f") if unit in flags]
    return next(line for line in lines if line.startswith("model name")).split(": ")[1], units


def embree_rounds(positions, triangles):
    """Rows of [bake, packet, single] million rays a second."""
    subprocess.run(["ninja", "-C", ROOT / "build" / "native", "bake_rays"], check=True, stdout=subprocess.DEVNULL)
    with tempfile.NamedTemporaryFile(suffix=".mesh") as file:
        file.write(np.array([len(positions), len(triangles)], np.int32).tobytes())
        file.write(positions.astype(np.float32).tobytes() + triangles.astype(np.uint32).tobytes())
        file.flush()
        arguments = [file.name, *RESOLUTION, *DIRECTIONS, HEIGHT, ASPECT, ROUNDS]
        text = subprocess.run([PROGRAM, *map(str, arguments)], check=True, stdout=subprocess.PIPE, text=True).stdout
    rows = np.array([line.split() for line in text.splitlines()[1:]], float)
    assert len(rows) == ROUNDS and (rows[:, 3] == rows[:, 4]).all() and (rows[:, 4] == rows[:, 5]).all(), text
    return rows[:, 3:] / rows[:, :3] / 1e6, int(rows[0, 3])


def bvhtree_mrays(positions, triangles, gdm):
    """BVHTree.ray_cast over copies of the tile as far as rays at 84 degrees reach, on a sample of the bake's rays."""
    shifts = np.stack(np.meshgrid(np.arange(-6, 7), np.arange(-6, 7)), -1).reshape(-1, 2)
    copies = np.concatenate([positions + [i, j * ASPECT, 0.0] for i, j in shifts])
    faces = np.concatenate([triangles + k * len(positions) for k in range(len(shifts))])
    tree = BVHTree.FromPolygons(copies.tolist(), faces.tolist(), all_triangles=True)
    random = np.random.default_rng(3)
    nx, ny, nz = RESOLUTION
    ntheta, nphi = DIRECTIONS
    index = [random.integers(0, count, 2 * BVHTREE_RAYS) for count in (nphi, ny, nx, ntheta, nz)]
    outside = gdm.values[tuple(index)] > 0.0  # inside the solid the bake casts no ray
    phi, y, x, theta, z = (part[outside][:BVHTREE_RAYS] for part in index)
    polar, azimuth = np.pi * theta / (ntheta - 1), 2.0 * np.pi * phi / nphi
    origins = np.stack([x / nx, ASPECT * y / ny, HEIGHT * z / (nz - 1)], -1)
    directions = np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], -1)
    vertical = directions[:, 2]
    limits = np.where(vertical > 0, HEIGHT - origins[:, 2], origins[:, 2]) / np.maximum(np.abs(vertical), 1e-6)
    rays = [(Vector(o), Vector(d), t) for o, d, t in zip(origins, directions, limits)]
    cast = tree.ray_cast
    start = time.perf_counter()
    hits = [cast(origin, direction, limit)[3] for origin, direction, limit in rays]
    seconds = time.perf_counter() - start
    found = np.array([limit if hit is None else hit for hit, limit in zip(hits, limits)])
    baked = gdm.values[phi, y, x, theta, z]
    return len(rays) / seconds / 1e6, float((np.abs(found - baked) < 1e-3).mean())


def main():
    positions, triangles = chain.chain_links()
    module = native.module()
    rates, ray_count = embree_rounds(positions, triangles)
    best = rates.max(axis=0)
    gdm = module.bake_gdm(module.Sample(positions, triangles, height=HEIGHT, aspect=ASPECT), resolution=RESOLUTION,
                          directions=DIRECTIONS)
    bvhtree, agreement = bvhtree_mrays(positions, triangles, gdm)
    cpu, units = cpu_name()
    row = {
        "tile": "chain", "triangles": len(triangles), "rays": ray_count,
        "mrays_per_s": best[0], "embree_tuned_mrays_per_s": best[1], "embree_plain_mrays_per_s": best[2],
        "bvhtree_mrays_per_s": bvhtree, "bvhtree_agrees": agreement,
        "of_tuned": float(np.median(rates[:, 0] / rates[:, 1])), "of_plain": float(np.median(rates[:, 0] / rates[:, 2])),
        "of_bvhtree": best[0] / bvhtree,
    }
    OUT.write_text(json.dumps({"bench": "bake", "cpu": cpu, "vector_units": units, "embree": module.embree_version(),
                               "rounds": ROUNDS, "rows": [row], "goals": []}, indent=1))
    print(f"{cpu}, {', '.join(units)}; Embree {module.embree_version()}; {len(triangles)} triangles, {ray_count / 1e6:.1f} "
          f"million rays; best of {ROUNDS}")
    print(f"{'engine':<28}{'million rays/s':>15}{'bake is':>12}")
    for name, key, ratio in (("bake_gdm", "mrays_per_s", None), ("rtcIntersect16, coherent", "embree_tuned_mrays_per_s", "of_tuned"),
                             ("rtcIntersect1", "embree_plain_mrays_per_s", "of_plain"),
                             ("BVHTree.ray_cast, 1 thread", "bvhtree_mrays_per_s", "of_bvhtree")):
        print(f"{name:<28}{row[key]:>15.2f}" + (f"{row[ratio]:>11.2f} x" if ratio else ""))
    print(f"BVHTree agrees with the bake on {agreement:.4%} of {BVHTREE_RAYS} rays")


main()
