"""Makes the packages of build/dist from the add-on and the staged native module (tools/bundle.py).

    mesoshell_native-VERSION-cp311-abi3-manylinux_2_XX_x86_64.whl   the native module, Python 3.11 and later
    mesoshell-VERSION-extension.zip                                 Blender 4.2 and later; holds the wheel
    mesoshell-VERSION-legacy.zip                                    Blender before 4.2, such as Debian's 3.4.1
"""

from __future__ import annotations

import ast
import json
import sys

import zips
from bundle import RECORD
from common import ADDON, DIST, MANIFEST, REPO, STAGE, Problem, guard, replaced_file, version

MAX_BYTES = 40_000_000


def check_version() -> str:
    """The version, after making sure that the add-on and the native module say the same."""
    ours = version()
    for node in ast.parse((ADDON / "__init__.py").read_text()).body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "bl_info":
            theirs = ".".join(str(n) for n in ast.literal_eval(node.value)["version"])
            break
    else:
        raise Problem("addon/mesoshell/__init__.py has no bl_info, which Blender before 4.2 needs; add it")
    if theirs != ours:
        raise Problem(f"bl_info in addon/mesoshell/__init__.py says version {theirs}, {MANIFEST.name} says {ours}; "
                      "make bl_info follow the manifest")
    native = json.loads(RECORD.read_text())["version"]
    if native != ours:
        raise Problem(f"mesoshell_native.__version__ is {native}, {MANIFEST.name} says {ours}; CMakeLists.txt should read "
                      "it from the manifest")
    return ours


def wheel(version_: str, tag: str) -> zips.Contents:
    """A wheel of the staged module. One abi3 wheel serves every Python from 3.11 on."""
    contents = zips.folder_contents(STAGE)
    info = f"mesoshell_native-{version_}.dist-info"
    contents[f"{info}/METADATA"] = (
        f"Metadata-Version: 2.1\nName: mesoshell_native\nVersion: {version_}\n"
        "Summary: Bakes, compresses and renders mesostructure; the native part of the Mesoshell add-on for Blender\n"
        "License: GPL-3.0-or-later\nRequires-Python: >=3.11\n").encode()
    contents[f"{info}/WHEEL"] = (f"Wheel-Version: 1.0\nGenerator: mesoshell\nRoot-Is-Purelib: false\n"
                                 f"Tag: cp311-abi3-{tag}\n").encode()
    contents[f"{info}/LICENSE"] = (REPO / "LICENSE").read_bytes()
    contents[f"{info}/RECORD"] = zips.record(contents, f"{info}/RECORD")
    return contents


def addon() -> zips.Contents:
    """The add-on's own files, shaders included, native module excluded."""
    contents = zips.folder_contents(ADDON)
    if not any(n.startswith("shaders/lib/") for n in contents):
        raise Problem("addon/mesoshell/shaders has no lib/; it should be a link to ../../shaders, check it out again")
    contents["LICENSE"] = (REPO / "LICENSE").read_bytes()
    return contents


def manifest_with_wheel(wheel_name: str) -> bytes:
    """The manifest with its `wheels`, which must stand before the first [table]."""
    head, bracket, tail = MANIFEST.read_text().partition("\n[")
    return f'{head.rstrip()}\nwheels = ["./wheels/{wheel_name}"]\n{bracket}{tail}'.encode()


def main() -> int:
    tag = json.loads(RECORD.read_text())["platform_tag"]
    version_ = check_version()
    wheel_path = DIST / f"mesoshell_native-{version_}-cp311-abi3-{tag}.whl"
    made = [wheel_path]
    DIST.mkdir(parents=True, exist_ok=True)
    with replaced_file(wheel_path) as path:
        zips.write(path, wheel(version_, tag))

    extension = addon()
    extension["blender_manifest.toml"] = manifest_with_wheel(wheel_path.name)
    extension[f"wheels/{wheel_path.name}"] = wheel_path.read_bytes()
    made.append(DIST / f"mesoshell-{version_}-extension.zip")
    with replaced_file(made[-1]) as path:
        zips.write(path, extension)

    legacy = {n: b for n, b in addon().items() if n != MANIFEST.name}
    legacy |= {f"native/{n}": b for n, b in zips.folder_contents(STAGE).items()}
    made.append(DIST / f"mesoshell-{version_}-legacy.zip")
    with replaced_file(made[-1]) as path:
        zips.write(path, {f"mesoshell/{n}": b for n, b in legacy.items()})

    for path in made:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise Problem(f"{path.name} has {size / 1e6:.0f} MB, more than the {MAX_BYTES / 1e6:.0f} MB that it may have; "
                          "see what grew in build/stage")
        print(f"{size / 1e6:6.1f} MB  {path.relative_to(REPO)}")
    for path in DIST.iterdir():  # packages of an older version would be taken for today's
        if path not in made:
            path.unlink()
    return 0


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    guard(main)
