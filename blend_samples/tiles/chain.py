"""A tile of European 4-in-1 chain mail, as pure geometry: NumPy only, no bpy.

The mail is a sheet of equal rings. Rows run along u. The rings of a row lean all one way, over each other like
shingles and without touching; the rings of the next row lean the other way and pass through them: every ring is linked
with two rings of the row before and two of the row after, and with no other.

Lengths are in tile widths: the tile is the unit square times HEIGHT, two rings by two rows. The numbers below come
from a search over (pitch, row distance, two tilts) for the thickest wire that keeps exactly those four links. The free
optimum leans the rings by 34.3 degrees, pitch and row distance being equal, with a wire radius of 0.093, but makes a
sheet 0.64 thick; the numbers here give up a sixth of the wire for a quarter of the thickness. At this lean the best ring
radius is 0.39: to either side of it another pair of rings becomes the closest, and the distance falls.

    distance between center circles, the least over all pairs of the infinite sheet    0.1695   (2.17 wire radii)
    gap left between two wires                                                         0.0135   (0.9 voxels of 1/64)
    inner diameter of a ring over the diameter of its wire                             4.0
    thickness of the sheet, 2 (RING_RADIUS sin LEAN + WIRE_RADIUS)                     0.473
"""

import numpy as np

from .tile import chance, make_tile, scaled, snap

PERIOD = (1.0, 1.0)  # the tile's size along u and v
HEIGHT = 0.5  # the sheet is 0.473 thick and lies in the middle: nothing is clipped, a free margin of 0.013 on both sides
RING_RADIUS = 0.39  # of the circle in the middle of the wire
WIRE_RADIUS = 0.078  # a wire is 10 voxels of 1/64 across
LEAN = np.radians(24.0)  # between a ring's axis and +w, about v; the rows alternate in its sign
CENTERS = np.array([[0.25, 0.25], [0.75, 0.25], [0.0, 0.75], [0.5, 0.75]])  # (u, v) of the four rings
ROW_SIGN = np.array([1.0, 1.0, -1.0, -1.0])  # which way each of them leans
STEEL, BRASS = (0.47, 0.48, 0.50), (0.60, 0.38, 0.12)  # of the two rows


def torus(major_radius, minor_radius, segments, sides):
    """A closed torus about the z axis: positions float64 [segments * sides, 3], quads int32 [segments * sides, 4].

    Vertex i * sides + j lies at angle i around the axis and j around the tube; quads are counter-clockwise from outside.
    """
    around = np.arange(segments) * (2 * np.pi / segments)
    tube = np.arange(sides) * (2 * np.pi / sides)
    distance = major_radius + minor_radius * np.cos(tube)
    positions = np.empty((segments, sides, 3))
    positions[..., 0] = np.cos(around)[:, None] * distance
    positions[..., 1] = np.sin(around)[:, None] * distance
    positions[..., 2] = minor_radius * np.sin(tube)

    i, j = np.meshgrid(np.arange(segments), np.arange(sides), indexing="ij")
    next_i, next_j = (i + 1) % segments, (j + 1) % sides
    quads = np.stack([i * sides + j, next_i * sides + j, next_i * sides + next_j, i * sides + next_j], axis=-1)
    return positions.reshape(-1, 3), quads.reshape(-1, 4).astype(np.int32)


def chain_links(detail=64):
    """The tile's rings, each exactly once: positions float64 [n, 3] in tile widths, triangles int32 [m, 3].

    A ring whose center lies in the tile is whole, so it reaches over the tile's border; its copies by whole periods are
    implied. `detail` is the number of segments around a ring; the wire gets so many sides that faces come out square.
    64 gives 10240 triangles.
    """
    if detail < 8:
        raise ValueError(f"chain_links: detail is {detail}, a ring needs at least 8 segments")
    sides = max(6, round(detail * 5 / 16))
    ring, quads = torus(RING_RADIUS, WIRE_RADIUS, detail, sides)
    ring_triangles = quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)

    positions, triangles = [], []
    for index, (center, sign) in enumerate(zip(CENTERS, ROW_SIGN)):
        c, s = np.cos(sign * LEAN), np.sin(sign * LEAN)
        object_from_ring = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        positions.append(ring @ object_from_ring.T + [*center, HEIGHT / 2])
        triangles.append(ring_triangles + index * len(ring))
    return snap(np.concatenate(positions)), np.concatenate(triangles)


def make(detail=1.0):
    """The mail; triangles grow with the square of `detail`."""
    positions, triangles = chain_links(scaled(64, detail, 8))
    ring = np.arange(len(positions)) * len(CENTERS) // len(positions)
    colors = np.where(ROW_SIGN[ring, None] > 0, STEEL, BRASS) * (0.88 + 0.2 * chance(ring, 5))[:, None]
    return make_tile("chain", [(positions, triangles, colors)], height=HEIGHT, roughness=0.35, metallic=1.0)
