"""What compressing a GDM costs beside baking it, and which layout has the smallest errors at equal bytes.

Paper preset. Times: rounds of bake and compress in turn, the ratio is the median of the rounds' ratios. Errors: the bytes of the
paper's 16 terms of 8 bits, random rays on the grid and off it against Embree (mesoshell_native.measure), in voxels.
"""

import json
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "blend_samples"))

import mesoshell_native as native  # noqa: E402
import tiles  # noqa: E402

OUT = Path(sys.argv[sys.argv.index("--out") + 1])
ROUNDS = 7
RAYS = 300_000
VOXELS = 64
LAYOUTS = (("paper", "byte"), ("paper", "half"), ("share", "byte"), ("nodes", "byte"), ("nodes", "half"))


def sample_of(name):
    tile = tiles.make(name)
    return native.Sample(tile.positions, tile.triangles, height=tile.height, aspect=tile.aspect)


def timed(call):
    start = time.perf_counter()
    result = call()
    return result, time.perf_counter() - start


def bench_time():
    """Median ratio of compress (exact, 16 terms, the paper's layout) to bake, over weave and chain; and of the default layout."""
    rows = []
    print(f"Seconds, Paper preset, medians of {ROUNDS} rounds")
    print(f"{'tile':<8}{'bake':>8}{'compress':>10}{'ratio':>8}{'default':>9}{'bake_map':>10}")
    for name in ("weave", "chain"):
        sample = sample_of(name)
        native.compress(native.bake_gdm(sample), layout="paper", terms=16)
        times = []
        for _ in range(ROUNDS):
            gdm, bake = timed(lambda: native.bake_gdm(sample))
            paper = timed(lambda: native.compress(gdm, layout="paper", terms=16))[1]
            default = timed(lambda: native.compress(gdm))[1]
            del gdm
            times.append((bake, paper, default, timed(lambda: native.bake_map(sample))[1]))
        bake, paper, default, whole = np.median(times, axis=0)
        ratios = [row[1] / row[0] for row in times]
        rows.append({"tile": name, "bake_seconds": bake, "compress_seconds": paper, "ratios": ratios,
                     "default_seconds": default, "bake_map_seconds": whole})
        print(f"{name:<8}{bake:>8.3f}{paper:>10.3f}{np.median(ratios):>8.2f}{default:>9.3f}{whole:>10.3f}", flush=True)
    return rows


def terms_of(layout, precision, budget):
    one = native.plan_bake(layout=layout, precision=precision, terms=1, memory=64e9)["term_bytes"]
    return int(budget / one)


def bench_errors():
    """A row for each tile and layout at equal bytes."""
    budget = native.plan_bake(layout="paper", precision="byte", terms=16, memory=64e9)["term_bytes"]
    rows = []
    print(f"\nErrors in voxels at {budget / 1e6:.2f} MB, {RAYS} rays each; false hits and misses in percent of the rays; fetches a lookup")
    head = f"{'RMSE':>8}{'50 %':>7}{'95 %':>8}{'99 %':>8}{'hits':>7}{'misses':>8}"
    print(f"{'':<32}{'on the grid':^46}{'off the grid':^46}")
    print(f"{'tile':<8}{'layout':<12}{'terms':>5}{'file':>7}{head}{head}{'fetches':>9}")
    for name in tiles.NAMES:
        sample = sample_of(name)
        gdm, sdf = native.bake_gdm(sample), native.bake_sdf(sample)
        for layout, precision in LAYOUTS:
            terms = terms_of(layout, precision, budget)
            tile_map = native.compress(gdm, sdf=sdf, layout=layout, precision=precision, terms=terms)
            with tempfile.TemporaryDirectory() as folder:
                tile_map.save(f"{folder}/map.exr")
                file_bytes = os.path.getsize(f"{folder}/map.exr")
            row = {"tile": name, "layout": layout, "precision": precision, "terms": terms, "file_bytes": file_bytes,
                   "fetches": 2 * -(-terms // 4), "grid_rmse_voxels": VOXELS * tile_map.rmse}
            text = f"{name:<8}{layout + ' ' + precision:<12}{terms:>5}{file_bytes / 1e6:>7.2f}"
            for rays in ("on_grid", "off_grid"):
                report = native.measure(tile_map, sample, rays=rays, count=RAYS)
                lengths = [VOXELS * report[key] for key in ("rmse", "median", "percentile_95", "percentile_99")]
                row[rays] = {key: VOXELS * report[key] for key in ("rmse", "median", "percentile_95", "percentile_99")} | {
                    key: report[key] for key in ("false_hits", "false_misses")}
                text += "{:>8.2f}{:>7.2f}{:>8.2f}{:>8.2f}".format(*lengths)
                text += f"{100 * report['false_hits']:>7.1f}{100 * report['false_misses']:>8.1f}"
            rows.append(row)
            print(f"{text}{row['fetches']:>9}", flush=True)
    return rows


def geometric_means(rows):
    """{(layout, precision): (median off the grid, 95th percentile off the grid, RMSE off, RMSE on)}, over the tiles."""
    means = {}
    print(f"\nGeometric means over the tiles\n{'':<12}{'50 % off':>10}{'95 % off':>10}{'RMSE off':>10}{'RMSE on':>9}")
    for key in LAYOUTS:
        chosen = [row for row in rows if (row["layout"], row["precision"]) == key]
        values = [[row["off_grid"]["median"], row["off_grid"]["percentile_95"], row["off_grid"]["rmse"], row["on_grid"]["rmse"]]
                  for row in chosen]
        means[key] = np.exp(np.log(values).mean(axis=0))
        print(f"{' '.join(key):<12}" + "".join(f"{value:>{width}.3f}" for value, width in zip(means[key], (10, 10, 10, 9))))
    return means


def main():
    print(f"kernels: {native.instruction_set()}, {os.cpu_count()} threads")
    times = bench_time()
    errors = bench_errors()
    means = geometric_means(errors)
    ratio = float(np.median(np.concatenate([row["ratios"] for row in times])))
    best = min(LAYOUTS, key=lambda key: means[key][0])
    plan = native.plan_bake(memory=64e9)
    goals = [
        {"name": "compress (exact, 16 terms) over bake, median of weave and chain", "value": round(ratio, 2), "goal": "<= 0.5",
         "holds": ratio <= 0.5},
        {"name": "the default layout has the smallest median error off the grid", "value": " ".join(best),
         "goal": f"{plan['layout']} byte", "holds": best == (plan["layout"], "byte")},
    ]
    OUT.write_text(json.dumps({"bench": "compress", "kernels": native.instruction_set(), "times": times, "errors": errors,
                               "goals": goals}, indent=1))


main()
