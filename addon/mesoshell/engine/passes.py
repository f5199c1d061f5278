"""The passes that a picture has besides its color, and how they get into Blender's render result.

Blender's arrays of pixels have rows from the bottom, as ours have. One flat array of all passes in a row is what every
Blender takes: a single pass wants its pixels flat in 5.2, but as rows of channels in 3.4.
"""

import numpy as np

from ..host import versions

# What Blender calls a pass, the view layer's switch, channels, the kind of its socket, and the array of the picture.
_PASSES = (
    ("Combined", None, "RGBA", 'COLOR', "color"),
    ("Depth", "use_pass_z", "Z", 'VALUE', "depth"),
    ("Normal", "use_pass_normal", "XYZ", 'VECTOR', "normal"),
    (versions.OBJECT_INDEX_PASS, "use_pass_object_index", "X", 'VALUE', "index"),
)


def register(engine, scene, view_layer):
    """Tells Blender which passes the engine makes of a view layer."""
    for name, switch, channels, kind, _array in _PASSES:
        if switch is None or getattr(view_layer, switch):
            engine.register_pass(scene, view_layer, name, len(channels), channels, kind)


_NOTHING = 1e10  # the depth where nothing is, Blender's and ours


def fill(passes, picture, depth_start):
    """Fills the passes of a render layer with arrays of the native render_scene; those that `picture` lacks become 0.

    `depth_start` is added to depths.
    """
    arrays = {name: array for name, _switch, _channels, _kind, array in _PASSES}
    pixels = np.asarray(picture["color"]).size // 4
    parts = []
    for render_pass in passes:
        array = picture.get(arrays.get(render_pass.name))
        array = np.zeros(pixels * render_pass.channels, np.float32) if array is None else np.asarray(array, np.float32)
        if render_pass.name == versions.OBJECT_INDEX_PASS:
            array = np.maximum(array, 0.0)  # Blender's index of nothing
        if render_pass.name == "Depth" and depth_start:
            array = np.where(array < _NOTHING, array + np.float32(depth_start), array)
        parts.append(array.ravel())
    passes.foreach_set("rect", np.concatenate(parts))
