"""Runs the tests of every layer, or of the layers named, and ends with `N passed, N failed, N skipped`.

    native      tests/native, GoogleTest through CTest
    tools       tools/tests, pytest
    tiles       tests/tiles, pytest: the six tiles of blend_samples
    core        tests/core, pytest: the add-on's core, without Blender
    gl          tests/gl, pytest with surfaceless EGL
    background  tests/blender in `blender --background`
    window      tests/blender in a Blender window under Xvfb
    asan        tests/native's broken input again, under address and undefined-behavior sanitizers
    fuzz        tests/fuzz, libFuzzer for a minute
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import blender_job
import sanitizers
from common import ADDON, BUILD, NATIVE_BUILD, PYTHON, REPO, STAGE, Problem, guard
from machines import Here, base_environment
from results import FAILED, Layer, from_junit, print_layers, summary

LOGS = BUILD / "test"
# Seconds after which a layer without Blender is taken for hung.
LIMIT = 900

# What a Python that is not inside Blender needs in order to import the add-on's core and draw without a window.
PYTHON_ENV = {"PYTHONPATH": f"{STAGE}:{ADDON.parent}", "PYTHONDONTWRITEBYTECODE": "1", "MESOSHELL_NATIVE_PATH": str(STAGE),
              "PYOPENGL_PLATFORM": "egl", "EGL_PLATFORM": "surfaceless", "LIBGL_ALWAYS_SOFTWARE": "1"}


def run(name: str, argv: list[str], env: dict[str, str]) -> Layer:
    """Runs a program that writes build/test/NAME.xml."""
    junit, log = LOGS / f"{name}.xml", LOGS / f"{name}.log"
    junit.unlink(missing_ok=True)
    start = time.monotonic()
    with log.open("wb") as stream:
        try:
            status = subprocess.run(argv, env=base_environment() | {"HOME": os.environ.get("HOME", "/")} | env, cwd=REPO,
                                    stdin=subprocess.DEVNULL, stdout=stream, stderr=subprocess.STDOUT,
                                    timeout=LIMIT).returncode
        except subprocess.TimeoutExpired:
            status = None
    seconds = time.monotonic() - start
    layer = Layer(name, from_junit(junit), seconds)
    blender_job.judge(layer, status, log, seconds)
    return layer


def native(build: Path = NATIVE_BUILD) -> Layer:
    return run("native", ["ctest", "--test-dir", str(build), "--output-on-failure", "-j", str(os.cpu_count()),
                          "--timeout", "300", "--output-junit", str(LOGS / "native.xml")], {})


def python(name: str, folder: Path) -> Layer:
    return run(name, [PYTHON, "-m", "pytest", "-q", "-p", "no:cacheprovider", f"--junit-xml={LOGS / name}.xml",
                      str(folder)], PYTHON_ENV)


def blender(mode: str) -> Layer:
    place = blender_job.Place(Here(), LOGS / f"blender-{mode}")
    place.prepare()
    return blender_job.tests(place, mode, package="source", mode=mode, run_py=REPO / "tests/blender/run.py",
                             env={"MESOSHELL_NATIVE_PATH": str(STAGE)})


LAYERS = {
    "native": native,
    "tools": lambda: python("tools", REPO / "tools/tests"),
    "tiles": lambda: python("tiles", REPO / "tests/tiles"),
    "core": lambda: python("core", REPO / "tests/core"),
    "gl": lambda: python("gl", REPO / "tests/gl"),
    "background": lambda: blender("background"),
    "window": lambda: blender("window"),
    "asan": lambda: sanitizers.asan(run),
    "fuzz": sanitizers.fuzz,
}


def main() -> int:
    names = sys.argv[1:]
    for name in names:
        if name not in LAYERS:
            raise Problem(f"there is no layer {name}; there are {', '.join(LAYERS)}")
    if not names:
        names = list(LAYERS)
    LOGS.mkdir(parents=True, exist_ok=True)
    layers = []
    for name in names:
        print(f"{name} …", end=" ", flush=True)
        layers.append(LAYERS[name]())
        print(f"{summary(layers[-1:])} in {layers[-1].seconds:.1f} s", flush=True)
    print_layers(layers)
    print(summary(layers))
    return 1 if any(x.count(FAILED) for x in layers) else 0


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    guard(main)
