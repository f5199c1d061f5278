"""Tests the packages of build/dist, installed as a user would, in the Blender of this machine and of other Debian
releases, and builds the C++ source where Embree 4 and OpenSubdiv 3.6 are.

    compat.py [here|trixie|sid …]     default: all three

The last line is `N passed, N failed, N skipped`, with the reason where a root could not be installed.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
import time
from pathlib import Path

import blender_job
import install_steps
import roots
from blender_job import Place
from common import BUILD, DIST, PYTHON, REPO, Problem, guard
from machines import Here, Root
from results import FAILED, Layer, from_junit, print_layers, summary, tail

OUT = BUILD / "compat"
RELEASES = ["here", "trixie", "sid"]
# What the tests need beside the installed package.
WITH_TESTS = ["tests", "blend_samples"]
# Roots in which the C++ source is built and its tests run.
SOURCE_ROOTS = ["trixie"]
# Where every test runs in a window too, and not only those that need one: ./dev test does so here, from the source.
WHOLE_WINDOW = ["sid"]

VERSIONS = """
import bpy, platform
print("VERSION Blender", bpy.app.version_string)
print("VERSION Python", platform.python_version())
"""


def describe(place: Place, layer: Layer) -> tuple[int, ...]:
    """Prints the versions of Blender, Python and Embree, and gives that of Blender; empty if Blender does not start."""
    log = place.folder / "versions.log"
    place.run(["blender", "--background", "--factory-startup", "--python-expr", VERSIONS], log, limit=120)
    found = dict(re.findall(r"^VERSION (\w+) (\S+)", log.read_text(errors="replace"), re.MULTILINE))
    if not layer.add("Blender starts", "Blender" in found, f"end of {log}:\n{tail(log)}"):
        return ()
    embree = place.folder / "embree.log"
    place.run(["dpkg-query", "-W", "-f", "${Package} ${Version}\n", "libembree[34]-?", "libosdcpu*"], embree, limit=60)
    packages = ", ".join(" ".join(line.split()) for line in embree.read_text().splitlines() if len(line.split()) == 2)
    print(f"{place.machine.name}: Blender {found['Blender']}, Python {found.get('Python')}, {packages}", flush=True)
    return tuple(int(n) for n in re.findall(r"\d+", found["Blender"])[:3])


def blender_tests(place: Place, version: tuple[int, ...], run_py: Path) -> list[Layer]:
    """The package's tests in every mode that this Blender has."""
    name = place.machine.name
    layers = []

    def run(label: str, mode: str, *blender_args: str, marked: str = "") -> None:
        print(f"{name}: {label} …", end=" ", flush=True)
        layers.append(blender_job.tests(place, f"{name} {label}", package="installed", mode=mode, run_py=run_py,
                                        blender_args=list(blender_args), pytest_args=["-m", marked] if marked else []))
        print(f"{summary(layers[-1:])} in {layers[-1].seconds:.0f} s", flush=True)

    run("window", "window", marked="" if name in WHOLE_WINDOW else "window or gpu")
    if version >= (5, 2, 0):
        # gpu.init() gives a GPU without a window, on either backend.
        run("background opengl", "background", "--gpu-backend", "opengl")
        run("background vulkan", "background", "--gpu-backend", "vulkan", marked="gpu")
    else:
        run("background", "background")
    return layers


def test_here() -> list[Layer]:
    """Tests the packages on this machine, away from the source tree: with a copy of the tests, and a home beside it."""
    with tempfile.TemporaryDirectory(prefix="mesoshell-") as name:
        folder = Path(name)
        for part in WITH_TESTS:
            shutil.copytree(REPO / part, folder / "tree" / part, ignore=shutil.ignore_patterns("__pycache__"))
        return test_release(Place(Here("here"), OUT / "here", folder), folder / "tree/tests/blender/run.py")


def test_root(root: Root) -> list[Layer]:
    """Tests the packages in a root. Of the source tree, only the tests are there."""
    out = OUT / root.name
    out.mkdir(parents=True, exist_ok=True)
    binds = {DIST: ("/mesoshell/dist", False), out: ("/mesoshell/out", True)}
    binds |= {REPO / part: (f"/mesoshell/tree/{part}", False) for part in WITH_TESTS}
    return test_release(Place(Root(root.name, root.folder, binds), out), REPO / "tests/blender/run.py")


def test_release(place: Place, run_py: Path) -> list[Layer]:
    """Installs the packages in a fresh home and tests them."""
    machine = place.machine
    place.prepare()
    layer = Layer(f"{machine.name} package")
    start = time.monotonic()
    version = describe(place, layer)
    if version:
        installed = (install_steps.extension if version >= (4, 2, 0) else install_steps.legacy)(place, layer)
    else:
        installed = False
    layer.seconds = time.monotonic() - start
    print(f"{machine.name}: package {summary([layer])} in {layer.seconds:.0f} s", flush=True)
    return [layer, *(blender_tests(place, version, run_py) if installed else [])]


def source_build(root: Root) -> Layer:
    """Builds the C++ source in a root, with that release's compiler and libraries, and runs the native tests."""
    layer = Layer(f"{root.name} source")
    out = OUT / f"{root.name}-source"
    out.mkdir(parents=True, exist_ok=True)
    build = Path("/var/cache/mesoshell-build")
    (root.folder / build.relative_to("/")).mkdir(parents=True, exist_ok=True)
    place = Place(Root(root.name, root.folder, {REPO: ("/mesoshell/source", False), out: ("/mesoshell/out", True)}), out)
    place.prepare()
    jobs = str(os.cpu_count())
    print(f"{layer.name}: building …", end=" ", flush=True)
    for step in (["cmake", "-S", "/mesoshell/source", "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                  f"-DPython3_EXECUTABLE={PYTHON}"], ["ninja", "-C", build, "-j", jobs]):
        log = out / f"{step[0]}.log"
        status, seconds = place.run(step, log, limit=1200)
        layer.seconds += seconds
        if not layer.add(step[0], status == 0, f"end of {log}:\n{tail(log)}", seconds):
            print("failed", flush=True)
            return layer
    status, seconds = place.run(["ctest", "--test-dir", build, "--output-on-failure", "-j", jobs, "--timeout", "300",
                                 "--output-junit", "/mesoshell/out/native.xml"], out / "ctest.log")
    tests = Layer(layer.name, from_junit(out / "native.xml"))
    blender_job.judge(tests, status, out / "ctest.log", seconds)
    layer.cases += tests.cases
    layer.seconds += seconds
    print(f"{summary([layer])} in {layer.seconds:.0f} s", flush=True)
    return layer


def main() -> int:
    names = sys.argv[1:] or RELEASES
    if not list(DIST.glob("*-extension.zip")):
        raise Problem("build/dist has no packages; run ./dev package, or ./dev compat, which does")
    layers: list[Layer] = []
    skipped = []
    for name in names:
        if name == "here":
            layers += test_here()
            continue
        try:
            with roots.locked(name):
                root = roots.ensure(name)
                layers += test_root(root)
                if name in SOURCE_ROOTS:
                    layers.append(source_build(root))
        except roots.RootMissing as problem:
            skipped.append(f"{name} could not be installed ({problem})")
            print(f"{name}: skipped, {problem}", flush=True)
    print_layers(layers)
    counts = [int(n) for n in re.findall(r"\d+", summary(layers))]
    line = f"{counts[0]} passed, {counts[1]} failed, {counts[2] + len(skipped)} skipped"
    print(f"{line}: {'; '.join(skipped)}" if skipped else line)
    return 1 if any(x.count(FAILED) for x in layers) else 0


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    guard(main)
