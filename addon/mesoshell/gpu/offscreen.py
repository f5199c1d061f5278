"""Pictures without a window: shells drawn into a float framebuffer and read back."""

import gpu
import numpy

from . import draw, resources


def picture(instances, clip_from_world, size, lights=None, *, output="color", before=None):
    """A picture of ShellInstances: (color float32 [h, w, 4] linear, depth float32 [h, w]); row 0 is the bottom.

    `size` is (width, height); `output` as in draw.OUTPUTS; `before` is called first, to draw what occludes the shells. Needs
    a GPU: on Blender before 5, a window.
    """
    width, height = size
    color = gpu.types.GPUTexture(size, format="RGBA32F")
    depth = gpu.types.GPUTexture(size, format="DEPTH_COMPONENT32F")
    target = gpu.types.GPUFrameBuffer(color_slots=color, depth_slot=depth)
    with target.bind():
        target.clear(color=(0.0, 0.0, 0.0, 0.0), depth=1.0)
        if before is not None:
            before()
        for instance in instances:
            draw.draw_shell(instance, clip_from_world, lights, output=output)
        pixels = target.read_color(0, 0, width, height, 4, 0, "FLOAT")
        depths = target.read_depth(0, 0, width, height)
    resources.end_draw()
    return _array(pixels, (height, width, 4)), _array(depths, (height, width))


def _array(buffer, shape):
    """A float32 copy; Blender 3.4 exports only flat buffers rightly."""
    buffer.dimensions = int(numpy.prod(shape))
    return numpy.array(buffer, numpy.float32).reshape(shape)
