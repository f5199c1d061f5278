# runs in Blender, which has what an add-on author would reach for: mathutils.bvhtree
"""What a GDM bake costs: both engines beside bare loops of Embree and BVHTree.ray_cast, in one run; how it scales.

Paper preset (64 x 64 x 32 nodes, 16 x 32 directions) over the very same rays. A bake's figure has everything in it: BVH or
shears, inside or outside, writing to memory; Embree's bare loops have only the rays. Shared machines are noisy: rounds are
interleaved, ratios are medians of ratios within a round.
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

import tiles  # noqa: E402
from mesoshell.core import native  # noqa: E402

OUT = Path(sys.argv[sys.argv.index("--out") + 1])
PROGRAM = ROOT / "build" / "native" / "bench" / "bake_rays"
PAPER = (64, 64, 32), (16, 32)
ROUNDS = 5
BVHTREE_RAYS = 100_000
OPEN3D_RAYS = 4_000_000


def cpu_name():
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    flags = set(next(line for line in lines if line.startswith("flags")).split())
    units = [unit for unit in ("sse4_2", "avx2", "fma", "avx512f") if unit in flags]
    return next(line for line in lines if line.startswith("model name")).split(": ")[1], units


def seconds(tile, resolution, directions, what, rounds, threads=0):
    """Number of rays, and seconds [rounds, len(what)]; see native/bench/bake_rays.cpp."""
    with tempfile.NamedTemporaryFile(suffix=".mesh") as file:
        file.write(np.array([len(tile.positions), len(tile.triangles)], np.int32).tobytes())
        file.write(tile.positions.astype(np.float32).tobytes() + tile.triangles.astype(np.uint32).tobytes())
        file.flush()
        arguments = [file.name, *resolution, *directions, tile.height, tile.aspect, threads, rounds, *what]
        text = subprocess.run([PROGRAM, *map(str, arguments)], check=True, stdout=subprocess.PIPE, text=True).stdout
    first, *rows = text.splitlines()
    return int(first), np.array([row.split() for row in rows], float)


def random_rays(tile, gdm, count):
    """A sample of a bake's rays: origins, directions, limits (float64), and the baked distances."""
    random = np.random.default_rng(3)
    (nx, ny, nz), (ntheta, nphi) = PAPER
    index = [random.integers(0, n, 3 * count) for n in (nphi, ny, nx, ntheta, nz)]
    outside = gdm.values[tuple(index)] > 0.0  # inside the solid the bake casts no ray
    phi, y, x, theta, z = (part[outside][:count] for part in index)
    polar, azimuth = np.pi * theta / (ntheta - 1), 2.0 * np.pi * phi / nphi
    origins = np.stack([x / nx, tile.aspect * y / ny, tile.height * z / (nz - 1)], -1)
    directions = np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], -1)
    vertical = directions[:, 2]
    limits = np.where(vertical > 0, tile.height - origins[:, 2], origins[:, 2]) / np.maximum(np.abs(vertical), 1e-6)
    return origins, directions, limits, gdm.values[phi, y, x, theta, z]


def copies_of(tile):
    """Copies of the tile as far as rays at 84 degrees reach: positions, triangles."""
    reach = int(np.ceil(tile.height * 9.6)) + 1
    shifts = np.stack(np.meshgrid(np.arange(-reach, reach + 1), np.arange(-reach, reach + 1)), -1).reshape(-1, 2)
    positions = np.concatenate([tile.positions + [i, j * tile.aspect, 0.0] for i, j in shifts])
    triangles = np.concatenate([tile.triangles + k * len(tile.positions) for k in range(len(shifts))])
    return positions, triangles


