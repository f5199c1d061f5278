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
    states = {"nothing active", "a tile and a surface", "a bake that runs", "a bake that failed", "a shell"}
    sources = {"the selection", "a volume", "a collection that is mirrored", "an image that is varied",
               "an array that is blended", "a file of grids", "an object that can not be blended"}
    of_sources = {"MESOSHELL_PT_bake", "MESOSHELL_PT_bake_repetition"}
    names = of_sources | {"MESOSHELL_PT_bake_quality", "MESOSHELL_PT_shell"}
    expected = {(state, name) for state in states for name in names}
    expected |= {(state, name) for state in sources for name in of_sources}
    of_shells = {f"MESOSHELL_PT_shell{part}" for part in ("", "_surface", "_extrusion", "_placement", "_folds", "_overlays")}
    expected |= {(state, name) for state in ("a shell that was checked", "a shell under all overlays",
                                             "a shell that lost its map", "a shell without UVs") for name in of_shells}
    choices = {f"a shell whose part is {part}" for part in ('ALL', 'MATERIAL', 'VERTEX_GROUP', 'ATTRIBUTE')} | {
        "a shell whose refine is LENGTH", "a shell whose refine is SCREEN", "a shell whose subdivision is MODIFIER"}
    expected |= {(state, "MESOSHELL_PT_shell_surface") for state in choices}
    expected |= {(state, "MESOSHELL_PT_shell") for state in ("a surface without UVs", "a shell that fits its tile")}
    # Those that are open already are drawn in later states too.
    assert expected <= {tuple(pair) for pair in seen["drawn"]}
    # Blender prints what the layout itself refuses, such as a property that is not there.
    output = child.stdout + child.stderr
    assert "rna_uiItem" not in output and "Traceback" not in output, output[-3000:]
