"""The layers that need builds of their own: tests under sanitizers, and fuzzing."""

from __future__ import annotations

import os
import re
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

from common import BUILD, REPO, Problem
from results import Layer, tail

LOGS = BUILD / "test"

# Seconds of fuzzing, and what one input may take.
FUZZ_SECONDS = 60
INPUT_SECONDS = 10
INPUT_MEGABYTES = 1024
ALLOCATION_MEGABYTES = 256

# Leaks count, and a finding ends the test with the stack that led to it.
OPTIONS = {"ASAN_OPTIONS": "detect_leaks=1:abort_on_error=1", "UBSAN_OPTIONS": "print_stacktrace=1"}


def _build(preset: str) -> None:
    log = LOGS / f"{preset}-build.log"
    with log.open("wb") as stream:
        for argv in (["cmake", "--preset", preset], ["cmake", "--build", "--preset", preset]):
            if subprocess.run(argv, cwd=REPO, stdin=subprocess.DEVNULL, stdout=stream, stderr=subprocess.STDOUT).returncode:
                raise Problem(f"the preset {preset} does not build; {log} ends with\n{tail(log)}")


def asan(run: Callable[[str, list[str], dict[str, str]], Layer]) -> Layer:
    """The tests of broken input, by address and undefined-behavior sanitizers."""
    _build("asan")
    return run("asan", ["ctest", "--test-dir", str(BUILD / "asan"), "-L", "^broken$", "--output-on-failure", "-j",
                        str(os.cpu_count()), "--timeout", "600", "--output-junit", str(LOGS / "asan.xml")], OPTIONS)


def fuzz() -> Layer:
    """Mutated maps for a minute, from a few whole ones. A finding stays in build/test/fuzz."""
    start = time.monotonic()
    layer = Layer("fuzz")
    _build("fuzz")
    programs, corpus, log = BUILD / "fuzz/tests/fuzz", LOGS / "fuzz", LOGS / "fuzz.log"
    corpus.mkdir(parents=True, exist_ok=True)
    for old in corpus.iterdir():
        old.unlink()
    seeds = subprocess.run([programs / "load_map_seeds", corpus], capture_output=True, text=True)
    if layer.add("load_map seeds", seeds.returncode == 0 and any(corpus.iterdir()), seeds.stderr):
        _fuzz(layer, programs / "load_map_fuzz", corpus, log)
    layer.seconds = time.monotonic() - start
    return layer


def _fuzz(layer: Layer, program: Path, corpus: Path, log: Path) -> None:
    limits = [f"-max_total_time={FUZZ_SECONDS}", f"-timeout={INPUT_SECONDS}", f"-rss_limit_mb={INPUT_MEGABYTES}",
              f"-malloc_limit_mb={ALLOCATION_MEGABYTES}"]
    argv = [program, "-seed=1", "-max_len=16384", *limits, f"-artifact_prefix={corpus}/finding-", corpus]
    with log.open("wb") as stream:
        try:
            status = subprocess.run(argv, stdin=subprocess.DEVNULL, stdout=stream, stderr=subprocess.STDOUT,
                                    timeout=5 * FUZZ_SECONDS).returncode
        except subprocess.TimeoutExpired:
            status = "none, it hung"
    runs = re.search(r"Done (\d+) runs", log.read_text(errors="replace"))
    ok = status == 0 and runs is not None and int(runs[1]) > 1000
    layer.add("load_map refuses or reads any bytes", ok, f"status {status}; {log} ends with\n{tail(log)}")
