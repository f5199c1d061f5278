"""What `refined` fetches and reads beside sphere tracing: in an SDF of equal bytes, without the boxes of empty cells, and
both over bytes.

The six tiles on a plane from three elevations, as ./dev accuracy looks at them and measures errors against `exact`. Fetches
are those of rays that meet the shell. Nothing is timed, and so all is the same on every machine. `--tiles` narrows, names
separated by commas.

Bytes are those of what finds the hit: facets of 16 bytes a texel, distances of 2. The goal of 4 MB counts the SDF as well,
which `refined` takes normals from where it has no plane.
"""

import argparse
import json
import sys
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests"), str(ROOT / "blend_samples")]

import accuracy_maps  # noqa: E402
import accuracy_measures  # noqa: E402
import accuracy_scenes  # noqa: E402
import mesoshell_native as native  # noqa: E402
import tiles  # noqa: E402

SIZE = (144, 144)
CELLS = 64  # the default of bake_facets
CURVE_CELLS = (16, 24, 32, 48, CELLS)
CURVE_NODES = (32, 64, 96, 128)
MEGABYTES = 4  # of 2^20 bytes
EQUAL, WITHOUT = "sdf of equal bytes", "refined without boxes"


@dataclass(frozen=True)
class Scene:
    """A tile on the plane from one elevation, and its true picture."""

    shell: object
    view: dict
    truth: dict
    meets: object  # bool [h, w]
    places: accuracy_measures.Places


def scenes_of(tile, sample, any_map):
    shell = accuracy_scenes.planar(tile).shell(native)
    scenes = []
    for elevation in accuracy_scenes.ELEVATIONS:
        clip = accuracy_scenes.view_of(shell, elevation)
        view = {"clip_from_object": clip, "size": SIZE}
        truth = native.render(shell, any_map, traversal="exact", sample=sample, **view)
        meets = accuracy_scenes.shell_mask(native, shell, clip, SIZE)
        directions = accuracy_scenes.ray_directions(clip, SIZE)
        where = accuracy_measures.places(truth, directions, shell.prisms, tile.height, tile.aspect)
        scenes.append(Scene(shell, view, truth, meets, where))
    return scenes


def nodes_along(tile, count):
    """The nodes of an SDF with `count` along u, and as many for a length along v and w."""
    return count, max(round(count * tile.aspect), 2), max(round(count * tile.height), 1) + 1


def equal_nodes(tile, wanted):
    """The nodes of the SDF whose bytes are nearest to so many."""
    def apart(count):
        u, v, w = nodes_along(tile, count)
        return abs(2 * u * v * w - wanted)

    return nodes_along(tile, min(range(8, 257), key=apart))


class Tile:
    """A tile with its sample, and the Errors of traversals on it, of its three views together."""

    def __init__(self, name):
        self.tile = tiles.make(name)
        self.sample = accuracy_maps.sample_of(native, self.tile)
        self.gdm = native.bake_gdm(self.sample, resolution=(4, 4, 3), directions=(4, 4))  # which nothing here reads
        self.default_sdf = native.bake_sdf(self.sample, resolution=accuracy_maps.FIELDS["default"])
        self.scenes = scenes_of(self.tile, self.sample, self.map_of())

    def map_of(self, sdf=None, facets=None):
        return native.compress(self.gdm, terms=1, sdf=sdf or self.default_sdf, facets=facets)

    def row(self, traversal, what, a_map, size):
        """A row of the tables: figures, bytes, and bytes with the SDF that `refined` takes normals of."""
        errors = []
        for scene in self.scenes:
            picture = native.render(scene.shell, a_map, traversal=traversal, **scene.view)
            errors.append(accuracy_measures.compare(picture, scene.truth, scene.places, scene.meets))
        whole = accuracy_maps.data_bytes(native, traversal, a_map, self.sample)
        return {"tile": self.tile.name, "what": what, "bytes": size, "all_bytes": whole,
                **accuracy_measures.pooled(errors).figures()}

    def refined(self, cells, boxes=True):
        a_map = self.map_of(facets=native.bake_facets(self.sample, cells=cells, boxes=boxes))
        what = ("refined" if boxes else WITHOUT) if cells == CELLS else f"refined, {cells} cells"
        return self.row("refined", what, a_map, a_map.facets.nbytes)

    def sdf(self, nodes, what):
        default = what == "sdf"
        a_map = self.map_of(self.default_sdf if default else native.bake_sdf(self.sample, resolution=nodes))
        return {**self.row("sdf", what, a_map, 2 * a_map.sdf.size), "nodes": nodes}


