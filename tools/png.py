"""PNG files from NumPy arrays, without a library."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np


def write_png(path: Path, picture: np.ndarray) -> None:
    """The picture, uint8 [h, w, 3] in sRGB, the top row first.

    Lines hold their differences from the line above (filter 2), which flat regions compress best with.
    """
    height, width, _ = picture.shape
    lines = picture.reshape(height, 3 * width)
    above = np.concatenate([np.zeros_like(lines[:1]), lines[:-1]])
    _write(path, (width, height), 2, b"", np.concatenate([np.full((height, 1), 2, np.uint8), lines - above], axis=1))


def write_indexed_png(path: Path, palette: np.ndarray, index: np.ndarray) -> None:
    """A picture of at most 256 colors: palette uint8 [n, 3] in sRGB, and its rows that index uint8 [h, w] names."""
    height, width = index.shape
    _write(path, (width, height), 3, _chunk(b"PLTE", palette.tobytes()),
           np.concatenate([np.zeros((height, 1), np.uint8), index], axis=1))


def _write(path: Path, size: tuple[int, int], color: int, palette: bytes, lines: np.ndarray) -> None:
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", struct.pack(">IIBBBBB", *size, 8, color, 0, 0, 0)) + palette
                     + _chunk(b"IDAT", zlib.compress(lines.tobytes(), 9)) + _chunk(b"IEND", b""))


def _chunk(kind: bytes, data: bytes) -> bytes:
    """Length, kind, data, checksum."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
