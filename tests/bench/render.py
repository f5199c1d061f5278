"""What a picture costs by every traversal, in C++ and drawn (llvmpipe without a GPU), each beside `march` in the same run.

A torus under chain mail; the GDM has the paper's layout and 16 terms. Then how each grows with the nodes in depth (the GDM
paper, section 5: its frames do not) and with the prisms, and what `exact` costs beside Embree on the realized mesh.

All on one CPU: the reference renderer has one thread, llvmpipe none but the caller's. Seconds are those that the process had
the CPU (of a real GPU's frames, those on the wall), rounds are interleaved, and every figure is the least of its rounds:
shared machines are noisy, and only ratios within a run mean much.
"""

import ctypes
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ["LP_NUM_THREADS"] = "0"  # llvmpipe rasterizes on the calling thread

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "addon" / "mesoshell"), str(ROOT / "tests"), str(ROOT / "tests" / "gl")]

import egl  # noqa: E402
import mail_scenes  # noqa: E402
import numpy as np  # noqa: E402
from core import native, shader_source  # noqa: E402
from OpenGL import GL  # noqa: E402

OUT = Path(sys.argv[sys.argv.index("--out") + 1])
DRAWN = mail_scenes.TRAVERSALS
RENDERED = (*DRAWN, "exact")
VIEW = mail_scenes.VIEWS["above"]
DEPTHS = (16, 32, 64, 128)
# Quads around and along: 1 thousand to a million prisms.
GRIDS = ((32, 16), (180, 90), (1000, 500))
TILES = (5, 15)  # around the tube, twice as many around the axis
THICKNESS = 0.31  # for five tiles around the tube
FRAME, DEPTH_FRAME, PRISM_FRAME, TILE_FRAME = (512, 512), (256, 256), (96, 96), (256, 256)
ROUNDS = 3


def chain_map(module, depth):
    """The chain-mail tile with `depth` nodes in depth, in the paper's layout, with all that any traversal reads."""
    sample = mail_scenes.chain_sample(module)
    return module.bake_map(sample, resolution=(48, 48, depth), directions=(16, 16), layout="paper", terms=16,
                           sdf=module.bake_sdf(sample, resolution=(64, 64, depth)), facets=module.bake_facets(sample))


def torus(module, columns, rows, tiles=5):
    """A torus of 2 * columns * rows prisms; thickness goes with the size of tiles."""
    mesh = mail_scenes.torus_mesh(columns, rows, (2 * tiles, tiles))
    return module.build_shell(*mesh, thickness=THICKNESS * 5 / tiles)


def renderer():
    return GL.glGetString(GL.GL_RENDERER).decode().split(" (")[0]


class Scene:
    """A shell and a map, ready to be rendered and drawn at one size."""

    def __init__(self, module, shell, tile_map, size):
        self.module, self.shell, self.map, self.size = module, shell, tile_map, size
        self.inputs, self.frame = egl.Inputs(shell, tile_map), egl.Frame(shell, size)
        self.clock = time.process_time if "llvmpipe" in renderer() else time.perf_counter

    def render(self, traversal, size=None):
        """(seconds, picture) of the reference renderer."""
        sample = mail_scenes.chain_sample(self.module) if traversal == "exact" else None
        start = time.process_time()
        picture = self.module.render(self.shell, self.map, clip_from_object=VIEW, size=size or self.size,
                                     traversal=traversal, sample=sample, threads=1)
        return time.process_time() - start, picture

    def draw(self, programs, traversal):
        """Seconds of a frame."""
        record = shader_source.shell_interface().defaults()
        record["mode"][0] = DRAWN[traversal]
        block = self.module.shell_params(record.tobytes(), self.map, VIEW)
        GL.glFinish()
        start = self.clock()
        self.frame.draw(programs[traversal], self.inputs, block, VIEW)
        GL.glFinish()
        return self.clock() - start

    def release(self):
        self.frame.release()
        self.inputs.release()


