"""Where a test runs: on this machine, or in the Debian root of another release.

Both have the same two members: `inside(path)`, a path of this machine as the test sees it, and `command(argv, env)`,
what to start here so that argv runs there with exactly that environment.
"""

from __future__ import annotations

import os
import shlex
from dataclasses import dataclass, field
from pathlib import Path

from common import Problem

# The environment that a test sees is made, not inherited, so that a user's own settings change nothing.
BASE = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "LANG": "C.UTF-8"}
INHERITED = ("CI", "PYTEST_ADDOPTS")


def base_environment() -> dict[str, str]:
    """What every test sees of the environment."""
    return BASE | {name: os.environ[name] for name in INHERITED if name in os.environ}


@dataclass
class Here:
    """This machine."""
    name: str = "here"

    def inside(self, path: Path) -> Path:
        return path

    def command(self, argv: list[str | Path], env: dict[str, str], folder: Path | None = None) -> list[str]:
        change = ["-C", str(folder)] if folder else []
        return ["env", "-i", *change, *(f"{k}={v}" for k, v in (base_environment() | env).items()), *map(str, argv)]


@dataclass
class Root:
    """A Debian root. Its mounts, processes and sockets live in namespaces of their own, so that they end with the job:
    nothing stays mounted in the root, nothing runs on, and no X server is mixed up with one outside."""
    name: str
    folder: Path
    # Folders of this machine -> where they appear in the root, and whether the job may write there.
    binds: dict[Path, tuple[str, bool]] = field(default_factory=dict)
    network: bool = False

    def inside(self, path: Path) -> Path:
        """A path below one of the bound folders, or below the root itself, as the root sees it."""
        # The deepest folder first, should one lie in another.
        for outside, (mount, _writable) in sorted(self.binds.items(), key=lambda bind: -len(bind[0].parts)):
            if path.is_relative_to(outside):
                return Path(mount) / path.relative_to(outside)
        if path.is_relative_to(self.folder):
            return Path("/") / path.relative_to(self.folder)
        raise Problem(f"{path} is not visible in the root {self.name}; this is a mistake in tools/compat.py")

    def command(self, argv: list[str | Path], env: dict[str, str], folder: Path | None = None) -> list[str]:
        root = shlex.quote(str(self.folder))
        # A container may forbid a fresh /proc; the outer one serves as well.
        lines = ["set -e", f"mount -t proc proc {root}/proc 2>/dev/null || mount --rbind /proc {root}/proc",
                 f"mount --rbind /dev {root}/dev"]
        for outside, (mount, writable) in self.binds.items():
            source, target = shlex.quote(str(outside)), shlex.quote(f"{self.folder}{mount}")
            lines += [f"mkdir -p {target}", f"mount --bind {source} {target}"]
            if not writable:
                lines.append(f"mount -o remount,bind,ro {target}")
        variables = " ".join(shlex.quote(f"{k}={v}") for k, v in (base_environment() | env).items())
        change = f"-C {shlex.quote(str(folder))} " if folder else ""
        lines += ["set +e", f"chroot {root} /usr/bin/env -i {change}{variables} {shlex.join(map(str, argv))}",
                  # Keeps bash as process 1: the kernel would hide a signal such as abort() from a process 1.
                  "exit $?"]
        namespaces = ["--mount", "--pid", "--fork", "--kill-child"] + ([] if self.network else ["--net"])
        return ["unshare", *namespaces, "/bin/bash", "-c", "\n".join(lines)]


def mounts_below(folder: Path) -> list[str]:
    """Mount points below a folder that this process sees; while there is one, the folder must not be removed."""
    lines = Path("/proc/mounts").read_text().splitlines()
    points = [line.split()[1].encode().decode("unicode_escape") for line in lines]
    return [p for p in points if Path(p).is_relative_to(folder) and Path(p) != folder]
