"""How far every traversal is from the truth: renders tiles x bases x views x traversals, prints one table, and writes
build/accuracy.json and a contact sheet for each view, build/accuracy.png being that of the middle one.

The truth is the traversal `exact`: Embree on the tile along the true path. The second opinion, the row `realized`, is Embree
on the tile's triangles warped into the shell, which shares no code with any traversal.

A voxel is 1/64 tile width. Depth errors are lengths along the ray, turned from object units into tile widths by the prism
map's own scale where the truth is hit (accuracy_measures.places).
"""

from __future__ import annotations

import argparse
import json
import sys
import time

from common import BUILD, REPO, STAGE, Problem, guard, replaced_file

sys.path[:0] = [str(STAGE), str(REPO / "blend_samples"), str(REPO / "tests")]

import accuracy_maps  # noqa: E402
import accuracy_measures  # noqa: E402
import accuracy_report  # noqa: E402
import accuracy_scenes  # noqa: E402
import accuracy_sheet  # noqa: E402
import mesoshell_native as native  # noqa: E402
import tiles  # noqa: E402
from accuracy_goals import goals_of  # noqa: E402
from png import write_png  # noqa: E402

OUT = BUILD / "accuracy.json"
REALIZED = "realized"
# Tile widths that the realized mesh may lie beside the curves: as near as the chords of `exact`. With ten times as much, the
# edges of thin tubes differ in 0.3 % of the hits.
MESH_ERROR = 1e-4


class Scene:
    """A shell with a tile, and the pictures of it. `maps` has the map of each accuracy_maps.Variant that is measured."""

    def __init__(self, tile, sample, maps, base, options):
        self.tile, self.sample, self.maps, self.base, self.options = tile, sample, maps, base, options
        self.shell = accuracy_scenes.BASES[base](tile).shell(native)
        self.mesh = native.realize(self.shell, sample, error=1e-3 if options.quick else MESH_ERROR)

    def pictures(self, clip, size):
        """By name: the realized mesh's, and the variants'."""
        view = {"clip_from_object": clip, "size": size}
        found = {REALIZED: native.trace(self.mesh["positions"], self.mesh["triangles"], **view)}
        for variant, a_map in self.maps.items():
            found[variant.name] = native.render(self.shell, a_map, traversal=variant.traversal, sample=self.sample, **view)
        return found

    def look(self, elevation):
        """The Results of one view, and its row of the contact sheet."""
        size = (self.options.size,) * 2
        clip = accuracy_scenes.view_of(self.shell, elevation)
        meets = accuracy_scenes.shell_mask(native, self.shell, clip, size)
        directions = accuracy_scenes.ray_directions(clip, size)
        found = self.pictures(clip, size)
        truth = found.pop(self.options.truth)
        results, cells = [], [(accuracy_sheet.shaded(truth, meets), [])]
        sizes = {v.name: accuracy_maps.data_bytes(native, v.traversal, a_map, self.sample) for v, a_map in self.maps.items()}
        for name, picture in found.items():
            # A traced mesh knows no prisms.
            located = truth if "prism" in truth else picture
            where = accuracy_measures.places(located, directions, self.shell.prisms, self.tile.height, self.tile.aspect)
            errors = accuracy_measures.compare(picture, truth, where, meets)
            results.append(accuracy_report.Result(name, self.tile.name, self.base, elevation, errors, sizes.get(name, 0)))
            if name in self.options.columns:
                depth = accuracy_measures.depth_errors(picture, truth, where.pace)
                cells += [(accuracy_sheet.shaded(picture, meets), []),
                          (accuracy_sheet.difference(picture, truth, depth, meets), caption(errors.figures()))]
        pictures = accuracy_sheet.cropped([picture for picture, _ in cells], meets)
        name = (self.tile.name, self.base, f"{elevation} deg")
        return results, accuracy_sheet.row(name, list(zip(pictures, (words for _, words in cells))))


def caption(f):
    """Words under a difference image."""
    words = [f"IoU {f['iou']:.4f}", f"mean {f['depth_mean']:.3f}", f"p99 {f['depth_p99']:.3g}"]
    return words + ([f"fetch {f['fetches']:.0f}"] if f["fetches"] > 0 else [])


