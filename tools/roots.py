"""Debian roots of other releases, made with debootstrap, kept outside the repository, used again and refreshed.

They lie in $MESOSHELL_ROOTS, or else in ${XDG_CACHE_HOME:-~/.cache}/mesoshell/roots: RELEASE/ and, beside it,
RELEASE.json (what was installed, and when) and RELEASE.log (what debootstrap and apt said).
"""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path

import apt
from common import Problem, replaced_file, wanted_packages
from machines import Root, mounts_below
from results import tail

# Releases that change every day; a root of theirs is upgraded when its last upgrade is older than DAY.
MOVING = ("sid", "testing", "unstable")
DAY = 24 * 3600

# Seconds after which debootstrap, or an installation, is taken for hung.
LIMIT = 1500

# The root is for tests: no manuals, no fsync, no daemons, no retries of a mirror that is not there.
DPKG = """force-unsafe-io
path-exclude=/usr/share/doc/*
path-exclude=/usr/share/man/*
path-exclude=/usr/share/locale/*
path-exclude=/usr/share/icons/*
"""
APT = """APT::Install-Recommends "false";
APT::Sandbox::User "root";
Acquire::Languages "none";
Acquire::Retries "3";
DPkg::Use-Pty "false";
"""


class RootMissing(Problem):
    """A root that cannot be installed here, with the reason."""


def home() -> Path:
    """The folder of all roots."""
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return Path(os.environ.get("MESOSHELL_ROOTS") or cache / "mesoshell" / "roots").absolute()


@contextmanager
def locked(release: str):
    """Keeps a second run from changing the same root."""
    try:
        home().mkdir(parents=True, exist_ok=True)
        file = (home() / f"{release}.lock").open("w")
    except OSError as error:
        raise RootMissing(f"{error.strerror}: {error.filename}; set MESOSHELL_ROOTS to a folder that can be "
                          "written") from None
    with file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def remove(folder: Path) -> None:
    """Removes a root, unless something is mounted in it: removing would reach through the mount."""
    if mounted := mounts_below(folder):
        raise RootMissing(f"{mounted[0]} is mounted; unmount it, so that the broken root {folder} can be made anew")
    if folder.exists():
        subprocess.run(["rm", "-rf", "--one-file-system", str(folder)], check=True)


def ensure(release: str) -> Root:
    """The root of a release, complete and, for sid, at most a day old. Raises RootMissing where that cannot be."""
    if os.geteuid():
        raise RootMissing("a root can only be made as root; run ./dev compat as root or install sudo")
    allowed = subprocess.run(["unshare", "--mount", "--pid", "--net", "--fork", "true"], capture_output=True, text=True)
    if allowed.returncode:
        raise RootMissing(f"this machine forbids the mounts that a root needs ({allowed.stderr.strip()}); allow them, as "
                          "with `docker run --privileged`")
    folder, stamp = home() / release, home() / f"{release}.json"
    packages = sorted(wanted_packages("root", f"root:{release}"))
    known = json.loads(stamp.read_text()) if stamp.is_file() and folder.is_dir() else {}
    log = home() / f"{release}.log"
    root = Root(release, folder, network=True)
    old = release in MOVING and time.time() - known.get("time", 0) > DAY
    if known.get("packages") == packages and old:
        log.write_text("")
        print(f"{release}: upgrading the root to today's packages", flush=True)
        try:
            install(root, packages, log, upgrade=True)
        except RootMissing as problem:
            # A mirror in the middle of its own update is no reason to test nothing: the root of yesterday is complete.
            print(f"{release}: the upgrade failed, so the root stays as it was: {problem}", flush=True)
        else:
            write_stamp(stamp, packages)
    elif known.get("packages") != packages:
        log.write_text("")
        if not (folder / "usr/bin/apt-get").is_file():
            print(f"{release}: making a Debian root in {folder} (log: {log})", flush=True)
            bootstrap(release, folder, log)
        print(f"{release}: installing Blender and what its tests need", flush=True)
        install(root, packages, log, upgrade=release in MOVING)
        write_stamp(stamp, packages)
    return Root(release, folder)


def write_stamp(stamp: Path, packages: list[str]) -> None:
    """Notes that a root is complete."""
    with replaced_file(stamp) as path:
        path.write_text(json.dumps({"packages": packages, "time": time.time()}, indent=1))


def call(argv: list[str], log: Path, what: str, env: dict[str, str] | None = None) -> None:
    """Runs a command that must succeed, its output appended to the log."""
    with log.open("ab") as stream:
        try:
            status = subprocess.run(argv, env=env, stdin=subprocess.DEVNULL, stdout=stream, stderr=subprocess.STDOUT,
                                    timeout=LIMIT).returncode
        except subprocess.TimeoutExpired:
            raise RootMissing(f"{what} took more than {LIMIT} s, see {log}") from None
    if status:
        reasons = [line for line in log.read_text(errors="replace").splitlines() if line.startswith(("E:", "unshare:"))]
        reason = reasons[-1] if reasons else tail(log, 1)
        raise RootMissing(f"{what} failed: {reason} (see {log})")


def bootstrap(release: str, folder: Path, log: Path) -> None:
    """Makes a minimal root; a half-made one never has the final name."""
    partial = folder.with_name(f"{folder.name}.partial")
    remove(partial)
    if folder.exists():
        remove(folder)
    script = Path("/usr/share/debootstrap/scripts") / release
    if not script.exists():
        raise RootMissing(f"debootstrap does not know a release {release}")
    # In a mount namespace, debootstrap's own mounts end with it.
    call(["unshare", "--mount", "debootstrap", "--variant=minbase", release, str(partial), apt.mirror()], log,
         "debootstrap", os.environ | apt.proxy_environment())
    partial.rename(folder)


def install(root: Root, packages: list[str], log: Path, *, upgrade: bool) -> None:
    """Installs the packages, with this machine's way to the mirror."""
    etc = root.folder / "etc"
    (etc / "apt/sources.list").write_text(f"deb {apt.mirror()} {root.name} main\n")
    (etc / "apt/apt.conf.d/80mesoshell").write_text(APT + apt.settings())
    (etc / "dpkg/dpkg.cfg.d").mkdir(parents=True, exist_ok=True)
    (etc / "dpkg/dpkg.cfg.d/mesoshell").write_text(DPKG)
    for name in ("resolv.conf", "hosts"):
        if Path("/etc", name).is_file():
            (etc / name).unlink(missing_ok=True)
            shutil.copyfile(Path("/etc", name), etc / name)
    policy = root.folder / "usr/sbin/policy-rc.d"
    policy.write_text("#!/bin/sh\nexit 101\n")  # no daemon may start
    policy.chmod(0o755)
    env = {"DEBIAN_FRONTEND": "noninteractive"} | apt.proxy_environment() | \
        {k: v for k, v in os.environ.items() if k.lower() in ("http_proxy", "https_proxy", "no_proxy")}
    call(root.command(["apt-get", "update", "-q"], env), log, "apt-get update")
    if upgrade:
        call(root.command(["apt-get", "dist-upgrade", "-qy"], env), log, "apt-get dist-upgrade")
    call(root.command(["apt-get", "install", "-qy", *packages], env), log, "apt-get install")
    call(root.command(["apt-get", "clean"], env), log, "apt-get clean")
    mtab = etc / "mtab"
    if not mtab.is_symlink():  # Blender reads it
        mtab.unlink(missing_ok=True)
        mtab.symlink_to("../proc/self/mounts")
