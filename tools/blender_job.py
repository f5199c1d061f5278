"""Runs Blender for a test, on this machine or in a root: with a home of its own, a time limit, and its log kept."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

from results import FAILED, SKIPPED, Layer, from_junit, tail

# Seconds after which a Blender that tests is taken for hung.
LIMIT = 900

# A display that is the same everywhere, and drawn by the processor even where there is a graphics card.
SOFTWARE = {"LIBGL_ALWAYS_SOFTWARE": "1", "XDG_SESSION_TYPE": "x11"}


@dataclass
class Place:
    """A folder for the logs and reports of one series of Blender runs, and the home that they share, with preferences and
    installed add-ons: by default in the same folder."""
    machine: object
    folder: Path
    home: Path | None = None

    def prepare(self) -> None:
        """Empties the folder: a fresh home."""
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        self.home = self.home or self.folder
        for name in ("home", "tmp", "run"):
            (self.home / name).mkdir(parents=True)
        (self.home / "run").chmod(0o700)

    def environment(self) -> dict[str, str]:
        inside = self.machine.inside(self.home)
        return SOFTWARE | {"HOME": f"{inside}/home", "TMPDIR": f"{inside}/tmp", "XDG_RUNTIME_DIR": f"{inside}/run"}

    def run(self, argv: list[str | Path], log: Path, *, env: dict[str, str] | None = None, window: bool = False,
            limit: float = LIMIT) -> tuple[int | None, float]:
        """Runs a command with this home. Gives the exit status (None: it ran out of time) and the seconds.

        window: under Xvfb. What the command prints goes to `log`, and after a crash what Blender wrote about it.
        """
        if window:
            inside = self.machine.inside(self.folder)
            argv = ["xvfb-run", "-a", "-e", f"{inside}/xvfb.log", "-s", "-screen 0 1280x800x24", *argv]
        log.parent.mkdir(parents=True, exist_ok=True)
        for old in (self.home / "tmp").glob("*.crash.txt"):
            old.unlink()
        start = time.monotonic()
        with log.open("wb") as stream:
            process = subprocess.Popen(self.machine.command(argv, self.environment() | (env or {})), stdout=stream,
                                       stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, start_new_session=True)
            try:
                status = process.wait(limit)
            except BaseException as error:
                # The whole session: xvfb-run's children too. In a root, everything ends with its first process.
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
                if not isinstance(error, subprocess.TimeoutExpired):
                    raise
                status = None
        with log.open("a") as stream:
            for crash in (self.home / "tmp").glob("*.crash.txt"):
                stream.write(f"\n{crash.name}, written by Blender when it crashed:\n{crash.read_text(errors='replace')}")
        return status, time.monotonic() - start


def tests(place: Place, layer_name: str, *, package: str, mode: str, run_py: Path, env: dict[str, str] | None = None,
          blender_args: list[str] = (), pytest_args: list[str] = ()) -> Layer:
    """Runs tests/blender inside Blender. package: `source` or `installed`; mode: `background` or `window`.

    A crash, a hang and a missing report are failures of their own, beside the tests that a report may name.
    """
    junit = place.folder / f"{layer_name.replace(' ', '-')}.xml"
    log = junit.with_suffix(".log")
    junit.unlink(missing_ok=True)
    argv = ["blender", *(["--background"] if mode == "background" else []),
            # An installed add-on is tested with the preferences that the installation left, as its user has them.
            *(["--factory-startup"] if package == "source" else []),
            *blender_args, "--python-exit-code", "1", "--python", place.machine.inside(run_py), "--",
            "--package", package, "--mode", mode, "--junit", place.machine.inside(junit),
            "-p", "no:cacheprovider", *pytest_args]
    status, seconds = place.run(argv, log, env=env, window=mode == "window")
    layer = Layer(layer_name, from_junit(junit), seconds)
    judge(layer, status, log, seconds)
    return layer


def judge(layer: Layer, status: int | None, log: Path, seconds: float) -> None:
    """Adds a failure to a layer whose program ended otherwise than its report says."""
    if status is None:
        what = f"ran out of time after {seconds:.0f} s"
    elif not layer.cases:
        what = f"ended with status {status} and reported no test"
    elif layer.count(SKIPPED) == len(layer.cases):
        what = "skipped every test"
    elif status and not layer.count(FAILED):
        what = f"ended with status {status} although no test failed"
    else:
        return
    layer.add(f"the run itself {what}", False, f"end of {log}:\n{tail(log)}")
