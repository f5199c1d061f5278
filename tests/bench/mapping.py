"""What the prism's maps cost and what they lose: exact fins beside Reshetov's cool patches and the paper's planes, in one run.

C++ by native/bench/prism_fins.cpp; GLSL by a compute shader and by whole frames, on whatever OpenGL there is (llvmpipe without a
GPU). Shared machines are noisy: every figure is the least of several rounds, interleaved.
"""

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "addon" / "mesoshell"), str(ROOT / "tests"), str(ROOT / "tests" / "gl")]

import egl  # noqa: E402
import mail_scenes  # noqa: E402
from core import native, shader_source  # noqa: E402
from OpenGL import GL  # noqa: E402

OUT = Path(sys.argv[sys.argv.index("--out") + 1])
PROGRAM = ROOT / "build" / "native" / "bench" / "prism_fins"
COUNT, REPEATS, ROUNDS = 16384, 16, 5
SIZE = (256, 256)

MAIN = """
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Rays { vec4 rows[]; };  // the eight texels of a prism, origin, direction
uniform float reach;

void main()
{
    uint first = gl_GlobalInvocationID.x * 10u;
    Prism prism = make_prism(rows[first], rows[first + 1u], rows[first + 2u], rows[first + 3u], rows[first + 4u],
                             rows[first + 5u], rows[first + 6u], rows[first + 7u]);
    vec3 dir = rows[first + 9u].xyz;
    float sum = 0.0;
    for (int i = 0; i < REPEATS; ++i) {
        vec3 origin = rows[first + 8u].xyz - dir * (reach * float(i));
        PrismSpan span;
        SPAN;
        sum += span.found ? span.q_in.x + span.q_out.y : 0.0;
    }
    rows[first + 8u].w = sum;
}
"""
WAYS = {
    "exact": "PrismPath path = make_prism_path(prism, origin, dir);"
             "if (path.level) span = level_span(prism, origin, dir, path.level_height); else span = next_span(path, -3.0e38)",
    "cool": "span = cool_span(make_cool_path(prism, origin, dir), -3.0e38)",
    "paper": "span = plane_span(prism, origin, dir, -3.0e38)",
}


