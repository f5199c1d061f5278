"""Reads what the dynamic loader reads of a shared object, with binutils' readelf, and rewrites it with patchelf."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

from common import Problem, output


@dataclass
class Dynamic:
    """The dynamic section of one shared object."""
    soname: str = ""
    needed: list[str] = field(default_factory=list)
    runpath: str = ""
    # Library -> the symbol versions of it that this object asks for, e.g. {"libc.so.6": {"GLIBC_2.34"}}.
    versions: dict[str, set[str]] = field(default_factory=dict)


def read(path: Path) -> Dynamic:
    """The dynamic section of a shared object."""
    found = Dynamic()
    for tag, value in re.findall(r"\((SONAME|NEEDED|RPATH|RUNPATH)\).*\[(.*)\]", output(["readelf", "-dW", path])):
        if tag == "SONAME":
            found.soname = value
        elif tag == "NEEDED":
            found.needed.append(value)
        else:
            found.runpath = value
    library = ""
    needs = False
    for line in output(["readelf", "-VW", path]).splitlines():
        if line.startswith("Version"):
            needs = line.startswith("Version needs")
        elif needs and (match := re.search(r"File: (\S+)", line)):
            library = match[1]
        elif needs and (match := re.search(r"Name: (\S+)", line)):
            found.versions.setdefault(library, set()).add(match[1])
    return found


def resolve(path: Path) -> dict[str, Path]:
    """Every library that the loader would load for `path`, at any depth: soname -> file. ELF interpreter excluded."""
    libraries = {}
    for line in output(["ldd", path]).splitlines():
        if "not found" in line:
            raise Problem(f"{path.name} needs {line.split()[0]}, which is not installed; run ./dev build again, "
                          "and if it stays away add its package to tools/packages.txt")
        if match := re.match(r"\s*(\S+) => (/\S+)", line):
            libraries[match[1]] = Path(match[2])
    return libraries


def rewrite(path: Path, *, soname: str = "", runpath: str, renamed: dict[str, str]) -> None:
    """Strips, then sets the soname, the RUNPATH and the names of needed libraries (old -> new).

    Stripping comes first: strip after patchelf is known to damage the file.
    """
    output(["strip", "--strip-unneeded", path])
    # One change a call: patchelf 0.14, given a soname and a RUNPATH together, writes one over the other.
    if soname:
        output(["patchelf", "--set-soname", soname, path])
    for name in read(path).needed:
        if name in renamed:
            output(["patchelf", "--replace-needed", name, renamed[name], path])
    output(["patchelf", "--set-rpath", runpath, path])
