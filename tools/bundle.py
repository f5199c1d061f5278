"""Stages the native module with every library it needs, under private names: build/native -> build/stage.

    build/stage/mesoshell_native.abi3.so          what Python imports; opens the next by path
    build/stage/mesoshell_native.libs/libmesoshell.so, libembree3-mesoshell.so.3, …, licenses/

Blender links Embree, TBB, OpenSubdiv and OpenEXR too. The loader takes a library that is already loaded for any later
request of the same soname, so ours get sonames of their own. The source tree, the tests and the packages all use this
folder: one binary.
"""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import elf
from common import NATIVE_BUILD, PYTHON, STAGE, Problem, guard, output, replaced_file, replaced_folder

MODULE = "mesoshell_native.abi3.so"
CORE = "libmesoshell.so"
LIBS = "mesoshell_native.libs"
RECORD = STAGE.with_name("stage.json")

# Taken from the machine: glibc, GCC's runtime, and zlib, which manylinux allows too and whose ABI has not moved in
# twenty years.
SYSTEM = {"libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "ld-linux-x86-64.so.2",
          "libgcc_s.so.1", "libstdc++.so.6", "libz.so.1"}

# manylinux_2_XX (XX first) and the newest GLIBCXX that it allows, as in auditwheel's table.
POLICIES = [(28, (3, 4, 24)), (31, (3, 4, 28)), (34, (3, 4, 29)), (35, (3, 4, 30)), (38, (3, 4, 32)), (39, (3, 4, 33))]

# CXXABI_1.3.XX and the GLIBCXX of the same libstdc++.
CXXABI = {8: (3, 4, 20), 9: (3, 4, 21), 10: (3, 4, 22), 11: (3, 4, 24), 12: (3, 4, 26), 13: (3, 4, 29), 14: (3, 4, 31),
          15: (3, 4, 33)}


def built(name: str) -> Path:
    """The file that the C++ build left, wherever below build/native."""
    for path in (NATIVE_BUILD / name, NATIVE_BUILD / LIBS / name, *sorted(NATIVE_BUILD.glob(f"*/{name}"))):
        if path.is_file():
            return path
    raise Problem(f"build/native has no {name}; run ./dev build")


def private_name(soname: str) -> str:
    """libembree3.so.3 -> libembree3-mesoshell.so.3"""
    stem, dot_so, rest = soname.partition(".so")
    return f"{stem}-mesoshell{dot_so}{rest}"


def fingerprint(inputs: list[Path]) -> str:
    """Changes whenever an input file does (by size and time; the inputs are compilers' outputs and Debian's files)."""
    lines = [f"{p} {p.stat().st_size} {p.stat().st_mtime_ns}" for p in inputs]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def up_to_date(module: Path, core: Path) -> bool:
    """True if build/stage was made of exactly these files."""
    try:
        record = json.loads(RECORD.read_text())
        inputs = [Path(p) for p in record["inputs"]]
        return (STAGE / LIBS / CORE).is_file() and inputs[:2] == [module, core] \
            and fingerprint(inputs) == record["fingerprint"]
    except (OSError, ValueError, KeyError):
        return False


def debian_package(library: Path) -> str:
    """The Debian package that owns a file; either of the two paths of a merged /usr may be the recorded one."""
    real = library.resolve()
    for path in (library, real, Path("/usr" + str(real)), Path(str(real).removeprefix("/usr"))):
        done = subprocess.run(["dpkg-query", "-S", str(path)], capture_output=True, text=True)
        if done.returncode == 0:
            return done.stdout.split(":")[0]
    raise Problem(f"no Debian package owns {library}, so its license is unknown; build against Debian's libraries")


def add_licenses(folder: Path, libraries: dict[str, Path]) -> None:
    """Copies the license texts of the bundled libraries, with a list of what comes from where."""
    folder.mkdir()
    lines = ["Libraries bundled with mesoshell_native, as Debian built them; only their names inside were changed.", ""]
    for soname, path in sorted(libraries.items()):
        package = debian_package(path)
        text = Path("/usr/share/doc") / package / "copyright"
        if not text.is_file():
            raise Problem(f"{text} is missing, so {soname} cannot be bundled; reinstall the package {package}")
        shutil.copyfile(text, folder / f"{package}.txt")
        # Debian's texts only point to the common licenses.
        for common in re.findall(r"/usr/share/common-licenses/([\w.-]*\w)", text.read_text(errors="replace")):
            shutil.copyfile(Path("/usr/share/common-licenses") / common, folder / f"{common}.txt")
        about = output(["dpkg-query", "-W", "-f", "${source:Package} ${source:Version}", package]).splitlines()[0]
        lines.append(f"{private_name(soname)}: Debian source package {about}, license in {package}.txt")
    (folder / "README.txt").write_text("\n".join(lines) + "\n")


