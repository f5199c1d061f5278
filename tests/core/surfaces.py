"""Surfaces for these tests, and what the native module says of them."""

import numpy as np
from core import native
from core.tile_surface import TileSurface

import tiles


def sample(surface):
    """Raises unless the surface encloses something: closed modulo the periods."""
    return native.module().Sample(surface.positions, surface.triangles, height=surface.height, aspect=surface.aspect,
                                  thickness=surface.thickness)


def sdf(surface, resolution):
    """float32 [nz, ny, nx], tile widths."""
    return np.array(native.module().bake_sdf(sample(surface), resolution=resolution).values)


def ball(center=(0.5, 0.5, 0.25), radius=0.2, rings=24, height=0.5, aspect=1.0):
    """A ball with outward normals, corners colored by where they are and materials by hemisphere."""
    theta = np.linspace(0.0, np.pi, rings + 1)[1:-1]
    phi = np.arange(2 * rings) * (np.pi / rings)
    grid = np.stack([np.sin(theta)[:, None] * np.cos(phi), np.sin(theta)[:, None] * np.sin(phi),
                     np.repeat(np.cos(theta)[:, None], 2 * rings, axis=1)], axis=-1).reshape(-1, 3)
    unit = np.vstack([grid, [[0, 0, 1], [0, 0, -1]]])
    k, following = np.arange(2 * rings), (np.arange(2 * rings) + 1) % (2 * rings)
    north, south, last = len(grid), len(grid) + 1, len(grid) - 2 * rings
    faces = [np.stack([np.full_like(k, north), k, following], -1),
             np.stack([np.full_like(k, south), last + following, last + k], -1)]
    for ring in range(rings - 2):
        a, b = ring * 2 * rings + k, ring * 2 * rings + following
        faces += [np.stack([a, a + 2 * rings, b + 2 * rings], -1), np.stack([a, b + 2 * rings, b], -1)]
    triangles = np.concatenate(faces).astype(np.int32)
    positions = unit * radius + np.asarray(center)
    return TileSurface("Ball", positions, triangles, height, aspect, normals=unit[triangles].astype(np.float32),
                       colors=positions[triangles].astype(np.float32),
                       material_indices=(unit[triangles][:, :, 2].mean(axis=1) > 0).astype(np.int32), materials=({}, {}))


def sample_tile(name, detail=0.33):
    """One of the six tiles, colored by its own colors."""
    tile = tiles.make(name, detail)
    return TileSurface(name, tile.positions.astype(np.float64), tile.triangles, tile.height, tile.aspect,
                       colors=tile.corner_colors.astype(np.float32))


def area_and_volume(surface):
    """By the flux of (0, 0, z), to which what the sides leave open adds nothing."""
    a, b, c = np.moveaxis(surface.positions[surface.triangles], 1, 0)
    cross = np.cross(b - a, c - a) / 2
    return np.linalg.norm(cross, axis=1).sum(), (cross[:, 2] * (a + b + c)[:, 2]).sum() / 3


def face_normals(surface):
    a, b, c = np.moveaxis(surface.positions[surface.triangles], 1, 0)
    cross = np.cross(b - a, c - a)
    return cross / np.linalg.norm(cross, axis=1, keepdims=True)