def bvhtree(tile, gdm):
    """Million rays a second of BVHTree.ray_cast on one thread, as Python calls it, and the share that agrees with the bake."""
    positions, triangles = copies_of(tile)
    tree = BVHTree.FromPolygons(positions.tolist(), triangles.tolist(), all_triangles=True)
    origins, directions, limits, baked = random_rays(tile, gdm, BVHTREE_RAYS)
    rays = [(Vector(o), Vector(d), t) for o, d, t in zip(origins, directions, limits)]
    cast = tree.ray_cast
    start = time.perf_counter()
    hits = [cast(origin, direction, limit)[3] for origin, direction, limit in rays]
    elapsed = time.perf_counter() - start
    found = np.array([limit if hit is None else hit for hit, limit in zip(hits, limits)])
    return len(rays) / elapsed / 1e6, float((np.abs(found - baked) < 1e-3).mean())


def open3d(tile, gdm):
    """Million rays a second of Open3D's RaycastingScene, all cores; None where Debian's package is not installed."""
    try:
        import open3d
    except ImportError:
        return None
    scene = open3d.t.geometry.RaycastingScene()
    positions, triangles = copies_of(tile)
    scene.add_triangles(open3d.core.Tensor(positions.astype(np.float32)), open3d.core.Tensor(triangles.astype(np.uint32)))
    origins, directions, _, _ = random_rays(tile, gdm, OPEN3D_RAYS)
    rays = open3d.core.Tensor(np.concatenate([origins, directions], 1).astype(np.float32))
    start = time.perf_counter()
    scene.cast_rays(rays)
    return len(origins) / (time.perf_counter() - start) / 1e6


def bench_engines():
    """One row a tile: million rays a second, and medians of ratios."""
    what = ("slices", "embree", "packets", "singles")
    module = native.module()
    rows = []
    print(f"\nPaper preset, million rays a second (best of {ROUNDS}), all cores; ratios to rtcIntersect16 (medians)")
    print(f"{'tile':<8}{'triangles':>10}{'slices':>9}{'embree':>9}{'Intersect16':>13}{'Intersect1':>12}{'BVHTree':>9}{'Open3D':>8}"
          f"{'slices is':>12}{'embree is':>12}{'BVHTree agrees':>16}")
    for name in tiles.NAMES:
        tile = tiles.make(name)
        rounds = ROUNDS if name in ("weave", "chain") else 2
        rays, times = seconds(tile, *PAPER, what if rounds == ROUNDS else what[:3], rounds)
        rates = rays / times.min(axis=0) / 1e6
        row = {"tile": name, "triangles": len(tile.triangles), "rays": rays,
               "slices_of_tuned": float(np.median(times[:, 2] / times[:, 0])),
               "embree_of_tuned": float(np.median(times[:, 2] / times[:, 1]))}
        row |= {f"{engine}_mrays_per_s": rate for engine, rate in zip(what, rates)}
        agrees = ""
        if rounds == ROUNDS:
            sample = module.Sample(tile.positions, tile.triangles, height=tile.height, aspect=tile.aspect)
            gdm = module.bake_gdm(sample, resolution=PAPER[0], directions=PAPER[1])
            row["bvhtree_mrays_per_s"], row["bvhtree_agrees"] = bvhtree(tile, gdm)
            row["open3d_mrays_per_s"] = open3d(tile, gdm)
            agrees = f"{row['bvhtree_agrees']:.4%}"
        rows.append(row)

        def rate(key):
            return f"{row[key]:.2f}" if row.get(key) is not None else "-"

        print(f"{name:<8}{row['triangles']:>10}{rate('slices_mrays_per_s'):>9}{rate('embree_mrays_per_s'):>9}"
              f"{rate('packets_mrays_per_s'):>13}{rate('singles_mrays_per_s'):>12}{rate('bvhtree_mrays_per_s'):>9}"
              f"{rate('open3d_mrays_per_s'):>8}{row['slices_of_tuned']:>11.2f}x{row['embree_of_tuned']:>11.2f}x{agrees:>16}",
              flush=True)
    if rows[0].get("open3d_mrays_per_s") is None:
        print("Open3D: Debian's python3-open3d is not installed")
    return rows


