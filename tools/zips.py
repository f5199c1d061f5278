"""Zip files that are equal, byte for byte, whenever their contents are."""

from __future__ import annotations

import base64
import hashlib
import zipfile
from pathlib import Path

# The oldest time that a zip file can say: contents, not the hour of the build, decide the bytes.
TIME = (1980, 1, 1, 0, 0, 0)

# Contents of an archive: name inside it -> bytes.
Contents = dict[str, bytes]


def folder_contents(folder: Path, prefix: str = "") -> Contents:
    """All files below a folder, links followed; without what an interpreter or an editor left there."""
    contents = {}
    folder = folder.resolve()
    for path in sorted(folder.rglob("*")):
        inside = path.relative_to(folder)
        if any(part == "__pycache__" or part.startswith(".") for part in inside.parts):
            continue
        if path.is_symlink() and path.is_dir():
            # rglob does not descend into a link: shaders/ is one in the source tree.
            contents |= folder_contents(path, f"{prefix}{inside.as_posix()}/")
        elif path.is_file() and path.suffix != ".pyc" and not path.name.endswith("~"):
            contents[f"{prefix}{inside.as_posix()}"] = path.read_bytes()
    return contents


def write(path: Path, contents: Contents) -> None:
    """Writes a zip file. Wheels inside it are stored, since they are packed already."""
    with zipfile.ZipFile(path, "w") as archive:
        for name in sorted(contents):
            info = zipfile.ZipInfo(name, TIME)
            info.create_system = 3  # Unix: the permission bits below count
            info.external_attr = (0o100755 if ".so" in Path(name).suffixes else 0o100644) << 16
            info.compress_type = zipfile.ZIP_STORED if name.endswith(".whl") else zipfile.ZIP_DEFLATED
            archive.writestr(info, contents[name], compresslevel=6)


def read(path: Path) -> Contents:
    """Contents of a zip file, folders' own entries left out."""
    with zipfile.ZipFile(path) as archive:
        return {i.filename: archive.read(i) for i in archive.infolist() if not i.is_dir()}


def record(contents: Contents, name: str) -> bytes:
    """The RECORD file of a wheel, to be stored under `name`: path, sha256 and size of every other file."""
    lines = []
    for path in sorted(contents):
        digest = base64.urlsafe_b64encode(hashlib.sha256(contents[path]).digest()).rstrip(b"=").decode()
        lines.append(f"{path},sha256={digest},{len(contents[path])}")
    return "\n".join([*lines, f"{name},,", ""]).encode()
