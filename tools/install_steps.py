"""Installs a package the way a user does, inside a fresh home, each step counted as a test."""

from __future__ import annotations

from pathlib import Path

import zips
from blender_job import Place
from common import DIST
from results import Layer, tail

LEGACY = """
import sys, bpy
bpy.ops.preferences.addon_install(filepath=sys.argv[-1], overwrite=True)
bpy.ops.preferences.addon_enable(module="mesoshell")
bpy.ops.wm.save_userpref()
if "mesoshell" not in bpy.context.preferences.addons:
    sys.exit("the add-on is not enabled after addon_enable; see the lines above")
"""


def step(place: Place, layer: Layer, name: str, argv: list[str | Path]) -> bool:
    """Runs one command; it passes if its status is 0 and no Python error shows in its log."""
    log = place.folder / f"{name.replace(' ', '-')}.log"
    status, seconds = place.run(argv, log, limit=180)
    text = log.read_text(errors="replace")
    ok = status == 0 and "Traceback (most recent call last)" not in text
    return layer.add(name, ok, f"status {status}, end of {log}:\n{tail(log)}", seconds)


def only(pattern: str) -> Path:
    """The one package of a kind in build/dist."""
    return sorted(DIST.glob(pattern))[-1]


def extension(place: Place, layer: Layer) -> bool:
    """Blender 4.2 and later: `blender --command extension build`, `validate` and `install-file`."""
    package = only("*-extension.zip")
    inside = place.machine.inside
    source, rebuilt = place.folder / "extension-source", place.folder / "rebuilt.zip"
    contents = zips.read(package)
    for name, data in contents.items():
        path = source / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    command = ["blender", "--command", "extension"]
    if step(place, layer, "extension build", [*command, "build", "--source-dir", inside(source), "--output-filepath",
                                              inside(rebuilt)]):
        theirs = zips.read(rebuilt)
        different = sorted({n for n in contents.keys() | theirs.keys() if contents.get(n) != theirs.get(n)})
        layer.add("Blender builds the same extension", not different, f"differing files: {', '.join(different)}")
    step(place, layer, "extension validate", [*command, "validate", inside(package)])
    return step(place, layer, "extension install-file", [*command, "install-file", "-r", "user_default", "-e",
                                                         inside(package)])


def legacy(place: Place, layer: Layer) -> bool:
    """Blender before 4.2: Preferences, Add-ons, Install."""
    return step(place, layer, "legacy install", [
        "blender", "--background", "--python-exit-code", "1", "--python-expr", LEGACY, "--",
        place.machine.inside(only("*-legacy.zip"))])