def measure(scenes, programs):
    """{(case, traversal): {"setup", "render", "draw": seconds, "fetches": a ray}} of {case: Scene}.

    The least of interleaved rounds. `setup` is what a picture of one pixel takes, and not in `render`: a tree of the prisms,
    and one of the tile.
    """
    rows = {(case, name): {} for case in scenes for name in RENDERED}
    for turn in range(ROUNDS):
        for (case, name), row in rows.items():
            scene = scenes[case]
            row["setup"] = min(scene.render(name, (1, 1))[0], row.get("setup", np.inf))
            if turn > 0 and len(scenes) > 1 and max(row["whole"], row.get("draw", 0.0)) > 1.0:
                continue  # long enough to tell at once
            seconds, picture = scene.render(name)
            row["whole"] = min(seconds, row.get("whole", np.inf))
            row["fetches"] = float(picture["fetches"].mean())
            if name in DRAWN:
                row["draw"] = min(scene.draw(programs, name), row.get("draw", np.inf))
    for row in rows.values():
        row["render"] = row["whole"] - row["setup"]
    for scene in scenes.values():
        scene.release()
    return rows


def traversals(module, programs):
    """Frames a second of every traversal, and how many times `march`'s they are."""
    scene = Scene(module, mail_scenes.torus_shell(module), chain_map(module, 32), FRAME)
    for name in DRAWN:
        scene.draw(programs, name)  # compiles
    rows = {name: row for (_, name), row in measure({"": scene}, programs).items()}
    print(f"{FRAME[0]} x {FRAME[1]}, one CPU, {scene.shell.prism_count} prisms{'C++':>7}{renderer():>21}")
    print(f"{'':<10}{'fetches a ray':>15}{'frames/s':>12}{'x march':>9}{'frames/s':>12}{'x march':>9}")
    for name, row in rows.items():
        print(f"{name:<10}{row['fetches']:>15.1f}", end="")
        for way in ("render", "draw"):
            if way in row:
                row[f"{way}_over_march"] = rows["march"][way] / row[way]
                print(f"{1 / row[way]:>12.2f}{row[f'{way}_over_march']:>9.2f}", end="")
        print(flush=True)
    return rows


def grow(programs, scenes, label):
    """The rows of `measure`, each with its times over those of the first case."""
    rows = measure(scenes, programs)
    first = next(iter(scenes))
    print(f"{f'time by {label}, over {first}':<44}" + "".join(f"{case:>10}" for case in scenes if case != first))
    for way, title in (("render", "C++"), ("draw", renderer()), ("setup", "C++, setup")):
        for name in {"render": RENDERED, "draw": DRAWN, "setup": ("march",)}[way]:
            for case in scenes:
                rows[case, name][f"{way}_growth"] = rows[case, name][way] / rows[first, name][way]
            ratios = [rows[case, name][f"{way}_growth"] for case in scenes if case != first]
            print(f"  {title:<20.20}{name:<22}" + "".join(f"{ratio:>10.2f}" for ratio in ratios), flush=True)
    return [{label: case, "traversal": name, **row} for (case, name), row in rows.items()]


def depths(module, programs):
    shell = mail_scenes.torus_shell(module)
    scenes = {depth: Scene(module, shell, chain_map(module, depth), DEPTH_FRAME) for depth in DEPTHS}
    return grow(programs, scenes, "nodes in depth")


def prisms(module, programs, shrink):
    """Ever finer prisms on the same torus. With `shrink` tiles and thickness shrink with them, so that a ray meets about as
    many; without, the pattern stays and a ray crosses ever more prisms."""
    tile_map, scenes = chain_map(module, 32), {}
    for columns, rows in GRIDS:
        shell = torus(module, columns, rows, round(5 * columns / GRIDS[0][0]) if shrink else 5)
        scenes[shell.prism_count] = Scene(module, shell, tile_map, TILE_FRAME if shrink else PRISM_FRAME)
    return grow(programs, scenes, "prisms and tiles" if shrink else "prisms")


def held(name):
    """Bytes of this process, by a line of /proc/self/status."""
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith(name))
    return 1024 * int(line.split()[1])


