"""What ./dev accuracy prints and writes of its results: the table and the JSON."""

from __future__ import annotations

from dataclasses import dataclass

from accuracy_measures import Errors, pooled

COLUMNS = (
    ("IoU", "iou", 8, ".4f"),
    ("depth", "depth_mean", 8, ".3f"),
    ("99 %", "depth_p99", 8, ".2f"),
    ("<= 1 voxel", "within_voxel", 12, ".3%"),
    ("normal", "normal_surface", 8, ".2f"),
    ("at cuts", "normal_cut", 9, ".2f"),
    ("wrong", "misclassified", 9, ".3%"),
    ("fetches", "fetches", 9, ".1f"),
)
LEGEND = """IoU of silhouettes; depth errors along the ray in voxels, mean and 99th percentile; share of hits within 1 voxel;
mean angle between normals in degrees, on the tile's surface and where the slab or the shell's border cuts solids; hits and
misses that the truth has not, and fetches, a ray that meets the shell; the IoU of the worst scene; what the traversal and
its normals read"""


@dataclass(frozen=True)
class Result:
    """What one variant has against the truth in one scene; data_bytes 0 for what reads no map."""

    variant: str
    tile: str
    base: str
    elevation: int
    errors: Errors
    data_bytes: int

    @property
    def scene(self):
        return f"{self.tile}, {self.base}, {self.elevation}"


def table(results):
    """A dict for each variant and elevation: the figures of all its scenes together, the least IoU of one, bytes."""
    rows = []
    for variant in dict.fromkeys(r.variant for r in results):
        for elevation in dict.fromkeys(r.elevation for r in results):
            own = [r for r in results if (r.variant, r.elevation) == (variant, elevation)]
            worst = min(r.errors.figures()["iou"] for r in own)
            rows.append({"variant": variant, "elevation": elevation, "worst_iou": worst,
                         "bytes": max(r.data_bytes for r in own), **pooled([r.errors for r in own]).figures()})
    return rows


def print_table(rows):
    print(f"\n{'traversal':<18}{'view':>5}" + "".join(f"{text:>{width}}" for text, _, width, _ in COLUMNS)
          + f"{'worst IoU':>11}{'kB':>8}")
    for row in rows:
        # What is traced without a map fetches nothing.
        cells = ["-" if key == "fetches" and row[key] == 0 else format(row[key], form) for _, key, _, form in COLUMNS]
        size = f"{row['bytes'] / 1000:.0f}" if row["bytes"] else "-"
        print(f"{row['variant']:<18}{row['elevation']:>5}" + "".join(f"{cell:>{c[2]}}" for cell, c in zip(cells, COLUMNS))
              + f"{row['worst_iou']:>11.4f}{size:>8}")
    print(LEGEND)


def scenes(results):
    """A dict for each Result."""
    return [{"variant": r.variant, "tile": r.tile, "base": r.base, "elevation": r.elevation, "bytes": r.data_bytes,
             "rays": r.errors.rays, **r.errors.figures()} for r in results]
