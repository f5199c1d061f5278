"""Goals of ./dev accuracy: one bad scene among good ones fails, and so do fetches and bytes beyond their bounds."""

import accuracy_goals
import numpy as np
import pytest
from accuracy_measures import Errors
from accuracy_report import Result, table

GOOD = {"misses": 0, "depth": 0.01, "angle": 1.0, "fetches": 4}


def result(variant, base, *, misses, depth, angle, fetches, data_bytes=1_000_000):
    """1000 rays, of which 800 hit in the truth; depth and angle are the same everywhere."""
    hits = 800 - misses
    errors = Errors(rays=1000, hits=800, false_hits=0, false_misses=misses, depth=np.full(hits, depth),
                    angle=np.full(hits, angle), cut=np.zeros(hits, bool), fetches=1000 * fetches)
    return Result(variant, "chain", base, 35, errors, data_bytes)


def holding(results):
    """Name to whether it holds, the variant's name left out."""
    return {goal["name"].split(": ", 1)[1]: goal["holds"] for goal in accuracy_goals.goals_of(results)}


def test_all_hold_where_all_is_well():
    goals = holding([result("refined", "torus", **GOOD), result("sdf", "torus", **(GOOD | {"fetches": 9}))])
    assert len(goals) == 12 and all(goals.values())


@pytest.mark.parametrize("what, text", [({"misses": 4}, "silhouette IoU"), ({"depth": -0.2}, "mean depth error, voxels"),
                                        ({"depth": 1.1}, "hits within 1 voxel"),
                                        ({"angle": 5.0}, "mean angle between normals, degrees")])
def test_the_worst_scene_is_found(what, text):
    """In one of twenty scenes; all rays together may still be good enough."""
    scenes = [result("refined", f"base {k}", **GOOD) for k in range(19)] + [result("refined", "torus", **(GOOD | what))]
    goals = holding(scenes)
    assert not goals[f"{text}, worst scene (chain, torus, 35)"]
    assert goals["silhouette IoU, all rays"]


def test_fetches_are_compared_with_what_is_as_accurate():
    """The cheap distance field misses too much, so that the finer one is the measure."""
    refined = result("refined", "torus", **(GOOD | {"fetches": 6}))
    cheap = result("sdf", "torus", **(GOOD | {"fetches": 8, "misses": 40}))
    fine = result("sdf fine", "torus", **(GOOD | {"fetches": 13}))
    assert holding([refined, cheap, fine])["fetches over those of sdf fine"]
    assert not holding([refined, cheap])["fetches over those of sdf, which is less accurate than asked"]


def test_bytes_have_a_bound():
    assert not holding([result("refined", "torus", **GOOD, data_bytes=4_000_001)])["bytes"]


def test_the_mesh_is_held_to_its_silhouettes():
    assert all(holding([result("realized", "torus", **(GOOD | {"misses": 1}))]).values())
    assert not any(holding([result("realized", "torus", **(GOOD | {"misses": 2}))]).values())


def test_table_has_all_rays_together_and_the_worst_scene():
    row, = table([result("sdf", "torus", **(GOOD | {"misses": 80})), result("sdf", "planar", **GOOD)])
    assert row["iou"] == pytest.approx(1520 / 1600) and row["worst_iou"] == pytest.approx(0.9)
    assert row["fetches"] == 4 and row["bytes"] == 1_000_000
