"""How far a picture is from the truth: silhouettes, depths along the rays, normals, fetches. NumPy only, knows no renderer.

Pictures are dicts of arrays as mesoshell_native.render and trace return them: hit [h, w], distance [h, w] in object units,
normal [h, w, 3]; fetches, prism and texture where there are any.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

VOXELS = 64  # a tile's width, in the voxels that errors are quoted in
NEAR_SIDE = 1e-4  # in prism coordinates: what lies as near to a side of its prism lies on it


@dataclass(frozen=True)
class Errors:
    """What one picture, or several, have against the truth. Rays are those that meet the shell."""

    rays: int
    hits: int  # of the truth
    false_hits: int
    false_misses: int
    depth: np.ndarray  # voxels along the ray, positive where the picture's hit lies behind; one where both hit
    angle: np.ndarray  # degrees between the normals, likewise
    cut: np.ndarray  # bool, likewise: the truth hits what the slab or the shell's border cuts open, not the tile's surface
    fetches: int  # of all rays

    def figures(self):
        """The figures that are quoted, a dict of floats; shares are of 1."""
        both = self.hits - self.false_misses
        depth = np.abs(self.depth)
        some = len(depth) > 0

        def mean(values):
            return float(values.mean()) if len(values) else 0.0

        return {
            "iou": both / max(self.hits + self.false_hits, 1),
            "depth_mean": mean(depth),
            "depth_p99": float(np.quantile(depth, 0.99)) if some else 0.0,
            "depth_bias": mean(self.depth),
            "within_voxel": float((depth <= 1.0).mean()) if some else 1.0,
            "normal_mean": mean(self.angle),
            "normal_surface": mean(self.angle[~self.cut]),
            "normal_cut": mean(self.angle[self.cut]),
            "cut": float(self.cut.mean()) if some else 0.0,
            "misclassified": (self.false_hits + self.false_misses) / max(self.rays, 1),
            "false_hits": self.false_hits / max(self.rays, 1),
            "false_misses": self.false_misses / max(self.rays, 1),
            "fetches": self.fetches / max(self.rays, 1),
        }


def pooled(errors):
    """Several pictures as one: every ray counts alike."""
    return Errors(*(sum(getattr(e, name) for e in errors) for name in ("rays", "hits", "false_hits", "false_misses")),
                  *(np.concatenate([getattr(e, name) for e in errors]) for name in ("depth", "angle", "cut")),
                  sum(e.fetches for e in errors))


def depth_errors(picture, truth, pace):
    """Voxels along the ray [h, w], positive where the picture's hit lies behind the truth's; NaN unless both hit."""
    both = (picture["hit"] == 1) & (truth["hit"] == 1)
    error = np.full(both.shape, np.nan)
    difference = np.asarray(picture["distance"], float)[both] - np.asarray(truth["distance"], float)[both]
    error[both] = difference * pace[both] * VOXELS
    return error


def normal_angles(picture, truth):
    """Degrees between the normals, float64 [h, w]; NaN unless both hit."""
    both = (picture["hit"] == 1) & (truth["hit"] == 1)
    first, second = (np.asarray(p["normal"], float)[both] for p in (picture, truth))
    angle = np.full(both.shape, np.nan)
    # By both sine and cosine: an arc cosine alone has no digits left near 0.
    angle[both] = np.degrees(np.arctan2(np.linalg.norm(np.cross(first, second), axis=-1), (first * second).sum(axis=-1)))
    return angle


def compare(picture, truth, where, meets):
    """The Errors of a picture; `where` are the truth's Places, `meets` bool [h, w] the rays that meet the shell."""
    hit, true_hit = picture["hit"] == 1, truth["hit"] == 1
    both = hit & true_hit
    fetches = picture.get("fetches")
    return Errors(rays=int(meets.sum()), hits=int(true_hit.sum()), false_hits=int((hit & ~true_hit).sum()),
                  false_misses=int((~hit & true_hit).sum()), depth=depth_errors(picture, truth, where.pace)[both],
                  angle=normal_angles(picture, truth)[both], cut=where.cut[both],
                  fetches=0 if fetches is None else int(fetches.sum()))


@dataclass(frozen=True)
class Places:
    """Where a picture's rays hit, in their prisms: [h, w] each."""

    pace: np.ndarray  # tile widths that the ray passes within an object unit there, float64; NaN where it does not hit
    cut: np.ndarray  # bool: on a side of the prism, where the slab or the shell's border cuts the solid


def places(located, directions, prisms, height, aspect):
    """The Places of a picture with prism and texture.

    directions [h, w, 3] are unit vectors of object space, prisms [n, 8, 4] the shell's table. The local scale is the prism
    map's own: its inverse Jacobian at the hit, times the direction. Errors of many voxels are converted by the scale at that
    end all the same. Of hits within a shell, one in some thousands lies as near to a side by chance.
    """
    hit = located["hit"] == 1
    table = prisms[located["prism"][hit]].astype(float)
    corners = table[:, :6, :3].reshape(-1, 2, 3, 3)  # base and top, corner, axis
    uvs = np.stack([table[:, :6, 3], table[:, 6:].reshape(-1, 8)[:, :6]], -1).reshape(-1, 2, 3, 2)
    texture = located["texture"][hit].astype(float)
    w = texture[:, 2, None, None]
    points, tiles = (part[:, 0] + (part[:, 1] - part[:, 0]) * w for part in (corners, uvs))  # the triangle at height w
    point_edges, tile_edges = (np.stack([part[:, 1] - part[:, 0], part[:, 2] - part[:, 0]], -1) for part in (points, tiles))
    weights = np.linalg.solve(tile_edges, (texture[:, :2] - tiles[:, 0])[..., None])[..., 0]
    weights = np.concatenate([1.0 - weights.sum(axis=1, keepdims=True), weights], axis=1)
    point_rise, tile_rise = (((part[:, 1] - part[:, 0]) * weights[..., None]).sum(axis=1) for part in (corners, uvs))
    # Both maps are known by prism coordinates; tile widths over object units is one after the inverse of the other.
    jacobian = np.concatenate([point_edges, point_rise[..., None]], -1)
    along = np.linalg.solve(jacobian, directions[hit][..., None])[..., 0]
    across = (tile_edges @ along[:, :2, None])[..., 0] + tile_rise * along[:, 2:]
    metric = np.concatenate([across * (1.0, aspect), height * along[:, 2:]], axis=1)
    pace, cut = np.full(hit.shape, np.nan), np.zeros(hit.shape, bool)
    pace[hit] = np.linalg.norm(metric, axis=1)
    cut[hit] = np.minimum(weights.min(axis=1), np.minimum(texture[:, 2], 1.0 - texture[:, 2])) < NEAR_SIDE
    return Places(pace, cut)
