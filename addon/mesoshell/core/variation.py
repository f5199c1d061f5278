"""Breaks a tile's repetition: n x n copies, bent by a smooth random displacement that repeats only with all of them.

The displacement D is a sum of a few waves whose periods divide n tiles, so that no seam and no tear can appear. It is scaled
so that |D(p) - D(q)| <= amount * MOST_STRETCH * |p - q|: below 1, so that p + D(p) meets no place twice and misses none;
distances grow or shrink by no more than that share. Heights stay, and so does what lies over or under what.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from .refining import refined

MOST_STRETCH = 0.6
MOST_COPIES = 16  # a side
_WAVES = 16
_SHORTEST = 1.25  # tile widths of a wave; shorter ones bend what is in a tile more than they move it
_GRID = 256  # nodes a side on which slopes are measured
_LONGEST_EDGE = 1.0 / 16.0  # tile widths: a twentieth of the shortest wave
_MOST_TRIANGLES = 50_000_000


class Displacement(NamedTuple):
    """D over n x n tiles, in widths of one: the sum of `amplitudes` * cos(p . `frequencies` + `phases`)."""

    copies: int
    aspect: float
    frequencies: np.ndarray  # float64 [k, 2], radians a tile width
    amplitudes: np.ndarray  # float64 [k, 2], tile widths
    phases: np.ndarray  # float64 [k]

    def at(self, places):
        """D [n, 2] and its derivatives [n, 2, 2] (of component i along axis j) at places [n, 2], tile widths."""
        # The same to the bit where copies of a place lie.
        period = self.copies * np.array([1.0, self.aspect])
        places = places - np.floor(places / period) * period
        angle = places @ self.frequencies.T + self.phases
        slopes = np.empty((len(places), 2, 2))
        sine = np.sin(angle)
        for i in range(2):
            slopes[:, i] = -(sine * self.amplitudes[:, i]) @ self.frequencies
        return np.cos(angle) @ self.amplitudes, slopes


def displacement(copies, aspect, amount, seed):
    """A Displacement of n x n tiles; `amount` in [0, 1]."""
    random = np.random.default_rng(seed)
    limit = max(1, int(np.ceil(copies * max(1.0, aspect) / _SHORTEST)))
    waves = np.array([(i, j) for i in range(limit + 1) for j in range(-limit, limit + 1) if i > 0 or j > 0])
    # What repeats with every tile would break nothing.
    waves = waves[(waves % copies != 0).any(axis=1)]
    frequencies = 2 * np.pi * waves / (copies * np.array([1.0, aspect]))
    size = np.linalg.norm(frequencies, axis=1)
    least = np.sort(size)[min(3, len(size) - 1)]  # few copies have few waves that are long enough
    chosen = np.flatnonzero(size <= max(least * 1.0001, 2 * np.pi / _SHORTEST))
    chosen = chosen[np.argsort(random.random(len(chosen)))][:_WAVES]
    frequencies, size = frequencies[chosen], size[chosen]
    # Of all directions alike; long waves move farther, at the same slope.
    turn = 2 * np.pi * random.random(len(chosen))
    amplitudes = np.column_stack([np.cos(turn), np.sin(turn)]) * (0.5 + random.random(len(chosen)))[:, None] / size[:, None]
    shape = Displacement(copies, aspect, frequencies, amplitudes, 2 * np.pi * random.random(len(chosen)))
    return shape._replace(amplitudes=amplitudes * (amount * MOST_STRETCH / steepest(shape)))


def steepest(shape):
    """A bound of |D(p) - D(q)| / |p - q|: the greatest slope on a grid, and what it can grow by between nodes."""
    steps = np.arange(_GRID) / _GRID * shape.copies
    x, y = np.meshgrid(steps, steps * shape.aspect)
    slopes = shape.at(np.column_stack([x.ravel(), y.ravel()]))[1]
    bend = (np.linalg.norm(shape.amplitudes, axis=1) * np.linalg.norm(shape.frequencies, axis=1) ** 2).sum()
    to_node = 0.5 * shape.copies / _GRID * np.hypot(1.0, shape.aspect)
    return float(np.linalg.norm(slopes, axis=(1, 2)).max() + bend * to_node)


def varied(surface, copies, amount, seed):
    """The TileSurface of n x n copies, bent; its width is n of the given one's, and lengths are in those.

    One copy is the surface itself. `amount` 0 is plain repetition. ValueError for more copies than memory is likely to hold.
    """
    if not 1 <= copies <= MOST_COPIES or not 0.0 <= amount <= 1.0:
        raise ValueError(f"Variation of {copies} copies by {amount:g}: give 1 to {MOST_COPIES} copies a side, and 0 to 1")
    if copies == 1:
        return surface
    if amount > 0.0:
        surface = refined(surface, _LONGEST_EDGE)
    count = len(surface.triangles)
    if count * copies**2 > _MOST_TRIANGLES:
        raise ValueError(f'Tile "{surface.name}" with {count} triangles would have {count * copies**2} in {copies} × '
                         f"{copies} copies: give fewer copies, or a simpler tile")
    shape = displacement(copies, surface.aspect, amount, seed) if amount > 0.0 else None
    positions, triangles, normals = [], [], []
    for row in range(copies):
        for column in range(copies):
            moved, turned = _bent(surface, shape, np.array([column, row * surface.aspect, 0.0]))
            triangles.append(surface.triangles + np.int32(len(positions) * len(surface.positions)))
            positions.append(moved)
            normals.append(turned)
    source = np.tile(np.arange(count), copies**2)
    whole = surface.rebuilt(np.concatenate(positions) / copies, np.concatenate(triangles), source, corners=[0, 1, 2],
                            **({} if surface.normals is None else {"normals": np.concatenate(normals)}))
    notice = (f'Tile "{surface.name}" is {copies} × {copies} copies: its nodes are spread over all of them, and its period '
              f"is {copies} times as wide")
    return replace(whole, height=surface.height / copies, thickness=surface.thickness / copies,
                   notices=(*surface.notices, notice))


def _bent(surface, shape, offset):
    """Positions and corner normals of one copy, in widths of one tile."""
    positions = surface.positions + offset
    if shape is None:
        return positions, surface.normals
    moved, slopes = shape.at(positions[:, :2])
    positions[:, :2] += moved
    normals = surface.normals
    if normals is not None:
        # Planes map by the inverse transpose of what places map by.
        inverse = np.linalg.inv(np.eye(2) + slopes)[surface.triangles]
        flat = np.einsum("mcij,mci->mcj", inverse, normals[..., :2])
        normals = np.concatenate([flat, normals[..., 2:]], axis=-1)
        normals = (normals / np.linalg.norm(normals, axis=-1, keepdims=True)).astype(np.float32)
    return positions, normals
