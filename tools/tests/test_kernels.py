"""The objects of native/simd: nothing but their table of kernels may be seen, and nothing may run when they are loaded."""

import subprocess

import pytest
from common import NATIVE_BUILD


@pytest.mark.parametrize("name", ["baseline", "avx2", "avx512"])
def test_only_the_table_is_visible(name):
    """An inline function left visible could replace the program's own, which older processors run too."""
    objects = list(NATIVE_BUILD.rglob(f"kernels_{name}.o"))
    assert len(objects) == 1
    symbols = subprocess.run(["nm", "--defined-only", "--extern-only", objects[0]], check=True, capture_output=True, text=True)
    assert [line.split()[-1] for line in symbols.stdout.splitlines()] == [f"mesoshell_kernels_{name}"]


@pytest.mark.parametrize("name", ["baseline", "avx2", "avx512"])
def test_nothing_runs_at_load(name):
    """A global constructor would run before the processor is asked what it has."""
    path = next(NATIVE_BUILD.rglob(f"kernels_{name}.o"))
    sections = subprocess.run(["readelf", "--section-headers", "--wide", path], check=True, capture_output=True, text=True).stdout
    assert ".text" in sections
    assert "init_array" not in sections and ".ctors" not in sections


def test_newer_instructions_stay_in_their_object():
    """The rest of the program is for any x86-64: no wide register outside the objects that are named after one."""
    objects = [path for path in NATIVE_BUILD.rglob("*.cpp.o") if "kernels_avx" not in str(path) and "native/tests" not in str(path)
               and "bench" not in str(path)]
    assert len(objects) > 10
    for path in objects:
        code = subprocess.run(["objdump", "--disassemble", "--no-show-raw-insn", path], check=True, capture_output=True, text=True)
        assert "%ymm" not in code.stdout and "%zmm" not in code.stdout, path
