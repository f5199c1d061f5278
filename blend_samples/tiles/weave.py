"""A tile of plain weave, as pure geometry: round, three-ply yarns that really pass over and under each other.

Warp yarns run along y, weft yarns along x, and where yarn i of one crosses yarn j of the other, the warp is above if i + j
is even. A yarn's axis lies in a vertical plane. It follows Peirce's model (The Geometry of Cloth Structure, 1937): around
each yarn that it crosses, an arc about that yarn's axis with the radius REACH, the sum of both radii and of a gap; between
two arcs, their common tangent.

Why no two yarns meet: with a and b the depths sqrt(REACH^2 - d^2) of two points of the arcs of a crossing below their tops,
the square of their distance is REACH^2 + 2 (REACH - a) (REACH - b), which is at least REACH^2. Parallel yarns are farther
apart than their diameters.

Lengths are in tile widths. Four warp and four weft yarns, the weft thicker and farther apart: the tile is not square.
"""

import numpy as np

from .tile import chance, grid_triangles, make_tile, mix, noise, scaled

ASPECT = 1.25
HEIGHT = 0.32  # the cloth is 0.302 thick and lies in the middle
COUNT = 4  # yarns each way; even, so that over and under repeat
WARP_RADIUS, WEFT_RADIUS = 0.066, 0.078
GAP = 0.003  # between two yarns where they cross
REACH = WARP_RADIUS + WEFT_RADIUS + GAP  # between the axes of two yarns where they cross
WARP_RISE = 0.085  # of the warp's axis above the middle; the weft falls by the rest of REACH
TWIST = 7, 5  # thirds of a turn that the plies of a warp, a weft yarn make over a period
PLY_OFFSET = 0.35  # of a ply's center from the yarn's, in yarn radii; a ply's radius is the rest

ECRU, BONE = (0.66, 0.56, 0.41), (0.78, 0.70, 0.56)
INDIGO, RUST = (0.045, 0.095, 0.24), (0.42, 0.10, 0.035)


def axis_height(along, spacing, sink):
    """z over the middle and dz/d along of a yarn's axis, float64 [n] each; it is on top at along = 0.

    spacing: between the yarns it crosses. sink: of the axis of the yarn below it, under the middle.
    """
    phase = np.mod(along / spacing, 2.0)
    falling = np.where(phase < 1.0, 1.0, -1.0)
    half = np.where(phase < 1.0, phase, 2.0 - phase)  # 0 on top, 1 at the bottom
    upper = half < 0.5
    # From the top to halfway; from there on, all is turned by half a turn about the point halfway.
    across = np.where(upper, half, 1.0 - half) * spacing
    far = np.hypot(spacing / 2, sink)
    contact = np.arcsin(REACH / far) - np.arctan2(sink, spacing / 2)
    on_arc = across < REACH * np.sin(contact)
    depth = np.sqrt(REACH**2 - np.where(on_arc, across, 0.0) ** 2)
    height = np.where(on_arc, depth - sink, (spacing / 2 - across) * np.tan(contact))
    slope = np.where(on_arc, -across / depth, -np.tan(contact))
    return np.where(upper, height, -height), slope * falling


def ply_outline(sides):
    """The outline of three plies: angles [sides] and distances from the center in yarn radii; the first is in a groove."""
    angle = np.arange(sides) * (2 * np.pi / sides)
    from_ply = np.mod(angle, 2 * np.pi / 3) - np.pi / 3
    ply = 1.0 - PLY_OFFSET
    return angle, PLY_OFFSET * np.cos(from_ply) + np.sqrt(ply**2 - (PLY_OFFSET * np.sin(from_ply)) ** 2)


def yarn(index, is_warp, rings, sides):
    """A yarn over one period: positions [(rings + 1) * sides, 3], triangles, colors [.., 3]. sides: a multiple of 3.

    Its last ring of vertices is the first one, a period on, its vertices numbered on by the twist.
    """
    length, other = (ASPECT, 1.0) if is_warp else (1.0, ASPECT)
    radius, twist = (WARP_RADIUS, TWIST[0]) if is_warp else (WEFT_RADIUS, TWIST[1])
    sink = REACH - WARP_RISE if is_warp else WARP_RISE
    spacing = length / COUNT
    along = np.arange(rings) * (length / rings)
    first_is_below = (index + (0 if is_warp else 1)) % 2
    height, slope = axis_height(along - spacing * (0.5 + first_is_below), spacing, sink)

    angle, distance = ply_outline(sides)
    start = 2 * np.pi * chance(index, is_warp, 1)
    turned = angle[None] + (2 * np.pi / 3 * twist * np.arange(rings) / rings + start)[:, None]
    sideways, upward = radius * distance * np.cos(turned), radius * distance * np.sin(turned)
    tilt = 1.0 / np.hypot(1.0, slope)[:, None]  # cosine of the axis's rise
    own = along[:, None] - upward * slope[:, None] * tilt
    z = HEIGHT / 2 + height[:, None] + upward * tilt
    across = (index + 0.5) * other / COUNT + (sideways if is_warp else -sideways)
    ring = np.stack([across, own, z] if is_warp else [own, across, z], -1)
    last = np.roll(ring[:1], -(twist * sides // 3), axis=1) + ([0.0, length, 0.0] if is_warp else [length, 0.0, 0.0])

    # Fibers: fine streaks that follow the plies, and dirt and shadow in the grooves.
    around = np.broadcast_to(angle / (2 * np.pi), turned.shape)
    streak = noise(np.stack([np.broadcast_to(along[:, None] / length, turned.shape), around], -1), (12, sides), index + 8 * is_warp)
    low, high = (ECRU, BONE) if is_warp else (RUST, RUST) if index == 2 else (INDIGO, INDIGO)
    shade = (0.55 + 0.45 * (distance - distance.min()) / np.ptp(distance)) * (1.0 + 0.16 * streak)
    shade = shade * (0.88 + 0.24 * chance(index, is_warp, 2))
    colors = mix(low, high, np.full(shade.shape, chance(index, is_warp, 3))) * shade[..., None]
    last_colors = np.roll(colors[:1], -(twist * sides // 3), axis=1)

    triangles = grid_triangles(rings + 1, sides, wrap_columns=True)[:, ::-1]
    return (np.concatenate([ring, last]).reshape(-1, 3), triangles, np.concatenate([colors, last_colors]).reshape(-1, 3))


def make(detail=1.0):
    """The weave; triangles grow with the square of `detail`."""
    sides = scaled(15, detail, 6, 3)
    warp, weft = scaled(48, detail, 16), scaled(38, detail, 16)
    parts = [yarn(i, is_warp, warp if is_warp else weft, sides) for is_warp in (True, False) for i in range(COUNT)]
    return make_tile("weave", parts, height=HEIGHT, aspect=ASPECT, roughness=0.85)