def copy_all(target: Path, module: Path, core: Path, libraries: dict[str, Path]) -> None:
    """Fills the stage: copies, renames, strips."""
    libs = target / LIBS
    libs.mkdir()
    renamed = {soname: private_name(soname) for soname in libraries}
    for source, path, soname in [(module, target / MODULE, ""), (core, libs / CORE, CORE),
                                 *((libraries[s], libs / renamed[s], renamed[s]) for s in sorted(libraries))]:
        shutil.copyfile(source, path)
        path.chmod(0o755)
        elf.rewrite(path, soname=soname, runpath="$ORIGIN", renamed=renamed)
    add_licenses(libs / "licenses", libraries)


def check(target: Path) -> None:
    """Reads the staged files back: nothing may be found by luck."""
    objects = [target / MODULE, *sorted((target / LIBS).glob("*.so*"))]
    ours = {p.name for p in objects[1:]}
    for path in objects:
        found = elf.read(path)
        if found.runpath != "$ORIGIN":
            raise Problem(f"{path.name} has the RUNPATH '{found.runpath}' in place of $ORIGIN; is patchelf older than 0.14?")
        if path.name in ours and found.soname != path.name:
            raise Problem(f"{path.name} calls itself {found.soname}; is patchelf older than 0.14?")
        for name in {*found.needed, *found.versions} - SYSTEM - ours:
            raise Problem(f"{path.name} still needs {name} from outside the bundle; this is a mistake in tools/bundle.py")
    if set(elf.read(objects[0]).needed) & ours:
        raise Problem(f"{MODULE} is linked to {CORE}; it must open it with dlopen, by path and RTLD_LOCAL")


def platform_tag(target: Path) -> tuple[str, list[str]]:
    """The wheel's platform tag, as old as the symbol versions allow, and what keeps it from being older."""
    needs: dict[str, int] = {}  # symbol version -> XX of the manylinux_2_XX that it asks for
    where: dict[str, list[str]] = {}
    for path in [target / MODULE, *sorted((target / LIBS).glob("*.so*"))]:
        for name in set().union(*elf.read(path).versions.values()):
            needs[name] = oldest_policy(name)
            where.setdefault(name, []).append(path.name)
    minor = max(needs.values(), default=17)
    return f"manylinux_2_{minor}_x86_64", [f"because {', '.join(where[n])} need {n}" for n in needs if needs[n] == minor]


def oldest_policy(symbol_version: str) -> int:
    """XX of the oldest manylinux_2_XX that allows a symbol version such as GLIBC_2.34 or GLIBCXX_3.4.29."""
    library, _, number = symbol_version.partition("_")
    try:
        parts = tuple(int(n) for n in number.split("."))
    except ValueError:  # GLIBC_PRIVATE and the like
        raise Problem(f"a library needs the unstable symbol version {symbol_version}; it cannot be bundled") from None
    if library == "GLIBC":
        return parts[1]
    if library == "CXXABI":
        library, parts = "GLIBCXX", CXXABI.get((*parts, 0)[2], (3, 4) if (*parts, 0)[2] < 8 else (9,))
    if library == "GLIBCXX":
        minor = next((m for m, allowed in POLICIES if allowed >= parts), None)
        if minor is None:
            raise Problem(f"no manylinux policy allows {symbol_version}; build on an older Debian, or add it to the tables "
                          "of tools/bundle.py")
        return 17 if parts <= (3, 4, 19) else minor
    return 17  # GCC_3.0 and zlib's are older than any Blender


def try_import(target: Path) -> str:
    """Imports the staged module in a bare Python, and makes sure that every bundled function is our own."""
    code = ("import sys, json; sys.path.insert(0, sys.argv[1]); import mesoshell_native as m; "
            "print(json.dumps([m.__version__, m.libraries()]))")
    module_version, libraries = json.loads(output([PYTHON, "-I", "-c", code, target]))
    for name, path in libraries.items():
        if Path(path).resolve().parent != (target / LIBS).resolve():
            raise Problem(f"a function of {name} comes from {path}, not from the bundle; this is a mistake in "
                          "tools/bundle.py or native/python")
    return module_version


def main() -> int:
    module, core = built(MODULE), built(CORE)
    if up_to_date(module, core):
        return 0
    libraries = {s: p for s, p in elf.resolve(core).items() if s not in SYSTEM}
    with replaced_folder(STAGE) as target:
        copy_all(target, module, core, libraries)
        check(target)
        tag, why = platform_tag(target)
        module_version = try_import(target)
    inputs = [module, core, *libraries.values(), *(Path(__file__).with_name(n) for n in ("bundle.py", "elf.py"))]
    with replaced_file(RECORD) as path:
        path.write_text(json.dumps({"inputs": [str(p) for p in inputs], "fingerprint": fingerprint(inputs),
                                    "platform_tag": tag, "version": module_version}, indent=1))
    size = sum(p.stat().st_size for p in STAGE.rglob("*") if p.is_file())
    print(f"staged mesoshell_native {module_version} with {len(libraries)} libraries, {size / 1e6:.0f} MB, {tag}")
    for line in why:
        print(f"  {line}")
    return 0


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    guard(main)
