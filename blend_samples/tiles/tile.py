"""What a tile is, and what the six share: a lattice that makes periods exact, repeatable chance, tubes and sheets.

Lengths are in tile widths: a tile is the box [0, 1] x [0, aspect] x [0, height], and copies of it by whole periods are
implied. NumPy only, no bpy.
"""

from dataclasses import dataclass

import numpy as np

# Positions are whole multiples of this. float32 holds such numbers exactly up to 16 tile widths, and the periods are
# multiples of it too: a vertex and its copy by whole or half periods differ by exactly that, in float32 as in float64.
# Its width, a millionth of a tile's, also hides in which last bit two machines' sines differ.
LATTICE = 2.0**-20


@dataclass(frozen=True)
class Tile:
    """One period of a mesostructure, closed modulo the periods, faces counter-clockwise from outside.

    Closed solids may overlap (a strand's root in the skin): inside is where the winding number is not zero.
    """

    name: str
    positions: np.ndarray  # float64 [n, 3], multiples of LATTICE
    triangles: np.ndarray  # int32 [m, 3]
    colors: np.ndarray  # float64 [n, 3], linear RGB of the vertices in [0, 1]
    height: float
    aspect: float = 1.0  # the period along y
    roughness: float = 0.6
    metallic: float = 0.0

    @property
    def corner_colors(self):
        """Linear RGB of the triangles' corners, float32 [m, 3, 3]."""
        return self.colors[self.triangles].astype(np.float32)


def make_tile(name, parts, **settings):
    """A Tile of parts (positions [n, 3], triangles [m, 3], colors [n, 3] or [3]), its vertices moved onto the lattice."""
    positions, triangles, colors, count = [], [], [], 0
    for part_positions, part_triangles, part_colors in parts:
        positions.append(part_positions)
        triangles.append(np.asarray(part_triangles) + count)
        colors.append(np.broadcast_to(part_colors, part_positions.shape))
        count += len(part_positions)
    return Tile(name, snap(np.concatenate(positions)), np.concatenate(triangles).astype(np.int32),
                np.clip(np.concatenate(colors), 0.0, 1.0), **settings)


def snap(positions):
    """The nearest points of the lattice."""
    return np.round(np.asarray(positions) / LATTICE) * LATTICE


def scaled(count, detail, least, multiple=1):
    """`count` at detail 1, in proportion to `detail`, at least `least`, a whole multiple of `multiple`."""
    if not detail > 0.0:
        raise ValueError(f"detail is {detail}; give a positive number, 1 for about 10 000 triangles")
    return max(least, round(count * detail / multiple) * multiple)


def chance(*keys):
    """Numbers in [0, 1) that only the whole numbers `keys` (arrays, broadcast) decide, the same on any machine."""
    state = np.full(np.broadcast_shapes(*(np.shape(key) for key in keys)), 0x9E3779B97F4A7C15, np.uint64)
    with np.errstate(over="ignore"):
        for key in keys:  # the finalizer of SplitMix64 (Steele et al. 2014) after every key
            state = state + np.asarray(key).astype(np.int64).astype(np.uint64) * np.uint64(0xBF58476D1CE4E5B9)
            state = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
            state = (state ^ (state >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
            state = state ^ (state >> np.uint64(31))
    return (state >> np.uint64(11)).astype(float) * 2.0**-53


def noise(points, cells, seed):
    """Smooth noise in [-1, 1] at `points` [..., d] in periods: `cells` [d] random values a period, repeating exactly."""
    points = np.asarray(points, float) * cells
    corner = np.floor(points).astype(np.int64)
    weight = points - corner
    weight = weight * weight * weight * (weight * (weight * 6.0 - 15.0) + 10.0)
    values = chance(seed, *np.indices(cells))
    total = 0.0
    for index in np.ndindex(*(2,) * points.shape[-1]):
        nodes = np.mod(corner + index, cells)
        share = np.prod(np.where(index, weight, 1.0 - weight), axis=-1)
        total = total + share * values[tuple(np.moveaxis(nodes, -1, 0))]
    return 2.0 * total - 1.0


def mix(first, second, share):
    """Colors from `first` [3] to `second` [3] by `share` [n], float64 [n, 3]."""
    share = np.asarray(share)[..., None]
    return np.asarray(first) * (1.0 - share) + np.asarray(second) * share


def grid_triangles(rows, columns, wrap_columns=False):
    """Triangles of a grid of vertices [rows, columns], counter-clockwise where columns run along x and rows along y.

    wrap_columns: the last column's neighbor is the first one, as around a tube.
    """
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns if wrap_columns else columns - 1), indexing="ij")
    next_j = (j + 1) % columns
    quads = np.stack([i * columns + j, i * columns + next_j, (i + 1) * columns + next_j, (i + 1) * columns + j], -1)
    return quads[..., [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)


def sheet(height_of, rows, columns, aspect, facing=1):
    """A sheet over the whole tile: positions [(rows + 1) * (columns + 1), 3] and triangles, facing up (1) or down (-1).

    height_of(points [n, 2] in tile widths) gives z, which repeats by itself. The far borders are the near ones plus the
    period. With another sheet that faces the other way it bounds a layer, closed modulo the periods.
    """
    u, v = np.meshgrid(np.arange(columns + 1) / columns, np.arange(rows + 1) / rows)
    positions = np.stack([u, v * aspect, np.zeros_like(u)], -1)
    positions[..., 2] = np.reshape(height_of(positions[..., :2].reshape(-1, 2)), u.shape)
    positions[-1, :, 2] = positions[0, :, 2]
    positions[:, -1, 2] = positions[:, 0, 2]
    triangles = grid_triangles(rows + 1, columns + 1)
    return positions.reshape(-1, 3), triangles if facing > 0 else triangles[:, ::-1]


def capped_tube(rings, first, last):
    """A closed tube: positions [n * sides + 2, 3] and triangles, of rings [n, sides, 3] and the points that close its ends.

    Rings run counter-clockwise seen from where the tube goes to.
    """
    count, sides = rings.shape[:2]
    positions = np.concatenate([rings.reshape(-1, 3), [first, last]])
    j = np.arange(sides)
    next_j = (j + 1) % sides
    end = (count - 1) * sides
    bottom = np.stack([next_j, j, np.full(sides, count * sides)], -1)
    top = np.stack([end + j, end + next_j, np.full(sides, count * sides + 1)], -1)
    return positions, np.concatenate([grid_triangles(count, sides, wrap_columns=True), bottom, top])


def turned_about_z(points, angles):
    """Points [n, 3] turned about the z axis by each of `angles` [m]: float64 [m, n, 3]."""
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(z, (len(angles), len(points)))], -1)
