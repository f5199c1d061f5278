"""mesoshell.check_shell counts what is there, says it in a sentence and leaves it for the panel."""

import bpy
import numpy as np
import pytest
import scenes


@pytest.fixture
def check(part, map_file):
    """check(obj, **settings) -> the Report of a shell on it."""
    shells = part("host.shells")
    shells.forget()

    def run(obj, **settings):
        scenes.add_shell(obj, map_file, **{"thickness": 0.1} | settings)
        assert bpy.ops.mesoshell.check_shell(object=obj.name) == {'FINISHED'}
        return part("host.shell_checks").last_report(obj)
    return run


def test_a_flat_sheet_has_nothing_wrong(check, fresh):
    report = check(scenes.make_grid("Sheet", 4), tiles_u=2.0, tiles_v=2.0)
    assert report[1:6] == (32, 0, 0, 0, 0)
    assert report.worst_angle == pytest.approx(0.0, abs=1e-3)


def test_folds_are_counted_and_repaired(check, fresh):
    """Two walls of a narrow valley, whose prisms are twice as thick as it is wide."""
    xs = [-1.0, -0.1, 0.1, 1.0]
    places = [(x, y, 0.0 if abs(x) > 0.5 else -1.0) for y in (0.0, 1.0) for x in xs]
    faces = [[i, i + 1, i + 5, i + 4] for i in range(3)]
    valley = scenes.make_object("Valley", places, faces, np.array(places)[np.concatenate(faces)][:, :2])
    report = check(valley, thickness=0.8)
    assert report.folds > 0 and report.base_folds == 0
    assert f"{report.folds} fold" in report.sentence("Valley") and '"Valley"' in report.sentence("Valley")
    assert check(valley, thickness=0.8, repair=True).folds == 0


def test_a_surface_that_crosses_itself_is_told_apart(check, fresh):
    """Two quads through one another: thinner prisms do not help."""
    places = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (0, -0.5, -1), (0, 0.5, -1), (0, 0.5, 1), (0, -0.5, 1)]
    crossed = scenes.make_object("Crossed", places, [[0, 1, 2, 3], [4, 5, 6, 7]], [(0, 0), (1, 0), (1, 1), (0, 1)] * 2)
    report = check(crossed, thickness=0.01)
    assert report.base_folds == report.folds == 4


def test_cut_seams_are_counted(check, fresh):
    """A torus's seams are whole tiles apart, until half a tile is missing."""
    torus = scenes.make_torus("Ring", around=12, across=6)
    assert check(torus, tiles_u=4.0, tiles_v=2.0).cut_seams == 0
    assert check(torus, tiles_u=4.5, tiles_v=2.0).cut_seams == 6
    assert check(torus, tiles_u=4.5, tiles_v=2.5).cut_seams == 6 + 12


def test_uvs_without_area_are_counted(check, fresh):
    grid = scenes.make_grid("Sheet", 2)
    flat = np.empty(2 * len(grid.data.loops), np.float32)
    grid.data.uv_layers[0].data.foreach_get("uv", flat)
    flat[:8] = 0.5  # the first face's four corners
    grid.data.uv_layers[0].data.foreach_set("uv", flat)
    assert check(grid).without_area == 2


def test_reports_know_their_shell(check, part, fresh):
    grid = scenes.make_grid("Sheet", 2)
    report = check(grid)
    shells = part("host.shells")
    assert shells.drawn(grid)[1] == report.shell_version
    grid.mesoshell.thickness = 0.2
    shells.visible(bpy.context.evaluated_depsgraph_get())
    assert shells.drawn(grid)[1] != report.shell_version


def test_without_a_shell_there_is_a_sentence(fresh):
    scenes.make_grid("Sheet", 2)
    with pytest.raises(RuntimeError, match='"Sheet" has no shell'):
        bpy.ops.mesoshell.check_shell(object="Sheet")
