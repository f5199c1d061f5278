"""Every panel draws in every state; a second Blender shows them, children/panels.py is what runs in it."""

import json
import subprocess

import pytest
import session


@pytest.mark.window
def test_panels_draw_in_every_state(native, map_file, tmp_path):
    result = tmp_path / "panels.json"
    child = subprocess.run(
        [*session.blender_arguments(), "--python", str(session.ROOT / "tests" / "blender" / "children" / "panels.py"), "--",
         str(map_file), str(tmp_path), str(result)],
        env=session.blender_environment(), capture_output=True, text=True, errors="replace", timeout=240)
    assert result.exists(), child.stdout[-3000:] + child.stderr[-3000:]
    seen = json.loads(result.read_text())
    assert not seen["errors"], "\n".join(seen["errors"][0])
    states = {"nothing active", "a tile and a surface", "a bake that runs", "a bake that failed", "a shell",
              "a shell that lost its map"}
    sources = {"the selection", "a volume", "a collection that is mirrored", "an image that is varied",
               "an array that is blended", "a file of grids", "an object that can not be blended"}
    of_sources = {"MESOSHELL_PT_bake", "MESOSHELL_PT_bake_repetition"}
    names = of_sources | {"MESOSHELL_PT_bake_quality", "MESOSHELL_PT_shell"}
    expected = {(state, name) for state in states for name in names}
    expected |= {(state, name) for state in sources for name in of_sources}
    # Those that are open already are drawn in later states too.
    assert expected <= {tuple(pair) for pair in seen["drawn"]}
    # Blender prints what the layout itself refuses, such as a property that is not there.
    output = child.stdout + child.stderr
    assert "rna_uiItem" not in output and "Traceback" not in output, output[-3000:]
