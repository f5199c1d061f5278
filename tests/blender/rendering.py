"""Renders of the tests: a probe that looks at a render's depsgraph, and Blender's own files read back."""

import struct
from contextlib import contextmanager

import bpy
import numpy as np


def in_render(look, size=(8, 8)):
    """What `look(depsgraph)` returns in a render of the context's scene: its depsgraph is in mode RENDER."""
    found = []

    class Probe(bpy.types.RenderEngine):
        bl_idname = "MESOSHELL_TEST_PROBE"
        bl_label = "Probe"

        def update(self, data=None, depsgraph=None):
            try:
                found.append(look(depsgraph))
            except Exception as error:
                found.append(error)

        def render(self, depsgraph):
            pass

    render = bpy.context.scene.render
    bpy.utils.register_class(Probe)
    try:
        with kept(render, "engine", "resolution_x", "resolution_y", "resolution_percentage"):
            render.engine = Probe.bl_idname
            (render.resolution_x, render.resolution_y), render.resolution_percentage = size, 100
            bpy.ops.render.render()
    finally:
        bpy.utils.unregister_class(Probe)
    if isinstance(found[0], Exception):
        raise found[0]
    return found[0]


# Of scene.render, what render() and the tests set.
_SETTINGS = ("engine", "resolution_x", "resolution_y", "resolution_percentage", "filepath", "film_transparent", "use_border",
             "use_crop_to_border", "border_min_x", "border_max_x", "border_min_y", "border_max_y", "filter_size",
             "use_file_extension")


@contextmanager
def set_up(scene, size, samples=1):
    """The scene renders by the engine, to 32-bit files that read_exr() reads, while the block runs; camera and world too."""
    image = scene.render.image_settings
    names = "media_type", "file_format", "color_mode", "color_depth", "exr_codec", "use_exr_interleave"
    of_image = [name for name in names if hasattr(image, name)]
    with kept(scene.render, *_SETTINGS), kept(image, *of_image), kept(scene, "camera", "world", "frame_start", "frame_end"):
        render = scene.render
        render.engine, render.use_file_extension = 'MESOSHELL', True
        (render.resolution_x, render.resolution_y), render.resolution_percentage = size, 100
        if "media_type" in of_image:
            image.media_type = 'MULTI_LAYER_IMAGE'
        image.file_format, image.color_depth, image.exr_codec = 'OPEN_EXR_MULTILAYER', '32', 'NONE'
        if "use_exr_interleave" in of_image:
            image.use_exr_interleave = True
        scene.mesoshell_render.samples = samples
        yield render
    scene.property_unset("mesoshell_render")


def render(path, scene=None):
    """Renders to a file; the passes of each view layer as {"Combined": float32 [h, w, 4], "Depth": [h, w], ...}.

    With one view layer that dict; with more, a dict of them by name.
    """
    scene = scene or bpy.context.scene
    scene.render.filepath = str(path)
    assert bpy.ops.render.render(write_still=True, scene=scene.name) == {'FINISHED'}
    return passes_of(path, scene)


def passes_of(path, scene):
    """What a file that set_up() made Blender write holds, as render() returns it."""
    channels, layers = read_exr(path), {}
    for layer in scene.view_layers:
        found = layers[layer.name] = {}
        for name in {key.split(".")[1] for key in channels if key.startswith(layer.name + ".")}:
            planes = [channels[key] for letter in "RGBAXYZ" if (key := f"{layer.name}.{name}.{letter}") in channels]
            found[name] = planes[0] if len(planes) == 1 else np.stack(planes, axis=-1)
    return layers if len(layers) > 1 else next(iter(layers.values()))


@contextmanager
def kept(owner, *names):
    """Properties of `owner` are as they were after the block."""
    before = {name: getattr(owner, name) for name in names}
    try:
        yield
    finally:
        for name, value in before.items():
            setattr(owner, name, value)


def read_exr(path):
    """The channels of an uncompressed OpenEXR file of floats with one part, {name: float32 [h, w]}, row 0 at the bottom."""
    data = path.read_bytes()
    assert struct.unpack_from("<I", data)[0] == 20000630
    assert data[5] & 0x12 == 0, "one part, scanlines"
    place, attributes = 8, {}
    while data[place]:
        name, kind = data[place:].split(b"\0", 2)[:2]
        place += len(name) + len(kind) + 2
        size, = struct.unpack_from("<i", data, place)
        attributes[name.decode()] = data[place + 4:place + 4 + size]
        place += 4 + size
    assert attributes["compression"] == b"\0"
    names, rest = [], attributes["channels"]
    while rest[0]:
        name, rest = rest.split(b"\0", 1)
        assert struct.unpack_from("<i", rest)[0] == 2, "32-bit floats"
        names.append(name.decode())
        rest = rest[16:]
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    lines = np.frombuffer(data, "<f4", offset=place + 1 + 8 * height).reshape(height, 2 + len(names) * width)
    pixels = lines[::-1, 2:].reshape(height, len(names), width)
    return {name: pixels[:, index] for index, name in enumerate(names)}