def cpp_figures():
    """Lines of prism_fins as {first word: [rest, ...]}."""
    subprocess.run(["ninja", "-C", ROOT / "build" / "native", "prism_fins"], check=True, stdout=subprocess.DEVNULL)
    figures = {}
    for line in subprocess.run([PROGRAM], check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines():
        name, *rest = line.split()
        figures.setdefault(name, []).append(rest)
    return figures


def span_programs():
    loaded = shader_source.resolve(shader_source.FOLDER / "lib/prism_planes.glsl")
    cool = (ROOT / "native/bench/cool_patches.glsl").read_text()
    cool = "\n".join(line for line in cool.splitlines() if not line.startswith("#include"))
    head = f"#version 450 core\n#define REPEATS {REPEATS}\n"
    return {way: egl.compile_program(comp=head + loaded + cool + MAIN.replace("SPAN", text)) for way, text in WAYS.items()}


def glsl_times(shell):
    """Nanoseconds a ray and prism on the GPU, by way."""
    random = np.random.default_rng(2)
    prisms = np.asarray(shell.prisms).reshape(-1, 8, 4)[random.integers(0, shell.prism_count, COUNT)]
    target = (prisms[:, :6, :3] * random.dirichlet(np.ones(6), COUNT)[:, :, None]).sum(1) + random.normal(0, 0.02, (COUNT, 3))
    direction = random.normal(size=(COUNT, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    rows = np.zeros((COUNT, 10, 4), np.float32)
    rows[:, :8], rows[:, 8, :3], rows[:, 9, :3] = prisms, target - 3 * direction, direction
    buffer = int(GL.glGenBuffers(1))
    GL.glBindBufferBase(GL.GL_SHADER_STORAGE_BUFFER, 0, buffer)
    GL.glBufferData(GL.GL_SHADER_STORAGE_BUFFER, rows.nbytes, rows, GL.GL_DYNAMIC_READ)
    programs = span_programs()
    least = dict.fromkeys(WAYS, np.inf)
    for _ in range(ROUNDS + 1):
        for way, program in programs.items():
            GL.glUseProgram(program)
            GL.glUniform1f(GL.glGetUniformLocation(program, "reach"), 0.01)
            GL.glFinish()
            start = time.perf_counter()
            GL.glDispatchCompute(COUNT // 64, 1, 1)
            GL.glFinish()
            least[way] = min(least[way], (time.perf_counter() - start) / (COUNT * REPEATS) * 1e9)
    return least


def block_of(module, tile_map, view, traversal, fins):
    record = shader_source.shell_interface().defaults()
    record["mode"][:3] = {"gdm": 0, "sdf": 1}[traversal], 1, fins
    return record, module.shell_params(record.tobytes(), tile_map, mail_scenes.VIEWS[view])


def frames(module, shell, tile_map):
    """Milliseconds of a frame by (traversal, fins), drawn and rendered."""
    program, inputs = egl.shell_program(), egl.Inputs(shell, tile_map)
    view = mail_scenes.VIEWS["above"]
    times = {}
    for _ in range(ROUNDS):
        for traversal in ("gdm", "sdf"):
            for fins, name in enumerate(("exact", "paper")):
                record, block = block_of(module, tile_map, "above", traversal, fins)
                start = time.perf_counter()
                egl.draw_shell(program, shell, inputs, block, view, SIZE)
                drawn = time.perf_counter()
                module.render(shell, tile_map, clip_from_object=view, size=SIZE, traversal=traversal, settings=record.tobytes())
                ended = time.perf_counter()
                for kind, seconds in (("draw", drawn - start), ("render", ended - drawn)):
                    key = f"{kind} {traversal} {name}"
                    times[key] = min(times.get(key, np.inf), seconds * 1e3)
    return times


def twisted_shell(module, twist):
    """A torus at level 0 whose directors lean by up to `twist`, otherwise from vertex to vertex."""
    positions, sizes, corners, uvs = mail_scenes.torus_mesh(columns=48, rows=24)
    ring = np.stack([positions[:, 0], positions[:, 1], np.zeros(len(positions))], -1)
    normals = positions - ring / np.linalg.norm(ring, axis=1)[:, None]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    normals += twist * np.random.default_rng(5).uniform(-1, 1, normals.shape)
    return module.build_shell(positions, sizes, corners, uvs, thickness=0.1, normals=normals.astype(np.float32))


def pictures(module, tile_map):
    """How the paper's fins change a picture, by twist: share of pixels hit by one only, median and 95 % of distances apart."""
    rows = []
    for twist in (0.0, 0.1, 0.2, 0.4):
        shell = twisted_shell(module, twist)
        drawn = []
        for fins in (0, 1):
            record, _ = block_of(module, tile_map, "above", "sdf", fins)
            drawn.append(module.render(shell, tile_map, clip_from_object=mail_scenes.VIEWS["above"], size=SIZE,
                                       settings=record.tobytes()))
        exact, paper = (picture["hit"] == 1 for picture in drawn)
        near, far = (picture["distance"][exact & paper] for picture in drawn)
        apart = np.abs(near - far) / 0.1
        rows.append({"twist": twist, "silhouette": float((exact != paper).sum() / exact.sum()),
                     "median": float(np.median(apart)), "p95": float(np.percentile(apart, 95))})
    return rows


def main():
    context = egl.make_context()
    module = native.module()
    shell, tile_map = mail_scenes.torus_shell(module), mail_scenes.chain_map(module)
    figures = cpp_figures()
    cpp = {way: float(ns) for way, ns in figures["time"]}
    inverse = float(figures["inverse"][0][0])
    glsl = glsl_times(shell)
    print("a ray and a prism, ns   " + "".join(f"{way:>9}" for way in WAYS))
    print("C++                     " + "".join(f"{cpp[way]:9.0f}" for way in WAYS))
    print("GLSL                    " + "".join(f"{glsl[way]:9.0f}" for way in WAYS))
    print(f"a position to its place: {inverse:.0f} ns")
    lost = [{"way": way, "rays through": kind, "rays": int(rays), "lost": int(count)} for way, kind, rays, count in figures["lost"]]
    for row in lost:
        print(f"lost of {row['rays']} rays ({row['rays through']}), {row['way']}: {row['lost']}")
    paper = [{"twist": float(t), "worst": float(w), "mean": float(m)} for t, w, m in figures["paper"]]
    for row in paper:
        print(f"paper's entry and exit, twist {row['twist']}: worst {row['worst']:.2f}, mean {row['mean']:.4f} edges")
    times = frames(module, shell, tile_map)
    for key, ms in times.items():
        print(f"{key}: {ms:.1f} ms")
    changes = pictures(module, tile_map)
    for row in changes:
        print(f"paper's picture, twist {row['twist']}: silhouette {100 * row['silhouette']:.2f} %, distances apart by "
              f"{row['median']:.4f} (median), {row['p95']:.3f} (95 %) thicknesses")
    exact_lost = sum(row["lost"] for row in lost if row["way"] == "exact" and row["rays through"] != "along-fin")
    goals = [
        {"name": "rays lost by exact fins", "value": exact_lost, "goal": "0", "holds": exact_lost == 0},
        {"name": "cool patches over exact fins, C++", "value": round(cpp["cool"] / cpp["exact"], 2), "goal": ">= 1",
         "holds": cpp["cool"] >= cpp["exact"]},
    ]
    OUT.write_text(json.dumps({"bench": "mapping", "gl": GL.glGetString(GL.GL_RENDERER).decode(), "cpp_ns": cpp, "glsl_ns": glsl,
                               "inverse_ns": inverse, "lost": lost, "paper": paper, "frames_ms": times, "pictures": changes,
                               "goals": goals}, indent=1))
    del context


main()
