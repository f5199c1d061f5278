"""What ./dev accuracy renders: three bases that carry a tile, and views of them from three elevations.

No ray may run on the baked grids, where interpolation has no error: patterns lie turned by 17 degrees (where the base
allows it) and shifted by parts of a tile that no grid shares, eyes stand at odd azimuths, and the views are perspective, so
that every pixel has a direction of its own. `off_grid` says how well that holds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mail_scenes import perspective, torus_mesh, view_from

ELEVATIONS = (65, 35, 15)  # of the eye over the base's middle plane, degrees
AZIMUTHS = {65: -62.3, 35: -47.9, 15: -71.7}
DISTANCE = 3.7  # from the middle of a shell to the eye, in radii of the sphere around it

TURN = np.radians(17.0)
SHIFT = (0.137, 0.291)  # tiles


@dataclass(frozen=True)
class Surface:
    """A base mesh and what puts a tile on it; thickness in object units."""

    positions: np.ndarray
    face_sizes: np.ndarray
    corners: np.ndarray
    uvs: np.ndarray  # tiles
    normals: np.ndarray
    thickness: float

    def shell(self, native):
        return native.build_shell(self.positions, self.face_sizes, self.corners, self.uvs, normals=self.normals,
                                  thickness=self.thickness, uv_offset=SHIFT)


def _patch(tile, quads, height_of, gradient_of):
    """A square of 3 by 3 tile widths over the plane z = 0, a tile width being 1 object unit."""
    side = np.linspace(-1.5, 1.5, quads + 1)
    x, y = (part.ravel() for part in np.meshgrid(side, side, indexing="ij"))
    slope_x, slope_y = gradient_of(x, y)
    normals = np.stack([-slope_x, -slope_y, np.ones_like(x)], -1)
    first = (np.arange(quads)[:, None] * (quads + 1) + np.arange(quads)).reshape(-1, 1)
    corners = first + [0, quads + 1, quads + 2, 1]
    turned = np.stack([np.cos(TURN) * x - np.sin(TURN) * y, (np.sin(TURN) * x + np.cos(TURN) * y) / tile.aspect], -1)
    return Surface(np.stack([x, y, height_of(x, y)], -1).astype(np.float32), np.full(quads * quads, 4, np.int32),
                   corners.ravel().astype(np.int32), turned[corners.ravel()].astype(np.float32),
                   (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32), tile.height)


def planar(tile):
    """A flat square: prisms map without bending anything."""
    return _patch(tile, 6, lambda x, y: 0.0 * x, lambda x, y: (0.0 * x, 0.0 * y))


def saddle(tile):
    """z = 0.22 (x^2 - y^2): fins twist, rays bend both ways."""
    return _patch(tile, 8, lambda x, y: 0.22 * (x * x - y * y), lambda x, y: (0.44 * x, -0.44 * y))


def torus(tile):
    """Radii 1 and 0.5, 12 tiles around: prisms widen toward their tops outside and narrow inside; no borders."""
    columns, rows, minor = 32, 16, 0.5
    positions, face_sizes, corners, uvs = torus_mesh(columns, rows, (12, round(6 / tile.aspect)), 1.0, minor)
    ring = positions * (1, 1, 0)
    normals = positions - ring / np.linalg.norm(ring, axis=1, keepdims=True)
    return Surface(positions, face_sizes, corners, uvs, normals / np.float32(minor), tile.height * 2 * np.pi / 12)


BASES = {"planar": planar, "torus": torus, "saddle": saddle}


def view_of(shell, elevation):
    """clip_from_object of a square picture that the shell just fills, seen from that elevation."""
    points = shell.prisms[:, :6, :3].reshape(-1, 3).astype(float)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = np.linalg.norm(points - middle, axis=1).max()
    up, around = np.radians(elevation), np.radians(AZIMUTHS[elevation])
    toward = np.array([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)])
    view = view_from(middle + DISTANCE * radius * toward, middle)
    seen = points @ view[:3, :3].T + view[:3, 3]
    slopes = seen[:, :2] / -seen[:, 2:]
    shift = np.eye(4)
    shift[:2, 2] = (slopes.min(axis=0) + slopes.max(axis=0)) / 2  # a lens shift: the far half of a shell looks smaller
    widest = np.ptp(slopes, axis=0).max() / 2
    return perspective(2 * np.degrees(np.arctan(1.02 * widest)), near=radius, far=10 * radius) @ shift @ view


def ray_directions(clip_from_object, size):
    """Unit directions of the pixels' rays, object space, float64 [h, w, 3]; row 0 is the bottom."""
    width, height = size
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1, (np.arange(height) + 0.5) / height * 2 - 1)
    object_from_clip = np.linalg.inv(clip_from_object)
    near, far = (np.stack([x, y, np.full_like(x, z), np.ones_like(x)], -1) @ object_from_clip.T for z in (-1, 1))
    along = far[..., :3] / far[..., 3:] - near[..., :3] / near[..., 3:]
    return along / np.linalg.norm(along, axis=-1, keepdims=True)


def shell_mask(native, shell, clip_from_object, size):
    """The rays that meet the shell, whether or not they hit something in it: bool [h, w], by the hulls of its prisms."""
    corners = shell.prisms[:, :6, :3].reshape(-1, 3)
    return native.trace(corners, shell.indices.reshape(-1, 3), clip_from_object=clip_from_object, size=size)["hit"] == 1


def off_grid(pos_texture, nodes):
    """How evenly hits [n, 3] lie between a grid's nodes along u and v: 1 where they have nothing to do with it, 0 on nodes.

    The mean square of the distance to the nearest node, over that of evenly spread places, 1/12 of the nodes' squared.
    """
    between = np.asarray(pos_texture)[:, :2] * nodes
    return float((12 * (between - np.round(between)) ** 2).mean())
