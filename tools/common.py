"""What every tool shares: where things are, the version, and how to fail with one sentence."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
from contextlib import contextmanager
from pathlib import Path

REPO = Path(__file__).resolve().parent.parent
BUILD = REPO / "build"
NATIVE_BUILD = BUILD / "native"
STAGE = BUILD / "stage"
DIST = BUILD / "dist"
ADDON = REPO / "addon" / "mesoshell"
MANIFEST = ADDON / "blender_manifest.toml"

# Debian's own interpreter: the one Blender embeds. `python3` on PATH may be another.
PYTHON = "/usr/bin/python3"


class Problem(Exception):
    """A bad situation in one sentence: what is wrong, and what to do about it."""


def guard(main) -> None:
    """Runs main() and turns a Problem into a sentence on stderr and exit status 1."""
    try:
        status = main()
    except Problem as problem:
        sys.stdout.flush()
        print(f"{Path(sys.argv[0]).stem}: {problem}", file=sys.stderr)
        status = 1
    except KeyboardInterrupt:
        status = 130
    sys.exit(status or 0)


def version() -> str:
    """The version of everything: the add-on's manifest is the one place that has it."""
    return tomllib.loads(MANIFEST.read_text())["version"]


def output(argv: list[str | Path], **kwargs) -> str:
    """Standard output of a command that must succeed."""
    argv = [str(a) for a in argv]
    try:
        done = subprocess.run(argv, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **kwargs)
    except FileNotFoundError:
        raise Problem(f"{argv[0]} is not installed; `./dev` installs it, call the tool through it") from None
    if done.returncode:
        raise Problem(f"`{' '.join(argv)}` failed with status {done.returncode}: {done.stderr.strip()[-2000:]}")
    return done.stdout


def wanted_packages(*who: str) -> list[str]:
    """Packages of tools/packages.txt for any of these users (`test`, `root`, `root:trixie` …), in the table's order."""
    names = []
    for line in (REPO / "tools" / "packages.txt").read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            name, users, _why = line.split(None, 2)
            if set(users.split(",")) & set(who):
                names.append(name)
    return names


@contextmanager
def replaced_file(path: Path):
    """Yields a temporary path beside `path`; on success it takes the place of `path` in one step."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        yield temporary
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def replaced_folder(path: Path):
    """Yields an empty folder beside `path`; on success it takes the place of `path`."""
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    old = path.with_name(f".{path.name}.{os.getpid()}.old")
    shutil.rmtree(fresh, ignore_errors=True)
    fresh.mkdir()
    try:
        yield fresh
        if path.exists():
            path.rename(old)
        fresh.rename(path)
    finally:
        shutil.rmtree(fresh, ignore_errors=True)
        shutil.rmtree(old, ignore_errors=True)