def measure(options):
    """All Results, and the rows of the contact sheets by elevation; says on stdout how it gets on."""
    results, rows = [], {elevation: [] for elevation in options.elevations}
    for name in options.tiles:
        start = time.monotonic()
        print(f"{name} …", end=" ", flush=True)
        tile = tiles.make(name)
        sample = accuracy_maps.sample_of(native, tile)
        maps = {v: accuracy_maps.tile_map(native, tile, sample, v, options.quick) for v in options.variants}
        for base in options.bases:
            scene = Scene(tile, sample, maps, base, options)
            for elevation in options.elevations:
                more, row = scene.look(elevation)
                results += more
                rows[elevation].append(row)
        print(f"{time.monotonic() - start:.1f} s", flush=True)
    return results, rows


def write(options, results, table, sheets):
    """The JSON and the contact sheets; gives the goals and the paths back."""
    goals = goals_of(results)
    report = {"truth": options.truth, "size": options.size, "table": table, "scenes": accuracy_report.scenes(results),
              "goals": goals}
    with replaced_file(options.out) as path:
        path.write_text(json.dumps(report, indent=1))
    paths = [options.out]
    heads = [f"{options.truth} (truth)", *(x for name in options.columns for x in (name, "difference"))]
    middle = options.elevations[len(options.elevations) // 2]
    for elevation, rows in sheets.items():
        suffix = "" if elevation == middle else f"_{elevation}"
        paths.append(options.out.with_name(f"{options.out.stem}{suffix}.png"))
        with replaced_file(paths[-1]) as path:
            write_png(path, accuracy_sheet.sheet(heads, rows))
    return goals, paths


def chosen(text, known, what):
    """The names in a comma-separated list, or all known ones; raises Problem for one that is not known."""
    names = text.split(",") if text else list(known)
    for name in names:
        if name not in known:
            raise Problem(f"there is no {what} {name}; there are {', '.join(known)}")
    return names


def parse(arguments):
    parser = argparse.ArgumentParser(prog="dev accuracy", description=__doc__.split("\n\n")[0])
    parser.add_argument("--tiles", help="names, separated by commas; all six if left out")
    parser.add_argument("--bases", help=f"of {', '.join(accuracy_scenes.BASES)}")
    parser.add_argument("--traversals", help=f"of {', '.join(native.TRAVERSALS)}")
    parser.add_argument("--size", type=int, help="a picture's side in pixels; 256 if left out")
    parser.add_argument("--truth", choices=("exact", REALIZED), default="exact", help="what errors are measured against")
    parser.add_argument("--quick", action="store_true", help="one tile on one base, small pictures, one small map")
    parser.add_argument("--out", default=OUT, help="the JSON to write, pictures beside it")
    options = parser.parse_args(arguments)
    options.tiles = chosen(options.tiles or ("chain" if options.quick else None), tiles.NAMES, "tile")
    options.bases = chosen(options.bases or ("torus" if options.quick else None), accuracy_scenes.BASES, "base")
    options.elevations = accuracy_scenes.ELEVATIONS[1:2] if options.quick else accuracy_scenes.ELEVATIONS
    options.size = options.size or (96 if options.quick else 256)
    options.out = BUILD / options.out
    wanted = chosen(options.traversals, native.TRAVERSALS, "traversal")
    options.variants = [v for v in accuracy_maps.variants_of(native.TRAVERSALS)
                        if v.traversal in (*wanted, options.truth) and (v.in_sheet or not options.quick)]
    shown = (REALIZED, *(v.name for v in options.variants if v.in_sheet))
    options.columns = [name for name in shown if name != options.truth]
    return options


def main(arguments=None):
    options = parse(arguments)
    results, sheets = measure(options)
    table = accuracy_report.table(results)
    accuracy_report.print_table(table)
    goals, paths = write(options, results, table, sheets)
    print()
    for goal in goals:
        print(f"{'holds' if goal['holds'] else 'FAILS'}  {goal['name']}: {goal['value']} (goal: {goal['goal']})")
    print("\n".join(str(path.relative_to(REPO) if path.is_relative_to(REPO) else path) for path in paths))
    return 0 if all(goal["holds"] for goal in goals) else 1


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    guard(main)
