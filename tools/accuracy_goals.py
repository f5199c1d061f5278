"""What ./dev accuracy asks of each traversal, in one place, and whether it holds."""

from __future__ import annotations

from accuracy_measures import pooled

REALIZED_IOU = 0.998

# Of a picture's silhouettes and depths: name, key of Errors.figures, bound, whether it is the least that will do.
REFINED = (
    ("silhouette IoU", "iou", 0.999, True),
    ("mean depth error, voxels", "depth_mean", 0.03, False),
    ("hits within 1 voxel", "within_voxel", 0.999, True),
    ("mean angle between normals, degrees", "normal_mean", 2.0, False),
    ("the same on the tile's surface", "normal_surface", 2.0, False),
)
REFINED_BYTES = 4_000_000
REFINED_FETCHES = 0.5  # of those of sphere tracing at the same accuracy


def _goal(name, value, goal, holds):
    return {"name": name, "value": value, "goal": goal, "holds": bool(holds)}


def _bounded(name, value, bound, least):
    holds = value >= bound if least else value <= bound
    return _goal(name, round(value, 4), f"{'>=' if least else '<='} {bound:g}", holds)


def _everywhere(results, variant, text, key, bound, least):
    """Two goals: of all rays together, and of the scene that is farthest from it."""
    own = [r for r in results if r.variant == variant]
    together = pooled([r.errors for r in own]).figures()[key]
    worst = (min if least else max)(own, key=lambda r: r.errors.figures()[key])
    return [_bounded(f"{variant}: {text}, all rays", together, bound, least),
            _bounded(f"{variant}: {text}, worst scene ({worst.scene})", worst.errors.figures()[key], bound, least)]


def _accurate(figures):
    return all(figures[key] >= bound if least else figures[key] <= bound for _, key, bound, least in REFINED[:3])


def _against_sphere_tracing(name, rivals, figures):
    """Fetches over those of the cheapest sphere tracing that is as accurate as asked; if none is, of the nearest to it."""
    accurate = [n for n in rivals if _accurate(figures[n])]
    rival = min(accurate or rivals, key=lambda n: figures[n]["fetches"] if accurate else -figures[n]["iou"])
    text = f"{name}: fetches over those of {rival}" + ("" if accurate else ", which is less accurate than asked")
    return _bounded(text, figures[name]["fetches"] / figures[rival]["fetches"], REFINED_FETCHES, False)


def goals_of(results):
    """The goals of what was measured: a list of {"name", "value", "goal", "holds"}."""
    names = list(dict.fromkeys(r.variant for r in results))
    figures = {name: pooled([r.errors for r in results if r.variant == name]).figures() for name in names}
    size = {r.variant: r.data_bytes for r in results}
    goals = []
    if "realized" in names:
        goals += _everywhere(results, "realized", "silhouette IoU of the mesh against exact", "iou", REALIZED_IOU, True)
    for name in (n for n in names if n.split()[0] == "refined"):
        for text, key, bound, least in REFINED:
            goals += _everywhere(results, name, text, key, bound, least)
        goals.append(_bounded(f"{name}: bytes", size[name], REFINED_BYTES, False))
        rivals = [n for n in names if n.split()[0] == "sdf"]
        if rivals:
            goals.append(_against_sphere_tracing(name, rivals, figures))
    return goals
