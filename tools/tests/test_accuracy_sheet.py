"""The contact sheet: colors say what they are to say, and a PNG holds the picture."""

import struct
import zlib

import accuracy_sheet as sheet
import numpy as np
import pixel_font
from png import write_indexed_png, write_png


def read_png(path):
    """Pixels of a PNG as png.py makes them, by the format's rules: chunks with checksums, lines with a filter each."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    place, parts = 8, {}
    while place < len(data):
        length, kind = struct.unpack(">I4s", data[place:place + 8])
        body = data[place + 8:place + 8 + length]
        assert struct.unpack(">I", data[place + 8 + length:place + 12 + length])[0] == zlib.crc32(kind + body)
        parts[kind] = body
        place += 12 + length
    assert list(parts)[0] == b"IHDR" and list(parts)[-1] == b"IEND" and parts[b"IEND"] == b""
    width, height, bits, color, *rest = struct.unpack(">IIBBBBB", parts[b"IHDR"])
    assert bits == 8 and rest == [0, 0, 0]
    lines = np.frombuffer(zlib.decompress(parts[b"IDAT"]), np.uint8).reshape(height, -1)
    filters, values = lines[:, 0], lines[:, 1:]
    if color == 3:
        assert (filters == 0).all()
        return np.frombuffer(parts[b"PLTE"], np.uint8).reshape(-1, 3)[values]
    assert color == 2 and (filters == 2).all()
    return np.cumsum(values.astype(int), axis=0).astype(np.uint8).reshape(height, width, 3)


def test_png_holds_the_picture(tmp_path):
    pixels = np.random.default_rng(1).integers(0, 256, (13, 7, 3)).astype(np.uint8)
    write_png(tmp_path / "a.png", pixels)
    assert (read_png(tmp_path / "a.png") == pixels).all()


def test_png_with_a_palette_holds_the_picture(tmp_path):
    random = np.random.default_rng(2)
    palette, index = random.integers(0, 256, (40, 3)).astype(np.uint8), random.integers(0, 40, (6, 11)).astype(np.uint8)
    write_indexed_png(tmp_path / "a.png", palette, index)
    assert (read_png(tmp_path / "a.png") == palette[index]).all()


def test_signs_are_told_apart_and_nothing_lies_beyond_a_voxel():
    near, none, far = sheet.signed_colors(np.array([-1.0, 0.0, 1.0]))
    assert near[2] > near[0] and far[0] > far[2] and np.ptp(none) < 8
    np.testing.assert_array_equal(sheet.signed_colors(np.array([-7.0, 30.0])), [near, far])
    np.testing.assert_allclose(sheet.signed_colors(np.array([0.5])), [(none + far) / 2])


def test_every_pixel_of_a_difference_has_its_kind():
    """Row 0 of a picture is its bottom, row 0 of an image its top."""
    hit, true_hit = np.array([[1, 1, 0], [0, 0, 0]]), np.array([[1, 0, 1], [0, 0, 0]])
    meets = np.array([[True] * 3, [True, False, False]])
    depth = np.where((hit & true_hit) == 1, 0.0, np.nan)
    image = sheet.difference({"hit": hit}, {"hit": true_hit}, depth, meets)
    assert image.tolist() == [[[*sheet.THROUGH], [*sheet.BESIDE], [*sheet.BESIDE]],
                              [[*sheet.EQUAL], [*sheet.FALSE_HIT], [*sheet.FALSE_MISS]]]


def test_a_sheet_has_room_for_all():
    cells = [(np.full((30, 50, 3), 9 * k, np.uint8), ["IoU 0.9990", "fetch 12"]) for k in range(3)]
    strip = sheet.row(("chain", "torus", "35 deg"), cells)
    whole = sheet.sheet(["exact", "sdf", "difference"], [strip, strip])
    for k in range(3):
        left = sheet.MARGIN + k * (50 + sheet.GAP)
        assert (strip[:30, left:left + 50] == 9 * k).all()
    assert whole.shape[1] == strip.shape[1] and (whole[-2 * len(strip):-len(strip)] == strip).all()


def test_rows_beside_the_shell_are_cut_off():
    meets = np.zeros((10, 4), bool)
    meets[2:5] = True
    image = np.repeat(np.arange(10, dtype=np.uint8)[:, None], 4, axis=1)
    assert sheet.cropped([image], meets)[0][:, 0].tolist() == [5, 6, 7]


def test_letters_differ_and_words_are_as_wide_as_they_say():
    shapes = {pixel_font.GLYPHS[letter].tobytes() for letter in pixel_font.GLYPHS}
    assert len(shapes) == len(pixel_font.GLYPHS)
    assert pixel_font.text_mask("IoU 0.99", 2).shape == (14, 96)
    assert sheet.wrapped(["aa", "bbb", "cccc"], 6 * 7) == ["aa  bbb", "cccc"]
