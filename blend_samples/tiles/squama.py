"""A tile of horny scales, as pure geometry: thick, keeled plates that overlap like shingles and stand off the skin.

Every scale is a closed plate, broad at the root and rounded at the free edge. Its root sits in the skin, a closed layer; from there
it rises, over the roots of the next two rows, so that most of a scale and all of the skin lie in hollows beneath others.
Rows are offset by half a scale. A scale is a copy of one of VARIANTS templates, turned and scaled a little: placement() says how,
so that the same tile can be made of instances.

Lengths are in tile widths; roots lie toward +y, free edges toward -y.
"""

import numpy as np

from .tile import capped_tube, chance, make_tile, mix, noise, scaled, sheet, turned_about_z

ASPECT = 0.75
HEIGHT = 0.25
COLUMNS, ROWS = 4, 4  # of scales; an even number of rows, so that the offset repeats
VARIANTS = 3
LENGTH, WIDTH = 0.43, 0.226  # of a scale; neighbors in a row nearly touch
RISE = 0.20  # from a scale's root to its free edge
ARCH = 0.022  # by which its sides hang below its middle
KEEL = 0.016  # height of the ridge along its middle
THICKNESS = 0.024
SKIN_BOTTOM, SKIN_TOP = 0.012, 0.052

UMBER, OCHER, HORN, SKIN = (0.040, 0.022, 0.012), (0.30, 0.150, 0.045), (0.66, 0.50, 0.27), (0.05, 0.026, 0.020)


def width_at(along):
    """Half the width of a scale at `along` in (0, 1) from root to free edge: rounded at both ends, broadest at 0.42."""
    root = np.sqrt(np.maximum(1.0 - ((0.42 - along) / 0.42) ** 2, 0.0))
    tip = np.maximum(1.0 - ((along - 0.42) / 0.58) ** 2, 0.0) ** 0.72
    return WIDTH / 2 * np.where(along < 0.42, root, tip)


def template(variant, rings, sides):
    """A scale with its root at the origin, pointing to -y: positions [n, 3], triangles, colors [n, 3]."""
    along = (1.0 - np.cos(np.pi * np.arange(1, rings + 1) / (rings + 1))) / 2
    around = np.arange(sides) * (2 * np.pi / sides)
    half = width_at(along)[:, None]
    # Crowded toward the sides, where the cross-section, a flat lens, bends.
    across = half * np.cos(around)
    lens = np.sign(np.sin(around)) * np.abs(np.sin(around)) ** 0.7
    thin = THICKNESS / 2 * (1.0 - 0.45 * along[:, None] ** 2) * np.sqrt(half / (WIDTH / 2))
    keel = KEEL * np.exp(-((across / 0.022) ** 2)) * np.clip(lens, 0, 1) * np.sin(np.pi * along[:, None]) ** 0.6
    rise = RISE * (along - 0.12 * along**2) / 0.88
    z = rise[:, None] - ARCH * (across / (WIDTH / 2)) ** 2 + lens * thin + keel
    rings_at = np.stack([across, np.broadcast_to(-LENGTH * along[:, None], across.shape), z], -1)
    positions, triangles = capped_tube(rings_at, np.zeros(3), np.array([0.0, -LENGTH, RISE]))

    # Dark where it grows, paler with age, palest where it wears thin; growth lines across it, fibers along it.
    share = -positions[:, 1] / LENGTH
    sideways = np.abs(positions[:, 0]) / np.maximum(width_at(np.clip(share, 0.02, 0.98)), 1e-3)
    rim = np.clip(np.maximum((sideways - 0.78) / 0.22, (share - 0.88) / 0.12), 0.0, 1.0)
    fiber = noise(np.stack([positions[:, 0] / WIDTH + 0.5, 0.12 * share], -1), (9, 14), 40 + variant)
    # What the scales above leave to the light begins at 0.45; a dark flame runs down the middle from there.
    age = np.clip((share - 0.42) / 0.42 + 0.45 * sideways - 0.25, 0.0, 1.0)
    colors = mix(UMBER, OCHER, age) * (1.0 + 0.45 * fiber + 0.16 * np.sin(46.0 * share + variant))[:, None]
    colors = colors * (1.0 - 0.8 * rim[:, None]) + np.asarray(HORN) * (0.8 * rim[:, None])
    colors = colors * ((0.72, 1.0, 1.22)[variant], (0.70, 1.0, 1.12)[variant], (0.72, 1.0, 0.95)[variant])
    keel_light = np.exp(-((positions[:, 0] / 0.014) ** 2)) * np.clip((share - 0.5) / 0.3, 0.0, 1.0)
    return positions, triangles, np.clip(colors * (1.0 + 0.8 * keel_light[:, None]), 0.0, 0.85)


def placement():
    """Where the scales are: roots [n, 3], turns about z in radians [n], scales [n], variants int [n]."""
    row, column = (index.ravel() for index in np.meshgrid(np.arange(ROWS), np.arange(COLUMNS), indexing="ij"))
    roots = np.stack([(column + 0.25 + 0.5 * (row % 2)) / COLUMNS, (row + 0.5) * ASPECT / ROWS,
                      np.full(row.shape, 0.5 * (SKIN_BOTTOM + SKIN_TOP))], -1)
    roots[:, :2] += 0.008 * (np.stack([chance(row, column, 1), chance(row, column, 2)], -1) - 0.5)
    turns = 0.06 * (chance(row, column, 3) - 0.5)
    variants = np.floor(VARIANTS * chance(row, column, 5)).astype(int)
    return roots, turns, 0.96 + 0.06 * chance(row, column, 4), variants


def skin(detail):
    """The layer in which the scales root, as two sheets: parts for make_tile."""
    columns, rows = scaled(16, detail, 4), scaled(12, detail, 4)
    top, up = sheet(lambda p: SKIN_TOP - 0.008 + 0.007 * noise(p / [1.0, ASPECT], (8, 6), 9), rows, columns, ASPECT)
    bottom, down = sheet(lambda p: np.full(len(p), SKIN_BOTTOM), 4, 4, ASPECT, facing=-1)
    return [(top, up, SKIN), (bottom, down, SKIN)]


def resolution(detail):
    """Rings and sides of a scale."""
    return scaled(13, detail, 4), scaled(24, detail, 8, 4)


def make(detail=1.0):
    """The scales; triangles grow with the square of `detail`."""
    templates = [template(variant, *resolution(detail)) for variant in range(VARIANTS)]
    parts = skin(detail)
    for root, turn, scale, variant in zip(*placement()):
        positions, triangles, colors = templates[variant]
        parts.append((root + scale * turned_about_z(positions, np.array([turn]))[0], triangles, colors))
    return make_tile("squama", parts, height=HEIGHT, aspect=ASPECT, roughness=0.38)
