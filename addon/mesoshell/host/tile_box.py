"""The box that is one period of a tile: an empty, or (objects marked as tiles) a part of the object's own space.

u runs along the box's local X, v along Y, w along Z. The tile's shape is what is seen: a box scaled unevenly is a tile of
those proportions; where it stands, how it is turned and an even scale do not matter.
"""

from typing import NamedTuple

import numpy as np

# Of the box's height: matrices and vertices are 32-bit floats, and what a snapped box holds must not stick out of it by one of
# their steps.
SNAP_MARGIN = 1e-5


class TileBox(NamedTuple):
    name: str  # of the object, for sentences
    world_from_local: np.ndarray  # float64 [4, 4]
    low: np.ndarray  # float64 [3], the corner where texture space starts, local space
    high: np.ndarray  # float64 [3]

    @property
    def _scale(self):
        return np.linalg.norm(self.world_from_local[:3, :3], axis=0)

    @property
    def size(self):
        """float64 [3], world units."""
        return (self.high - self.low) * self._scale

    @property
    def aspect(self):
        return float(self.size[1] / self.size[0])

    @property
    def height(self):
        """In tile widths."""
        return float(self.size[2] / self.size[0])

    def metric_from(self, world_from_object):
        """float64 [3, 4]: from an object's space to metric texture space."""
        # The box's own object needs no inverse, which would cost a periodic mesh its exactness.
        if np.array_equal(world_from_object, self.world_from_local):
            local_from_object = np.eye(4)
        else:
            local_from_object = np.linalg.solve(self.world_from_local, world_from_object)
        affine = local_from_object[:3].copy()
        affine[:, 3] -= self.low
        return affine * (self._scale / self.size[0])[:, None]

    def corners(self):
        """float64 [8, 3], world space."""
        unit = np.stack(np.meshgrid([0.0, 1.0], [0.0, 1.0], [0.0, 1.0], indexing="ij"), axis=-1).reshape(-1, 3)
        local = self.low + unit * (self.high - self.low)
        return local @ self.world_from_local[:3, :3].T + self.world_from_local[:3, 3]


def of_object(obj, evaluated):
    """The TileBox of an object whose `mesoshell_tile` says which part of its local space is the period; ValueError."""
    settings = obj.mesoshell_tile
    size = np.array([settings.period_u, settings.period_v, settings.height], np.float64)
    for length, label in zip(size, ("period U", "period V", "height")):
        if not length > 0.0:
            raise ValueError(f'Tile "{obj.name}" has a {label} of {length:g}: set it to more than zero')
    box = TileBox(obj.name, _matrix(evaluated), np.zeros(3), size)
    _check(box, f'Tile "{obj.name}"')
    return box


def of_empty(empty, evaluated):
    """The TileBox that an empty shows (drawn as a cube it reaches its display size either way); ValueError."""
    half = np.full(3, float(empty.empty_display_size))
    box = TileBox(empty.name, _matrix(evaluated), -half, half)
    _check(box, f'The tile box "{empty.name}"')
    return box


def frame(matrix):
    """Rotation of a matrix as an orthonormal float64 [3, 3], by columns; a missing axis is made up.

    Of a mirrored matrix, Y and Z keep their directions: a tile's height must not turn over.
    """
    axes = np.array(matrix, np.float64)[:3, :3]
    x = _unit(axes[:, 0], np.array([1.0, 0.0, 0.0]))
    y = axes[:, 1] - x * (axes[:, 1] @ x)
    helper = np.array([0.0, 1.0, 0.0]) if abs(x[1]) < 0.9 else np.array([0.0, 0.0, 1.0])
    y = _unit(y, _unit(helper - x * (helper @ x), helper))
    z = np.cross(x, y)
    if z @ axes[:, 2] < 0.0:
        x, z = -x, -z
    return np.column_stack([x, y, z])


def place(empty, axes, low, high):
    """Makes an empty the box from `low` to `high`, corners in the frame `axes` of world space."""
    from mathutils import Matrix

    size = np.maximum(high - low, 0.0)
    center = (low + high) / 2
    size[2] *= 1.0 + SNAP_MARGIN
    world = np.eye(4)
    world[:3, :3] = axes * (size / (2.0 * empty.empty_display_size))
    world[:3, 3] = axes @ center
    empty.matrix_world = Matrix(world.tolist())


def _check(box, who):
    if not np.all(np.isfinite(box.world_from_local)):
        raise ValueError(f"{who} has a place that is no finite number: clear its transformation (Alt G, Alt R, Alt S)")
    for length, axis in zip(box.size, "XYZ"):
        if not length > 0.0:
            raise ValueError(f"{who} has a scale of zero along {axis}: scale it up")
    # Three axes in one plane span no volume, however long they are.
    if abs(np.linalg.det(box.world_from_local[:3, :3])) < 1e-9 * np.prod(box._scale):
        raise ValueError(f"{who} is flat: clear its rotation and scale, and those of its parents")


def _matrix(evaluated):
    return np.array(evaluated.matrix_world, np.float64)


def _unit(vector, fallback):
    length = np.linalg.norm(vector)
    return vector / length if length > 1e-12 else fallback
