"""What the X server shows, read from it: on some drivers Blender's own screenshot reads a front buffer that stays black."""

import ctypes
import ctypes.util
import time

import numpy as np


class _XImage(ctypes.Structure):
    # The beginning of Xlib's XImage; what follows is not read.
    _fields_ = [("width", ctypes.c_int), ("height", ctypes.c_int), ("xoffset", ctypes.c_int), ("format", ctypes.c_int),
                ("data", ctypes.POINTER(ctypes.c_ubyte)), ("byte_order", ctypes.c_int), ("bitmap_unit", ctypes.c_int),
                ("bitmap_bit_order", ctypes.c_int), ("bitmap_pad", ctypes.c_int), ("depth", ctypes.c_int),
                ("bytes_per_line", ctypes.c_int), ("bits_per_pixel", ctypes.c_int)]


def read():
    """The whole screen of DISPLAY: float32 [height, width, 3] as displayed (sRGB), row 0 at the bottom.

    Raises RuntimeError where there is no X server, or one without 24-bit color.
    """
    library = ctypes.util.find_library("X11") or "libX11.so.6"
    x11 = ctypes.CDLL(library)
    for function in (x11.XOpenDisplay, x11.XGetImage):
        function.restype = ctypes.c_void_p
    x11.XDefaultRootWindow.restype = ctypes.c_ulong
    display = x11.XOpenDisplay(None)
    if not display:
        raise RuntimeError("There is no X server to read the screen of: set DISPLAY, or start under xvfb-run")
    display = ctypes.c_void_p(display)
    try:
        width, height = x11.XDisplayWidth(display, 0), x11.XDisplayHeight(display, 0)
        root = ctypes.c_ulong(x11.XDefaultRootWindow(display))
        all_planes, z_pixmap = ctypes.c_ulong(2**64 - 1), 2
        address = x11.XGetImage(display, root, 0, 0, width, height, all_planes, z_pixmap)
        if not address:
            raise RuntimeError("The X server does not let its screen be read")
        image = ctypes.cast(ctypes.c_void_p(address), ctypes.POINTER(_XImage))
        if image.contents.bits_per_pixel != 32:
            raise RuntimeError(f"The screen has {image.contents.bits_per_pixel} bits a pixel; give xvfb-run a depth of 24")
        rows = np.ctypeslib.as_array(image.contents.data, (height, image.contents.bytes_per_line))
        pixels = rows[::-1, : 4 * width].reshape(height, width, 4)[..., 2::-1].astype(np.float32) / 255.0
        x11.XDestroyImage(image)
    finally:
        x11.XCloseDisplay(display)
    return pixels


def region(region):
    """What the screen shows of a region of Blender's only window, as read()."""
    import bpy

    window = bpy.context.window_manager.windows[0]
    left, bottom = window.x + region.x, window.y + region.y
    # Drivers present on a thread of their own: what stays as it is has arrived.
    screen = read()
    while True:
        time.sleep(0.1)
        before, screen = screen, read()
        if np.array_equal(before, screen):
            return screen[bottom : bottom + region.height, left : left + region.width]


def looks_like(shown, linear):
    """Where a picture of the screen has the linear colors [h, w, 3], as a handler drew them: bool [h, w].

    Blender encodes them by sRGB's curve or, in 3.4, by the power 1/2.2, which is up to 0.033 away in the darkest tones: what
    lies between the two is right. 8-bit color is rounded twice.
    """
    linear = np.clip(linear, 0.0, 1.0)
    curve = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)
    power = linear ** (1 / 2.2)
    tolerance = 2.0 / 255.0
    between = (shown >= np.minimum(curve, power) - tolerance) & (shown <= np.maximum(curve, power) + tolerance)
    return between.all(axis=-1)