def bench_threads():
    """Median over interleaved pairs of one thread's time over two threads' time, chain and weave."""
    ratios = []
    for name in ("weave", "chain"):
        _, times = seconds(tiles.make(name), *PAPER, ("slices@1", "slices@2"), 7)
        ratios.append(times[:, 0] / times[:, 1])
    scaling = float(np.median(np.concatenate(ratios)))
    print(f"\nTwo threads are {scaling:.2f} x one thread (median of {2 * len(ratios[0])} interleaved pairs, weave and chain)")
    return scaling


def bench_samples():
    """Nanoseconds a sample, from 32 x 32 x 16 to 256 x 256 x 64 nodes, 16 x 4 directions, azimuth by azimuth."""
    tile = tiles.make("chain")
    rows = []
    print(f"\n{'nodes':<16}{'samples':>14}{'seconds':>10}{'ns a sample':>13}")
    for nodes in ((32, 32, 16), (64, 64, 32), (128, 128, 64), (256, 256, 64)):
        samples = int(np.prod(nodes)) * 16 * 4
        _, times = seconds(tile, nodes, (16, 4), ("stream",), 3)
        rows.append({"nodes": nodes, "samples": samples, "seconds": float(times.min()), "ns": 1e9 * float(times.min()) / samples})
        print(f"{' x '.join(map(str, nodes)):<16}{samples:>14}{rows[-1]['seconds']:>10.3f}{rows[-1]['ns']:>13.2f}", flush=True)
    return rows


def bench_triangles():
    """Seconds of both engines from 100 to a million triangles, 64 x 64 x 32 nodes, 16 x 4 directions."""
    rows = []
    print(f"\n{'triangles':>10}{'slices s':>10}{'embree s':>10}{'faster':>9}")
    for detail in (0.125, 0.33, 1.0, 3.2, 5.5, 10.0):
        tile = tiles.make("chain", detail)
        _, times = seconds(tile, PAPER[0], (16, 4), ("slices", "embree"), 2)
        slices, embree = times.min(axis=0)
        rows.append({"triangles": len(tile.triangles), "slices_seconds": float(slices), "embree_seconds": float(embree)})
        print(f"{len(tile.triangles):>10}{slices:>10.3f}{embree:>10.3f}{'slices' if slices < embree else 'embree':>9}", flush=True)
    return rows


def main():
    subprocess.run(["ninja", "-C", ROOT / "build" / "native", "bake_rays"], check=True, stdout=subprocess.DEVNULL)
    module = native.module()
    cpu, units = cpu_name()
    print(f"{cpu}, {', '.join(units)}; kernels: {module.instruction_set()}; Embree {module.embree_version()}")
    engines = bench_engines()
    scaling = bench_threads()
    samples = bench_samples()
    triangles = bench_triangles()
    measured = [row for row in engines if row["tile"] in ("weave", "chain")]
    against = float(np.exp(np.mean([np.log(row["slices_of_tuned"]) for row in measured])))
    embree = float(np.exp(np.mean([np.log(row["embree_of_tuned"]) for row in measured])))
    linear = max(row["ns"] for row in samples) / min(row["ns"] for row in samples)
    goals = [
        {"name": "slices over tuned Embree, geometric mean of weave and chain", "value": round(against, 2), "goal": ">= 3",
         "holds": against >= 3.0},
        {"name": "Embree engine over tuned Embree, likewise", "value": round(embree, 2), "goal": ">= 0.95", "holds": embree >= 0.95},
        {"name": "two threads over one", "value": round(scaling, 2), "goal": ">= 1.8", "holds": scaling >= 1.8},
        {"name": "time a sample, largest over smallest, 32x32x16 to 256x256x64", "value": round(linear, 2), "goal": "<= 2",
         "holds": linear <= 2.0},
    ]
    OUT.write_text(json.dumps({"bench": "bake", "cpu": cpu, "vector_units": units, "kernels": module.instruction_set(),
                               "embree": module.embree_version(), "engines": engines, "threads": scaling, "samples": samples,
                               "triangles": triangles, "goals": goals}, indent=1))


main()
