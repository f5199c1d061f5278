"""Machines: paths as a root sees them, and an environment that is made, not inherited."""

import subprocess
from pathlib import Path

import pytest
from common import Problem, replaced_file, replaced_folder
from machines import Here, Root, mounts_below


def test_paths_in_a_root():
    root = Root("sid", Path("/r/sid"), {Path("/repo"): ("/mesoshell/source", False),
                                        Path("/repo/build/out"): ("/mesoshell/out", True)})
    assert root.inside(Path("/repo/a.py")) == Path("/mesoshell/source/a.py")
    assert root.inside(Path("/repo/build/out/x.xml")) == Path("/mesoshell/out/x.xml")
    assert root.inside(Path("/r/sid/usr/bin")) == Path("/usr/bin")
    with pytest.raises(Problem):
        root.inside(Path("/elsewhere"))


def test_here_sees_only_what_it_is_given(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", "/somewhere")
    monkeypatch.delenv("PYTEST_ADDOPTS", raising=False)
    monkeypatch.delenv("CI", raising=False)
    done = subprocess.run(Here().command(["env"], {"A": "b c"}), capture_output=True, text=True, check=True)
    assert sorted(done.stdout.splitlines()) == ["A=b c", "LANG=C.UTF-8", "PATH=/usr/sbin:/usr/bin:/sbin:/bin"]


def test_mounts_below():
    assert mounts_below(Path("/")) and not mounts_below(Path("/nowhere"))


def test_a_failed_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(RuntimeError), replaced_file(path) as temporary:
        temporary.write_text("half")
        raise RuntimeError
    assert path.read_text() == "old" and list(tmp_path.iterdir()) == [path]


def test_a_failed_stage_leaves_the_old_folder(tmp_path):
    folder = tmp_path / "stage"
    folder.mkdir()
    (folder / "old").touch()
    with pytest.raises(RuntimeError), replaced_folder(folder) as fresh:
        (fresh / "half").touch()
        raise RuntimeError
    assert [p.name for p in folder.iterdir()] == ["old"] and list(tmp_path.iterdir()) == [folder]
