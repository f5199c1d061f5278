"""A tile of fur, as pure geometry: thin, slanted hairs that taper to a point, rooted in a skin.

Every hair is a closed, three-sided tube along an arc; at its root it is two voxels of 1/64 thick, at its tip it has no thickness.
A hair is a copy of one of VARIANTS templates, turned about the vertical, scaled and tinted: placement() says how, so that the
same tile can be made of instances. The hairs of a tuft point the same way. Hairs may cross.

Lengths are in tile widths; the coat is combed toward +x.
"""

import numpy as np

from .tile import capped_tube, chance, make_tile, mix, noise, scaled, sheet, turned_about_z

HEIGHT = 0.5625  # hairs end 0.02 below it
HAIRS = 19  # each way, at detail 1
VARIANTS = 3
LENGTH = 0.66
RADIUS = 0.0145  # at the root, at detail 1
LEAN = np.radians([(20.0, 62.0), (26.0, 74.0), (32.0, 66.0)])  # from the vertical at root and tip, of each template
SKIN_BOTTOM, SKIN_TOP = 0.012, 0.034

RUSSET, FAWN, CREAM, SOOT = (0.36, 0.125, 0.030), (0.56, 0.27, 0.085), (0.80, 0.66, 0.46), (0.075, 0.035, 0.018)
SKIN = (0.16, 0.075, 0.045)


def template(variant, segments, sides, radius):
    """A hair with its root at the origin, leaning to +x: positions [n, 3], triangles, shades [n] from root to tip."""
    share = np.arange(segments + 1) / segments
    root, tip = LEAN[variant]
    # The axis is an arc: its lean grows evenly along it.
    lean = root + (tip - root) * share
    across = LENGTH * (np.cos(root) - np.cos(lean)) / (tip - root)
    up = LENGTH * (np.sin(lean) - np.sin(root)) / (tip - root)
    around = np.arange(sides) * (2 * np.pi / sides)
    thickness = radius * (1.0 - share[:-1]) ** 0.75
    sideways, outward = np.outer(thickness, np.sin(around)), np.outer(thickness, np.cos(around))
    lean = lean[:-1, None]
    rings = np.stack([across[:-1, None] + outward * np.cos(lean), sideways, up[:-1, None] - outward * np.sin(lean)], -1)
    positions, triangles = capped_tube(rings, np.zeros(3), np.array([across[-1], 0.0, up[-1]]))
    return positions, triangles, np.concatenate([np.repeat(share[:-1], sides), [0.0, 1.0]])


def hair_color(tint, share):
    """Linear RGB of a hair of that tint [n, 3] at `share` [m] from root to tip: float64 [n, m, 3]."""
    dark = 0.22 + 0.78 * np.clip(share / 0.6, 0.0, 1.0)
    return tint[:, None] * dark[:, None] ** np.array([1.0, 1.15, 1.3])


def placement(detail=1.0):
    """Where the hairs are: roots [n, 3], turns about z in radians [n], scales [n], variants int [n], tints [n, 3]."""
    count = scaled(HAIRS, np.sqrt(detail), 4)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(count), np.arange(count), indexing="ij"))
    places = np.stack([i + 0.15 + 0.7 * chance(i, j, 1), j + 0.15 + 0.7 * chance(i, j, 2)], -1) / count
    roots = np.concatenate([places, np.full((len(i), 1), 0.5 * (SKIN_BOTTOM + SKIN_TOP))], -1)
    tuft = noise(places, (5, 5), 3)
    turns = 0.55 * tuft + 0.5 * (chance(i, j, 4) - 0.5)
    scales = 0.80 + 0.12 * noise(places, (4, 4), 6) + 0.16 * chance(i, j, 5)
    variants = np.floor(VARIANTS * chance(i, j, 7)).astype(int)
    tints = mix(RUSSET, FAWN, np.clip(0.5 + 0.6 * noise(places, (3, 3), 8) + 0.5 * (chance(i, j, 9) - 0.5), 0.0, 1.0))
    kind = chance(i, j, 10)[:, None]
    tints = np.where(kind < 0.10, np.asarray(CREAM), np.where(kind > 0.94, np.asarray(SOOT), tints))
    return roots, turns, scales, variants, tints * (0.85 + 0.3 * chance(i, j, 11)[:, None])


def skin(detail):
    """The layer in which the hairs root, as two sheets: parts for make_tile."""
    cells = scaled(12, detail, 4)
    top, up = sheet(lambda p: SKIN_TOP - 0.003 + 0.003 * noise(p, (6, 6), 12), cells, cells, 1.0)
    bottom, down = sheet(lambda p: np.full(len(p), SKIN_BOTTOM), 4, 4, 1.0, facing=-1)
    return [(top, up, SKIN), (bottom, down, SKIN)]


def resolution(detail):
    """Segments, sides and radius of a hair."""
    return scaled(5, np.sqrt(detail), 2), scaled(3, np.sqrt(detail), 3), RADIUS / np.sqrt(detail)


def make(detail=1.0):
    """The fur; triangles grow with the square of `detail`, half of that by more, thinner hairs."""
    templates = [template(variant, *resolution(detail)) for variant in range(VARIANTS)]
    parts = skin(detail)
    roots, turns, scales, variants, tints = placement(detail)
    for variant, (positions, triangles, shades) in enumerate(templates):
        own = np.flatnonzero(variants == variant)
        placed = roots[own, None] + scales[own, None, None] * turned_about_z(positions, turns[own])
        numbers = triangles + len(positions) * np.arange(len(own))[:, None, None]
        parts.append((placed.reshape(-1, 3), numbers.reshape(-1, 3), hair_color(tints[own], shades).reshape(-1, 3)))
    return make_tile("fur", parts, height=HEIGHT, roughness=0.5)