def alone(way, tiles, path):
    """Write one way, in a process of its own: seconds of a frame and of all before it, peak bytes, the picture."""
    module = native.module()
    shell, sample, tile_map = torus(module, 48, 24, tiles), mail_scenes.chain_sample(module), chain_map(module, 32)
    ctypes.CDLL(None).malloc_trim(0)  # what is free would serve again, and not be counted
    Path("/proc/self/clear_refs").write_text("5")  # the peak counts from here
    before = held("VmRSS")
    start = time.process_time()
    mesh = module.realize(shell, sample, threads=1) if way == "realized" else None
    made = time.process_time() - start

    def picture(side):
        start = time.process_time()
        if way == "exact":
            result = module.render(shell, tile_map, clip_from_object=VIEW, size=(side, side), traversal="exact",
                                   sample=sample, threads=1)
        else:
            result = module.trace(mesh["positions"], mesh["triangles"], clip_from_object=VIEW, size=(side, side), threads=1)
        return time.process_time() - start, result

    # A picture as much larger as its rays outweigh the tree that is made for each.
    larger = 1 if way == "exact" else 4
    setup = min(picture(1)[0] for _ in range(ROUNDS))
    result = picture(FRAME[0])[1]
    peak = held("VmHWM") - before
    seconds = min(picture(larger * FRAME[0])[0] for _ in range(2)) - setup
    np.savez(path, frame=seconds / larger**2, setup=made + setup, bytes=peak, hit=result["hit"], distance=result["distance"],
             triangles=0 if mesh is None else len(mesh["triangles"]))


def against_realized():
    """`exact` and Embree on the realized mesh: time, memory, and how far their pictures are the same."""
    rows = []
    print("exact over Embree on the realized mesh")
    print(f"{'tiles':>6}{'triangles':>11}{'frame':>8}{'setup':>8}{'memory':>8}   silhouette IoU, voxels apart (median)")
    for tiles in TILES:
        found = {}
        for way in ("exact", "realized"):
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "picture.npz"
                subprocess.run([sys.executable, __file__, "--out", path, "--alone", way, str(tiles)], check=True)
                found[way] = dict(np.load(path))
        exact, realized = found.values()
        both, either = exact["hit"] & realized["hit"] == 1, exact["hit"] | realized["hit"] == 1
        voxel = THICKNESS * 5 / tiles / mail_scenes.TILE_HEIGHT / 64
        row = {"tiles": 2 * tiles * tiles, "triangles": int(realized["triangles"]),
               **{f"{way}_{what}": float(found[way][what]) for way in found for what in ("frame", "setup", "bytes")},
               "iou": float(both.sum() / either.sum()),
               "apart": float(np.median(np.abs(exact["distance"][both] - realized["distance"][both])) / voxel)}
        rows.append(row)
        ratios = [row[f"exact_{what}"] / row[f"realized_{what}"] for what in ("frame", "setup", "bytes")]
        print(f"{row['tiles']:>6}{row['triangles']:>11}" + "".join(f"{ratio:>8.3f}" for ratio in ratios)
              + f"   {row['iou']:.5f}, {row['apart']:.4f}; Embree's {row['realized_frame']:.2f} s, "
              f"{row['realized_setup']:.2f} s, {row['realized_bytes'] / 1e6:.0f} MB", flush=True)
    return rows


def goals_of(result):
    def growth(traversal, way):
        of_one = [row[way] for row in result["depths"] if row["traversal"] == traversal]
        return of_one[-1] / of_one[0]

    span = f"{DEPTHS[-1]} over {DEPTHS[0]} nodes in depth"
    goals = []
    for way, title in (("fetches", "fetches"), ("render", "time in C++"), ("draw", "time drawn")):
        value = growth("gdm", way)
        goals.append({"name": f"gdm, {title}, {span}", "value": round(value, 2), "goal": "<= 1.25", "holds": value <= 1.25})
    value = growth("slices", "fetches")
    goals.append({"name": f"slices, fetches, {span}", "value": round(value, 2), "goal": ">= 4", "holds": value >= 4.0})
    value = min(row["iou"] for row in result["realized"])
    goals.append({"name": "exact and the realized mesh, silhouette IoU, least", "value": round(value, 5), "goal": ">= 0.998",
                  "holds": value >= 0.998})
    return goals


def main():
    if "--alone" in sys.argv:
        way, tiles = sys.argv[sys.argv.index("--alone") + 1:]
        alone(way, int(tiles), OUT)
        return
    start = time.perf_counter()
    context = egl.make_context()
    module, programs = native.module(), {name: egl.shell_program(number, fins=0) for name, number in DRAWN.items()}
    result = {"bench": "render", "gl": renderer(), "traversals": traversals(module, programs),
              "depths": depths(module, programs), "prisms": prisms(module, programs, shrink=False),
              "prisms_and_tiles": prisms(module, programs, shrink=True), "realized": against_realized()}
    result["goals"] = goals_of(result)
    result["seconds"] = time.perf_counter() - start
    print(f"{result['seconds']:.0f} s")
    OUT.write_text(json.dumps(result, indent=1))
    del context


main()
