"""Pixels of Blender's images, by foreach_get; row 0 is the bottom one, as v = 0 is."""

from contextlib import contextmanager

import bpy
import numpy as np

# A base color needs no more than the 3D texture it ends in shows; beyond this, whole blocks of pixels are averaged.
MOST_COLOR_PIXELS = 2048  # a side

# Of linear Rec. 709 red, green and blue.
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
_ENCODED = {"sRGB", "sRGB OETF", "sRGB - Texture", "Utility - sRGB - Texture", "sRGB Encoded Rec.709 (sRGB)"}
_NUMBERS = {"Non-Color", "Raw", "Linear", "Linear Rec.709", "Generic Data", "Utility - Raw"}


def is_empty(image):
    """Whether an image has no pixels: its file is missing, or it was never rendered."""
    return image.size[0] == 0 or image.size[1] == 0 or image.channels == 0


def linear_pixels(image):
    """Linear RGB float32 [h, w, 3] of an image that is not empty, at most MOST_COLOR_PIXELS a side."""
    pixels = _pixels(image)[..., :3]
    # Blender hands out the numbers of 8-bit images as they are in the file, and linear ones of all others.
    if not image.is_float and image.colorspace_settings.name in _ENCODED:
        low = pixels <= 0.04045
        pixels = np.where(low, pixels / 12.92, ((np.maximum(pixels, 0.04045) + 0.055) / 1.055) ** 2.4)
    return np.ascontiguousarray(_smaller(pixels, MOST_COLOR_PIXELS), np.float32)


def heights(image, notices):
    """Heights float32 [h, w] of a height-field image: the luminance of its colors, as the numbers that the file holds.

    A height is data: 8-bit images hand out what is stored, encoded or not, and that is taken; set the color space of others
    to Non-Color.

    Raises ValueError for an image without pixels; `notices` gets a sentence where Blender has bent the numbers.
    """
    if is_empty(image):
        raise ValueError(f'The image "{image.name}" has no pixels: reload it (Image > Reload), or pick another one')
    pixels = _pixels(image)
    if image.is_float and image.file_format not in {'OPEN_EXR', 'OPEN_EXR_MULTILAYER', 'HDR'} and (
            image.source == 'FILE' and image.colorspace_settings.name not in _NUMBERS):
        notices.append(f'The image "{image.name}" is read through the color space {image.colorspace_settings.name}, '
                       "which bends heights: set it to Non-Color")
    # In double precision, so that a gray is itself again; in parts, because that takes twice the memory.
    parts = np.array_split(pixels[..., :3], max(1, pixels.shape[0] // 256))
    return np.concatenate([(part @ _LUMINANCE).astype(np.float32) for part in parts])


def red(image):
    """The red channel of an image as numbers from 0 to 1, float32 [h, w], at most MOST_COLOR_PIXELS a side; ValueError."""
    if is_empty(image):
        raise ValueError(f'The image "{image.name}" has no pixels: reload it (Image > Reload), or pick another one')
    return np.ascontiguousarray(np.clip(_smaller(_pixels(image)[..., :1], MOST_COLOR_PIXELS)[..., 0], 0.0, 1.0))


@contextmanager
def heights_file(path):
    """An image of a file, as numbers, while the block runs; ValueError if it is none. Nothing stays in the .blend file."""
    try:
        image = bpy.data.images.load(path)
    except RuntimeError as error:
        raise ValueError(f"The image {path} can not be read: choose another file") from error
    try:
        image.colorspace_settings.name = "Non-Color"
        yield image
    finally:
        bpy.data.images.remove(image)


def _pixels(image):
    """float32 [h, w, channels]; gray ones have three equal channels."""
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, image.channels)
    return np.repeat(pixels[..., :1], 3, axis=2) if image.channels < 3 else pixels


def _smaller(pixels, most):
    factor = -(-max(pixels.shape[:2]) // most)
    if factor == 1:
        return pixels
    height, width = (max(1, side // factor) for side in pixels.shape[:2])
    cut = pixels[:height * factor, :width * factor]
    if cut.shape[0] < height * factor or cut.shape[1] < width * factor:  # an image thinner than one block
        return pixels[::factor, ::factor]
    return cut.reshape(height, factor, width, factor, -1).mean(axis=(1, 3))
