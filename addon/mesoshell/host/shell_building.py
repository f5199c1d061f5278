"""Builds the native shell of a surface, and brings it up to date when the surface moved."""

from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from ..core import native
from . import images, measures, meshes


class Built(NamedTuple):
    shell: object  # native Shell
    surface: meshes.SurfaceArrays  # what it was made of
    fit: measures.Fit


def build(obj, surface, key, tile_map, image):
    """The Built of a surface by a shell_keys.BuildKey; raises ValueError, MemoryError, Error or NativeMissing.

    `tile_map` is the native Map, `image` the Blender image that `key` names.
    """
    return _build(obj, surface, key, _fit(obj, surface, key, tile_map), image)


def again(obj, surface, key, built, tile_map, image, *, at_rest):
    """The Built of a surface that was read again: `built` itself where all is as it was, updated where it only moved.

    `at_rest` says that the mesh at rest, by which UVs are measured, did not change.
    """
    fit = built.fit if at_rest else _fit(obj, surface, key, tile_map)
    if fit != built.fit or not _same(built.surface[meshes.MOVING:], surface[meshes.MOVING:]) or not _as_many(built, surface):
        return _build(obj, surface, key, fit, image)
    if _same(built.surface[:meshes.MOVING], surface[:meshes.MOVING]):
        return built
    with _naming(obj):
        shell = native.module().update_shell(built.shell, surface.positions, normals=surface.normals,
                                             thickness_factors=surface.thickness_factors)
    return Built(shell, surface, fit)


def _build(obj, surface, key, fit, image):
    with _naming(obj):
        shell = native.module().build_shell(
            *surface_arguments(surface), normals=surface.normals, thickness_factors=surface.thickness_factors,
            crease_edges=surface.crease_edges, crease_sharpness=surface.crease_sharpness,
            corner_vertices=surface.corner_vertices, corner_sharpness=surface.corner_sharpness, covered=surface.covered,
            thickness=fit.thickness, thickness_image=None if image is None else images.red(image), levels=key.levels,
            scheme=key.scheme, boundary=key.boundary, uv_rule=key.uv_rule, edge_length=key.edge_length,
            edge_pixels=key.edge_pixels,
            clip_from_object=None if key.clip_from_object is None else np.reshape(key.clip_from_object, (4, 4)),
            screen=key.screen, offset=key.offset, smooth_directors=key.smooth_directors, uv_scale=fit.uv_scale,
            uv_rotation=key.uv_rotation, uv_offset=key.uv_offset, repair=key.repair, relax=key.relax)
    return Built(shell, surface, fit)


def surface_arguments(surface):
    """The positional arguments of build_shell."""
    return surface.positions, surface.face_sizes, surface.corners, surface.uvs


def _fit(obj, surface, key, tile_map):
    return measures.fit(obj, surface, thickness=key.thickness, tiles=key.tiles, rotation=key.uv_rotation,
                        metric=None if key.metric is None else np.reshape(key.metric, (3, 3)), tile_height=tile_map.height)


def _same(before, now):
    return all((a is None) == (b is None) and (a is b or np.array_equal(a, b)) for a, b in zip(before, now))


def _as_many(built, surface):
    return len(built.surface.positions) == len(surface.positions) and all(
        (a is None) == (b is None) for a, b in zip(built.surface[:meshes.MOVING], surface[:meshes.MOVING]))


@contextmanager
def _naming(obj):
    """Puts the object's name before what the native module says of its mesh."""
    module = native.module()
    try:
        yield
    except ValueError as error:
        raise ValueError(f'"{obj.name}": {error}') from error
    except module.Error as error:
        raise module.Error(f'"{obj.name}": {error}') from error
