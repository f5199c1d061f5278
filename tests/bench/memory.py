"""A bake whose raw GDM is larger than the machine's memory: 256 x 256 x 64 nodes, 32 x 64 directions, 34 GB, in less than 4 GB.

Takes some ten minutes on two cores. `--small` bakes 128 x 128 x 64 nodes (8.6 GB) in less than 1.5 GB.
"""

import json
import resource
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "blend_samples"))

import mesoshell_native as native  # noqa: E402
import tiles  # noqa: E402

OUT = Path(sys.argv[sys.argv.index("--out") + 1])
SMALL = "--small" in sys.argv
NODES, LIMIT = ((128, 128, 64), 1.5e9) if SMALL else ((256, 256, 64), 4e9)
DIRECTIONS = (32, 64)
OTHERS = 0.2e9  # what Python, NumPy and the tile take beside the bake


def main():
    tile = tiles.make("chain")
    sample = native.Sample(tile.positions, tile.triangles, height=tile.height, aspect=tile.aspect)
    plan = native.plan_bake(resolution=NODES, directions=DIRECTIONS, memory=LIMIT - OTHERS)
    raw = 4.0 * NODES[0] * NODES[1] * NODES[2] * DIRECTIONS[0] * DIRECTIONS[1]
    print(f"raw GDM {raw / 1e9:.1f} GB in {plan['blocks']} blocks, layout {plan['layout']}, {plan['used'] / 1e9:.2f} GB planned")
    start = time.perf_counter()
    seen = []

    def progress(fraction):
        seen.append((time.perf_counter() - start, fraction))
        if len(seen) % 400 == 0:
            print(f"{seen[-1][0]:>7.0f} s {fraction:>7.1%}", flush=True)
        return True

    tile_map = native.bake_map(sample, resolution=NODES, directions=DIRECTIONS, memory=LIMIT - OTHERS, progress=progress)
    seconds = time.perf_counter() - start
    peak = 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    # How far the progress ever was from the share of time.
    uneven = max(abs(at / seconds - fraction) for at, fraction in seen)
    print(f"{seconds:.0f} s, peak {peak / 1e9:.2f} GB, RMSE {tile_map.rmse * NODES[0]:.2f} voxels, progress within {uneven:.0%} of time")
    goals = [{"name": f"peak memory of a {raw / 1e9:.1f} GB bake, GB", "value": round(peak / 1e9, 2), "goal": f"< {LIMIT / 1e9:.1f}",
              "holds": peak < LIMIT}]
    OUT.write_text(json.dumps({"bench": "memory", "nodes": NODES, "directions": DIRECTIONS, "seconds": seconds, "peak_bytes": peak,
                               "blocks": plan["blocks"], "progress_uneven": uneven, "goals": goals}, indent=1))


main()
