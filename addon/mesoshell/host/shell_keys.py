"""All that a shell is built from but for the geometry, as one value that tells whether it must be built again."""

from typing import NamedTuple

import numpy as np

from . import cages, map_cache, meshes, paths, versions


class BuildKey(NamedTuple):
    """Hashable. What a name here has in common with one of native build_shell's arguments, it has its meaning too."""

    file: map_cache.FileState
    reading: meshes.Reading
    thickness: float  # None: the tile's proportions
    levels: int  # with an edge length or pixels, the most
    scheme: str
    boundary: str
    uv_rule: str
    edge_length: float  # object units; 0: none
    edge_pixels: float
    clip_from_object: tuple  # 16 numbers by rows, or None
    screen: tuple  # width and height of the rendered picture, or None
    image: tuple  # which image multiplies the thickness, and which content of it, or None
    offset: str
    smooth_directors: int
    repair: bool
    relax: int
    tiles: tuple  # per UV unit, or per meter
    uv_rotation: float
    uv_offset: tuple
    metric: tuple  # where tiles are per meter: squares of lengths in meters, as a matrix [3, 3] by rows of object space


_image_versions = {}  # image key -> how often its pixels changed


def image_changed(image):
    """Says that an image's pixels are no longer what they were."""
    key = versions.object_key(image)
    _image_versions[key] = _image_versions.get(key, 0) + 1


def read(obj, depsgraph, value, *, map_path, thickness, image):
    """The BuildKey of an object's settings; raises ValueError or OSError.

    value      gives each of shell_options.NAMES
    thickness  object units, or None: the tile's proportions
    image      a Blender image, or None
    """
    if thickness is not None and not thickness > 0.0:
        raise ValueError(f'The shell of "{obj.name}" has a thickness of {thickness:g}: set it to more than zero')
    refined = _subdivision(obj, depsgraph, value)
    edge_length, edge_pixels, clip_from_object, screen = 0.0, 0.0, None, None
    if value("refine") == 'LENGTH':
        edge_length = _rounded(value("edge_length") / _scale(obj, depsgraph))
    elif value("refine") == 'SCREEN':
        edge_pixels = value("edge_pixels")
        clip_from_object, screen = _seen_by_camera(obj, depsgraph)
    refines = refined.levels > 0
    part = value("part")
    if part != 'ALL' and not value("part_name"):
        raise ValueError(f'The part of "{obj.name}" that the shell is to cover has no name: choose one, or set Part to '
                         "Whole Mesh")
    reading = meshes.Reading(
        cage=value("surface") == 'CAGE', triangulate=refined.scheme == "loop", polygons=refines,
        creases=refines and refined.creases, normals=not refines, part=part,
        part_name=value("part_name") if part != 'ALL' else "", group=value("thickness_group"))
    metric = _metric(obj, depsgraph) if value("placement") == 'METER' else None
    return BuildKey(
        map_cache.file_state(paths.absolute(map_path, obj)), reading, thickness, refined.levels, refined.scheme,
        refined.boundary, refined.uv_rule, edge_length, edge_pixels, clip_from_object, screen, _image(image),
        value("offset"), value("smooth_directors"), value("repair"), value("relax"), (value("tiles_u"), value("tiles_v")),
        value("uv_rotation"), tuple(value("uv_offset")), metric)


def of_object(obj, depsgraph):
    """The BuildKey of the settings that an object holds; raises ValueError or OSError."""
    settings = obj.mesoshell
    return read(obj, depsgraph, lambda name: getattr(settings, name), map_path=settings.map_path,
                thickness=None if settings.fit_thickness else settings.thickness, image=settings.thickness_image)


def _subdivision(obj, depsgraph, value):
    if value("subdivision") == 'MODIFIER':
        refined = cages.subdivision(obj, depsgraph)
    else:
        refined = cages.Subdivision(*(value(name) for name in ("levels", "scheme", "boundary", "uv_rule", "use_creases")))
    return refined if value("refine") == 'LEVELS' else refined._replace(levels=value("most_levels"))


def _scale(obj, depsgraph):
    """World units of an object unit, in the mean of all directions."""
    volume = abs(np.linalg.det(np.array(obj.evaluated_get(depsgraph).matrix_world, np.float64)[:3, :3]))
    if volume == 0.0:
        raise ValueError(f'"{obj.name}" is scaled to nothing, so that no length can be measured on it: set its scale')
    return float(np.cbrt(volume))


def _metric(obj, depsgraph):
    """Squares of lengths in meters, of vectors in object space: world_from_object's transpose times itself, by rows."""
    linear = np.array(obj.evaluated_get(depsgraph).matrix_world, np.float64)[:3, :3]
    metric = linear.T @ linear * depsgraph.scene.unit_settings.scale_length ** 2
    largest = _rounded(np.abs(metric).max())
    return tuple(largest * round(value, 5) for value in (metric / (largest or 1.0)).ravel())


def _rounded(value):
    """To five digits: an object that turns keeps its measures but for the last ones, and need not be built again."""
    return float(f"{value:.5g}")


def _seen_by_camera(obj, depsgraph):
    """clip_from_object by rows and the picture's size, as the scene's camera renders."""
    scene = depsgraph.scene
    camera = scene.camera
    if camera is None or camera.type != 'CAMERA':
        raise ValueError(f'The shell of "{obj.name}" is refined to pixels, but the scene has no camera: add one, or refine '
                         "to an edge length")
    render = scene.render
    size = tuple(max(1, side * render.resolution_percentage // 100) for side in (render.resolution_x, render.resolution_y))
    evaluated = camera.evaluated_get(depsgraph)
    projection = evaluated.calc_matrix_camera(depsgraph, x=size[0], y=size[1], scale_x=render.pixel_aspect_x,
                                              scale_y=render.pixel_aspect_y)
    clip_from_object = (np.array(projection, np.float64)
                        @ np.linalg.inv(np.array(evaluated.matrix_world.normalized(), np.float64))
                        @ np.array(obj.evaluated_get(depsgraph).matrix_world, np.float64))
    return tuple(clip_from_object.ravel()), size


def _image(image):
    if image is None:
        return None
    key = versions.object_key(image)
    return (image.name, key, _image_versions.get(key, 0), tuple(image.size))
