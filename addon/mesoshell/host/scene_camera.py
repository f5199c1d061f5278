"""What a render sees: the scene's camera as a matrix, and the part of the picture that is asked for."""

from typing import NamedTuple

import numpy as np


class View(NamedTuple):
    clip_from_world: np.ndarray  # float64 [4, 4], OpenGL clip space of the part
    size: tuple  # width and height of the part, in pixels
    depth_start: float  # where depth begins in front of the camera: at the near plane of an orthographic view


def read(depsgraph, size):
    """The View of the scene's camera in a picture of `size` pixels, of which only the render border is made if there is one.

    Raises ValueError where the camera's picture is no projection, or there is none.
    """
    scene = depsgraph.scene
    camera = scene.camera
    if camera is None or camera.type != 'CAMERA':
        raise ValueError(f'The scene "{scene.name}" has no camera: add one (Add > Camera)')
    if camera.data.type not in {'PERSP', 'ORTHO'}:
        raise ValueError(f'The camera "{camera.name}" is neither perspective nor orthographic: set its type (Lens > Type)')
    render = scene.render
    camera = camera.evaluated_get(depsgraph)
    clip_from_view = camera.calc_matrix_camera(depsgraph, x=size[0], y=size[1], scale_x=render.pixel_aspect_x,
                                               scale_y=render.pixel_aspect_y)
    view_from_world = np.linalg.inv(np.array(camera.matrix_world.normalized(), np.float64))
    clip_from_world = np.array(clip_from_view, np.float64) @ view_from_world
    depth_start = camera.data.clip_start if camera.data.type == 'ORTHO' else 0.0
    if not render.use_border:
        return View(clip_from_world, tuple(size), depth_start)
    low, high = border(render, size)
    return View(_part(low, high, size) @ clip_from_world, (high[0] - low[0], high[1] - low[1]), depth_start)


def border(render, size):
    """The first pixels of the render border and those after its last, each (x, y) from the bottom left."""
    def pixel(share, side):
        # As Blender counts: in single precision, cut off.
        return int(np.float32(share) * np.float32(side))

    return ((pixel(render.border_min_x, size[0]), pixel(render.border_min_y, size[1])),
            (pixel(render.border_max_x, size[0]), pixel(render.border_max_y, size[1])))


def _part(low, high, size):
    """clip_from_clip [4, 4] that makes [-1, 1] of the pixels from `low` to `high`."""
    low, high = (2.0 * np.array(place, np.float64) / size - 1.0 for place in (low, high))
    matrix = np.eye(4)
    matrix[[0, 1], [0, 1]] = 2.0 / (high - low)
    matrix[:2, 3] = -(high + low) / (high - low)
    return matrix
