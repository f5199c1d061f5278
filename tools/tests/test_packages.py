"""Packages: reproducible, complete, honest about what they need."""

import base64
import hashlib
import json
import os
import re
import subprocess
import tomllib

import bundle
import elf
import package
import pytest
import zips
from common import ADDON, BUILD, PYTHON, REPO, STAGE, Problem, version, wanted_packages


def test_private_names():
    assert bundle.private_name("libembree3.so.3") == "libembree3-mesoshell.so.3"
    assert bundle.private_name("libOpenEXR-3_1.so.30") == "libOpenEXR-3_1-mesoshell.so.30"


@pytest.mark.parametrize("name, minor", [("GLIBC_2.34", 34), ("GLIBC_2.2.5", 2), ("GLIBCXX_3.4.29", 34),
                                         ("GLIBCXX_3.4.30", 35), ("GLIBCXX_3.4", 17), ("CXXABI_1.3.13", 34),
                                         ("CXXABI_1.3", 17), ("GCC_3.0", 17)])
def test_oldest_policy(name, minor):
    assert bundle.oldest_policy(name) == minor


def test_a_symbol_of_an_unknown_future_is_refused():
    for name in ("GLIBCXX_3.4.99", "CXXABI_1.3.99", "GLIBC_PRIVATE"):
        with pytest.raises(Problem):
            bundle.oldest_policy(name)


def test_zip_bytes_depend_on_contents_only(tmp_path):
    contents = {"b.txt": b"2", "a/lib.so.3": b"1", "w.whl": b"3"}
    zips.write(tmp_path / "one.zip", contents)
    zips.write(tmp_path / "two.zip", dict(reversed(contents.items())))
    assert (tmp_path / "one.zip").read_bytes() == (tmp_path / "two.zip").read_bytes()
    assert zips.read(tmp_path / "one.zip") == contents


def test_folder_contents_follow_links_and_leave_out_litter(tmp_path):
    (tmp_path / "shaders").mkdir()
    (tmp_path / "shaders/a.glsl").write_text("a")
    (tmp_path / "addon/__pycache__").mkdir(parents=True)
    (tmp_path / "addon/__pycache__/x.pyc").write_text("")
    (tmp_path / "addon/.hidden").write_text("")
    (tmp_path / "addon/m.py").write_text("m")
    (tmp_path / "addon/shaders").symlink_to("../shaders")
    assert zips.folder_contents(tmp_path / "addon") == {"m.py": b"m", "shaders/a.glsl": b"a"}


def test_record_has_the_hash_of_every_other_file():
    record = zips.record({"a": b"x"}, "d/RECORD").decode().splitlines()
    digest = base64.urlsafe_b64encode(hashlib.sha256(b"x").digest()).decode().rstrip("=")
    assert record == [f"a,sha256={digest},1", "d/RECORD,,"]


def test_manifest_gets_its_wheel_before_the_first_table():
    manifest = tomllib.loads(package.manifest_with_wheel("x.whl").decode())
    assert manifest["wheels"] == ["./wheels/x.whl"] and "wheels" not in manifest["permissions"]
    assert manifest["version"] == version()


def test_stage_is_closed():
    """Every library is ours by a private name, or the system's; no build folder is left inside."""
    bundle.check(STAGE)
    tag = json.loads(bundle.RECORD.read_text())["platform_tag"]
    assert re.fullmatch(r"manylinux_2_\d\d_x86_64", tag)
    for path in STAGE.rglob("*.so*"):
        assert os.fsencode(BUILD) not in path.read_bytes(), f"{path.name} holds the path of the build folder"


def test_the_module_opens_its_core_privately():
    """A process that has another Embree's symbols already must not lend them to ours."""
    code = ("import ctypes, ctypes.util, sys\n"
            "ctypes.CDLL('libembree3.so.3', mode=ctypes.RTLD_GLOBAL)\n"
            "sys.path.insert(0, sys.argv[1])\nimport mesoshell_native as m\nprint(*m.libraries().values(), sep='\\n')")
    paths = subprocess.run([PYTHON, "-I", "-c", code, STAGE], check=True, capture_output=True, text=True).stdout.split()
    assert paths and all(p.startswith(str(STAGE)) for p in paths)


def test_patched_files_keep_their_version_needs():
    """The loader matches symbol versions by library name; a stale name there is an assertion in ld.so."""
    for path in (STAGE / bundle.LIBS).glob("*.so*"):
        found = elf.read(path)
        assert set(found.versions) <= set(found.needed) | {"ld-linux-x86-64.so.2"}


def test_package_table():
    for line in (REPO / "tools/packages.txt").read_text().splitlines():
        assert not line or line.startswith("#") or len(line.split(None, 2)) == 3, line
    assert "blender" in wanted_packages("root") and "g++" not in wanted_packages("root")


def test_versions_agree():
    assert package.check_version() == tomllib.loads((ADDON / "blender_manifest.toml").read_text())["version"]
