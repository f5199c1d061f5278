"""./dev accuracy --quick from end to end: what it writes is complete, and the truths agree."""

import json

import accuracy
import accuracy_goals
import accuracy_maps
import accuracy_measures
import accuracy_scenes
import numpy as np
import pytest
from common import Problem
from test_accuracy_sheet import read_png

FIGURES = {"iou", "depth_mean", "depth_p99", "depth_bias", "within_voxel", "normal_mean", "normal_surface", "normal_cut",
           "cut", "misclassified", "false_hits", "false_misses", "fetches"}


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    out = tmp_path_factory.mktemp("accuracy") / "accuracy.json"
    accuracy.main(["--quick", "--out", str(out)])
    return json.loads(out.read_text()) | {"folder": out.parent}


def test_report_is_complete(report):
    measured = [name for name in accuracy.native.TRAVERSALS if name != "exact"]
    assert [row["variant"] for row in report["table"]] == ["realized", *measured]
    assert len(report["scenes"]) == len(report["table"])
    for row in report["table"] + report["scenes"]:
        assert set(row) >= FIGURES and all(np.isfinite(row[key]) for key in FIGURES)
        assert row["variant"] == "realized" or (row["bytes"] > 0 and row["fetches"] > 1)
    assert {"name", "value", "goal", "holds"} == set(report["goals"][0])


def test_contact_sheet_is_a_picture(report):
    image = read_png(report["folder"] / "accuracy.png")
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 100
    assert image.shape[1] > 96 * (1 + 2 * len(accuracy.native.TRAVERSALS) - 2)


def test_truths_agree_and_traversals_keep_what_they_have(report):
    rows = {row["variant"]: row for row in report["table"]}
    realized = rows["realized"]
    assert realized["iou"] >= accuracy_goals.REALIZED_IOU
    assert realized["within_voxel"] > 0.998 and realized["depth_mean"] < 0.05 and realized["normal_mean"] < 1.0
    assert rows["sdf"]["iou"] > 0.997 and rows["sdf"]["within_voxel"] > 0.95
    assert rows["gdm"]["iou"] < rows["sdf"]["iou"] < rows["realized"]["iou"]


@pytest.mark.parametrize("base", accuracy_scenes.BASES)
@pytest.mark.parametrize("elevation", accuracy_scenes.ELEVATIONS)
def test_rays_are_off_the_grid(base, elevation):
    """Where the rays enter the shell has nothing to do with the nodes of a grid, and neither have their directions."""
    tile = accuracy.tiles.make("chain", 0.2)
    sample = accuracy_maps.sample_of(accuracy.native, tile)
    shell = accuracy_scenes.BASES[base](tile).shell(accuracy.native)
    clip = accuracy_scenes.view_of(shell, elevation)
    a_map = accuracy.native.compress(accuracy.native.bake_gdm(sample, resolution=(8, 8, 4), directions=(4, 4)), terms=1,
                                     sdf=accuracy.native.bake_sdf(sample, resolution=(16, 16, 9)))
    seen = accuracy.native.render(shell, a_map, clip_from_object=clip, size=(96, 96), traversal="sdf")
    for nodes in (64, 128):
        assert accuracy_scenes.off_grid(seen["texture"][seen["hit"] == 1], nodes) == pytest.approx(1.0, abs=0.08)
    directions = accuracy_scenes.ray_directions(clip, (96, 96)).reshape(-1, 3)
    assert len(np.unique(np.round(directions, 6), axis=0)) > 9000
    # The picture is as large as it can be.
    meets = accuracy_scenes.shell_mask(accuracy.native, shell, clip, (96, 96))
    assert meets.any(axis=0).sum() > 90 or meets.any(axis=1).sum() > 90


def test_a_tile_width_is_as_long_as_said():
    """On the plane a tile width is an object unit, whatever the way of a ray."""
    tile = accuracy.tiles.make("weave", 0.2)
    shell = accuracy_scenes.planar(tile).shell(accuracy.native)
    random = np.random.default_rng(3)
    prism = random.integers(0, shell.prism_count, 50)
    uvs = np.stack([shell.prisms[prism, :3, 3], shell.prisms[prism, 6, :3]], -1)
    texture = np.concatenate([uvs.mean(axis=1), random.uniform(0.1, 0.9, (50, 1))], axis=1)
    directions = random.normal(size=(1, 50, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    located = {"hit": np.ones((1, 50), np.uint8), "prism": prism[None], "texture": texture[None]}
    where = accuracy_measures.places(located, directions, shell.prisms, tile.height, tile.aspect)
    np.testing.assert_allclose(where.pace, 1.0, rtol=1e-4)


def test_unknown_names_are_refused():
    with pytest.raises(Problem, match="there is no tile chainmail; there are weave"):
        accuracy.parse(["--tiles", "chainmail"])
