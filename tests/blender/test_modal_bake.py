"""The bake as a user runs it: from the event loop, in the background, until it ends or is cancelled.

Each test is a second Blender with a window; children/modal_bake.py is what runs in it.
"""

import json
import subprocess

import numpy as np
import pytest
import session

pytestmark = pytest.mark.window


def run(action, tmp_path):
    """What the child saw, and the names in the folder that it baked into."""
    folder, result = tmp_path / "bakes", tmp_path / "seen.json"
    folder.mkdir()
    child = subprocess.run(
        [*session.blender_arguments(), "--enable-event-simulate",
         "--python", str(session.ROOT / "tests" / "blender" / "children" / "modal_bake.py"), "--",
         action, str(folder), str(result)],
        env=session.blender_environment(), capture_output=True, text=True, errors="replace", timeout=240)
    output = child.stdout[-3000:] + child.stderr[-3000:]
    assert result.exists(), output
    seen = json.loads(result.read_text())
    assert seen["error"] is None and child.returncode == 0, f"{seen['error']}\n{output}"
    assert seen["answer"] == ["RUNNING_MODAL"] and seen["thread"]
    assert "Traceback" not in output, output
    return seen, {entry.name for entry in folder.iterdir()} - {"before.blend", "before.blend1"}


def assert_responsive(seen):
    """The event loop kept turning: without a thread, one gap would be as long as the bake."""
    gaps = np.diff(seen["ticks"])
    duration = seen["ticks"][-1] - seen["ticks"][0]
    assert gaps.max() < max(1.0, 0.3 * duration)
    assert len(gaps) > 10
    fractions = np.array(seen["fractions"][:-1])
    assert (np.diff(fractions) >= 0.0).all(), "progress never goes back"


def test_it_ends_and_saves(native, tmp_path):
    seen, files = run("finish", tmp_path)
    assert files == {"modal.gdm.exr"}
    assert not seen["failed"] and "SphereTile" in seen["report"]
    assert native.load(str(tmp_path / "bakes" / "modal.gdm.exr")).terms == 4
    assert seen["ticks"][-1] - seen["ticks"][0] > 1.0, "too quick to tell whether Blender stayed responsive"
    assert len(set(seen["fractions"])) > 10
    assert_responsive(seen)


@pytest.mark.parametrize("action", ["esc", "button"])
def test_it_can_be_cancelled(tmp_path, action):
    seen, files = run(action, tmp_path)
    assert files == set(), "nothing is saved, not even half of it"
    assert "cancelled" in seen["report"] and not seen["failed"]
    assert seen["jobs_left"] == 0
    assert max(seen["fractions"][:-1]) < 0.9 and seen["ended_at"] - seen["acted_at"] < 3.0, "it ended, and was not cancelled"


def test_undo_meanwhile_is_safe(tmp_path):
    seen, files = run("undo", tmp_path)
    assert seen["undone"] == pytest.approx(3.0), "undo did its work"
    assert files == {"modal.gdm.exr"} and not seen["failed"]


def test_opening_a_file_meanwhile_cancels_it(tmp_path):
    seen, files = run("load", tmp_path)
    assert files == set()
    assert "cancelled" in seen["report"]
    assert seen["jobs_left"] == 0


def test_disabling_the_addon_meanwhile_cancels_it(tmp_path):
    seen, files = run("disable", tmp_path)
    assert files == set()
    assert seen["jobs_left"] == 0


def test_quitting_meanwhile_leaves_nothing(tmp_path):
    seen, files = run("quit", tmp_path)
    assert seen["acted_at"] is not None
    assert files == set()
