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