def print_row(row, name):
    print(f"{name:<10}{row['what']:<24}{row['iou']:>9.5f}{row['depth_mean']:>9.4f}{row['within_voxel']:>11.4%}"
          f"{row['fetches']:>9.2f}{row['bytes'] / 2**20:>8.2f}", flush=True)


def print_head(title):
    print(f"{title:<34}{'IoU':>9}{'depth':>9}{'<= 1 voxel':>11}{'fetches':>9}{'MB':>8}")


def measure_tile(measured):
    """The rows of the first table."""
    refined = measured.refined(CELLS)
    rows = [refined, measured.refined(CELLS, boxes=False),
            measured.sdf(equal_nodes(measured.tile, refined["bytes"]), EQUAL),
            measured.sdf(accuracy_maps.FIELDS["default"], "sdf")]
    for row in rows:
        print_row(row, measured.tile.name)
    return rows


def measure_curve(measured, refined):
    """Rows of `refined` and of sphere tracing by cells and nodes; `refined` is the one that is measured already."""
    rows = [refined if cells == CELLS else measured.refined(cells) for cells in CURVE_CELLS]
    return rows + [measured.sdf(nodes_along(measured.tile, nodes), f"sdf, {nodes} nodes") for nodes in CURVE_NODES]


def mean_rows(rows):
    """One row for each of what is measured: the mean of its tiles."""
    means = []
    for what in dict.fromkeys(row["what"] for row in rows):
        own = [row for row in rows if row["what"] == what]
        keys = [key for key, value in own[0].items() if isinstance(value, (int, float))]
        means.append({"tile": "mean", "what": what, **{key: sum(row[key] for row in own) / len(own) for key in keys}})
    return means


def goals_of(rows):
    by = {(row["tile"], row["what"]): row for row in rows}
    names = list(dict.fromkeys(row["tile"] for row in rows))

    def fetches(what):
        return sum(by[name, what]["fetches"] for name in names)

    goals = []
    value = fetches("refined") / fetches(EQUAL)
    goals.append({"name": "refined: fetches over those of the SDF of equal bytes, all tiles", "value": round(value, 3),
                  "goal": "<= 0.5", "holds": value <= 0.5})
    worst = max(names, key=lambda name: by[name, "refined"]["fetches"] / by[name, EQUAL]["fetches"])
    value = by[worst, "refined"]["fetches"] / by[worst, EQUAL]["fetches"]
    goals.append({"name": f"refined: the same, worst tile ({worst})", "value": round(value, 3), "goal": "<= 0.5",
                  "holds": value <= 0.5})
    for key, text in (("iou", "silhouette IoU"), ("within_voxel", "share of hits within 1 voxel")):
        worst = min(names, key=lambda name: by[name, "refined"][key] - by[name, EQUAL][key])
        value = by[worst, "refined"][key] - by[worst, EQUAL][key]
        goals.append({"name": f"refined: {text} less that of the SDF of equal bytes, worst tile ({worst})",
                      "value": round(value, 5), "goal": ">= 0", "holds": value >= 0.0})
    value = max(by[name, "refined"]["all_bytes"] for name in names) / 2**20
    goals.append({"name": "refined: MB that it and its normals read, most of a tile", "value": round(value, 2),
                  "goal": f"<= {MEGABYTES}", "holds": value <= MEGABYTES})
    return goals


def parse():
    parser = argparse.ArgumentParser(prog="dev bench refined", description=__doc__.split("\n\n")[0])
    parser.add_argument("--out", type=Path, required=True, help="the JSON to write")
    parser.add_argument("--tiles", default=",".join(tiles.NAMES), help="names, separated by commas; all six if left out")
    options = parser.parse_args([word for word in sys.argv[1:] if word != "--"])
    options.tiles = options.tiles.split(",")
    for name in options.tiles:
        if name not in tiles.NAMES:
            parser.error(f"there is no tile {name}; there are {', '.join(tiles.NAMES)}")
    return options


def main():
    options = parse()
    start = time.perf_counter()
    rows, curves = [], []
    print_head(f"plane, {SIZE[0]} x {SIZE[1]}")
    for name in options.tiles:
        measured = Tile(name)
        rows += measure_tile(measured)
        curves += measure_curve(measured, rows[-4])
    means, curve = mean_rows(rows), mean_rows(curves)
    for row in means:
        print_row(row, "mean")
    print_head("over bytes, mean of tiles")
    for row in curve:
        print_row(row, "")
    seconds = time.perf_counter() - start
    print(f"{seconds:.0f} s")
    options.out.write_text(json.dumps({"bench": "refined", "size": SIZE, "rows": rows, "means": means, "curves": curves,
                                       "curve": curve, "goals": goals_of(rows), "seconds": seconds}, indent=1))


main()
