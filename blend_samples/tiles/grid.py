"""A tile of a space frame, as pure geometry: two grids of tubes held apart by slanted tubes, with nothing in between.

The upper grid stands half a cell aside from the lower one, so that all tubes are equally long and the frame consists of
half octahedra and of tetrahedra. Each tube narrows to a bolt that ends within a ball; every ball and every tube is a closed
solid. Rays see far through the frame between struts three voxels of 1/64 thick.

Lengths are in tile widths.
"""

import numpy as np

from .tile import capped_tube, chance, make_tile, scaled

CELLS = 2  # of a grid, each way
SPACING = 1.0 / CELLS
BALL_RADIUS = 0.05
TUBE_RADIUS, BOLT_RADIUS = 0.024, 0.013
CONE = 0.032  # length of the part where a tube narrows
DEPTH = SPACING / np.sqrt(2.0)  # between the grids
FIRST = np.array([0.1372, 0.1171])  # the first lower ball: no node of a usual grid lies in a plane of symmetry
HEIGHT = 0.48  # the balls leave a margin of 0.013 on both sides

ZINC, GRAPHITE, SIGNAL_RED = (0.50, 0.51, 0.49), (0.085, 0.095, 0.11), (0.48, 0.045, 0.020)


def ball(center, sides):
    """A sphere of BALL_RADIUS: positions and triangles."""
    rings = max(2, sides // 2 - 1)
    polar = np.pi * (1.0 - np.arange(1, rings + 1) / (rings + 1))
    around = np.arange(sides) * (2 * np.pi / sides)
    ring = np.stack([np.outer(np.sin(polar), np.cos(around)), np.outer(np.sin(polar), np.sin(around)),
                     np.broadcast_to(np.cos(polar)[:, None], (rings, sides))], -1)
    return capped_tube(center + BALL_RADIUS * ring, center - [0, 0, BALL_RADIUS], center + [0, 0, BALL_RADIUS])


def tube(start, end, sides, rings):
    """A tube between the centers of two balls: positions and triangles. Each of its parts is divided into `rings`."""
    length = np.linalg.norm(end - start)
    axis = (end - start) / length
    side = np.cross(axis, [0.0, 1.0, 0.0] if abs(axis[1]) < 0.9 else [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    bolt, even = 0.8 * BALL_RADIUS, 1.25 * BALL_RADIUS + CONE
    half = [(bolt, BOLT_RADIUS), (1.25 * BALL_RADIUS, BOLT_RADIUS), (1.25 * BALL_RADIUS, 1.3 * BOLT_RADIUS), (even, TUBE_RADIUS)]
    profile = np.array(half + [(length - along, radius) for along, radius in reversed(half)])
    part = np.arange((len(profile) - 1) * rings + 1) / rings
    profile = np.stack([np.interp(part, np.arange(len(profile)), column) for column in profile.T], -1)
    around = np.arange(sides) * (2 * np.pi / sides)
    spoke = np.cos(around)[:, None] * side + np.sin(around)[:, None] * np.cross(axis, side)
    points = start + profile[:, :1, None] * axis + profile[:, 1:, None] * spoke
    return capped_tube(points, start + bolt / 2 * axis, end - bolt / 2 * axis)


def make(detail=1.0):
    """The space frame; triangles grow with the square of `detail`."""
    sides, rings, ball_sides = scaled(12, detail, 4), scaled(1, detail, 1), scaled(22, detail, 6)
    lower = (HEIGHT - DEPTH) / 2
    parts = []

    def add_tube(start, end, color):
        wear = 0.9 + 0.2 * chance(len(parts), 7)
        parts.append((*tube(np.array(start), np.array(end), sides, rings), np.multiply(color, wear)))

    for i in range(CELLS):
        for j in range(CELLS):
            # Each ball stands for itself and its copies, each tube starts at a ball of this tile.
            below = np.array([*(FIRST + np.array([i, j]) * SPACING), lower])
            above = below + [SPACING / 2, SPACING / 2, DEPTH]
            for center in (below, above):
                parts.append((*ball(center, ball_sides), SIGNAL_RED))
            for step in ([SPACING, 0, 0], [0, SPACING, 0]):
                add_tube(below, below + step, GRAPHITE)
                add_tube(above, above + step, ZINC)
            for x in (-1, 1):
                for y in (-1, 1):
                    add_tube(below, below + [x * SPACING / 2, y * SPACING / 2, DEPTH], ZINC)
    return make_tile("grid", parts, height=HEIGHT, roughness=0.4)
