"""Shader text: where it lies, and its `#include "x.glsl"` lines inlined for GLSL compilers that know none."""

import re
from functools import cache
from pathlib import Path

from . import interface

FOLDER = Path(__file__).resolve().parent.parent / "shaders"

_INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"\s*$')


def resolve(path, _seen=None):
    """The text of the shader file at `path`, every file it includes inlined once, before its first use.

    Raises FileNotFoundError that names the file and the one that includes it.
    """
    seen = set() if _seen is None else _seen
    path = Path(path).resolve()
    seen.add(path)
    lines = []
    for line in path.read_text(encoding="utf-8").splitlines():
        match = _INCLUDE.match(line)
        if match is None:
            lines.append(line)
            continue
        included = (path.parent / match[1]).resolve()
        if included in seen:
            continue
        if not included.is_file():
            raise FileNotFoundError(f"{path.name} includes {match[1]}, which is missing; install the add-on again")
        lines.append(resolve(included, seen))
    return "\n".join(lines) + "\n"


@cache
def shell_interface():
    """The interface of the draw program."""
    return interface.load(FOLDER / "interface.toml")


@cache
def stage(name):
    """The resolved text of a stage, for instance "shell.frag"."""
    return resolve(FOLDER / "stage" / f"{name}.glsl")
