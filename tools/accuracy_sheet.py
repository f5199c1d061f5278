"""The contact sheet of ./dev accuracy: pictures beside the truth, and where and how they differ from it."""

from __future__ import annotations

import numpy as np
from pixel_font import draw_text

MARGIN, GAP, LINE, HEADER = 118, 6, 11, 34
PAPER, INK, FAINT = (16, 17, 20), (236, 236, 236), (150, 152, 158)
BESIDE, THROUGH = (24, 25, 29), (48, 50, 56)  # rays beside the shell; rays through it that hit nothing in both

# Depth errors of -1, 0 and 1 voxel; farther ones look like those ends.
NEARER, EQUAL, FARTHER = np.array((24, 96, 190)), np.array((238, 238, 236)), np.array((230, 97, 10))
FALSE_HIT, FALSE_MISS = (20, 190, 60), (225, 0, 200)

TOWARD_SUN = np.array([0.40, -0.45, 0.80]) / np.linalg.norm([0.40, -0.45, 0.80])


def shaded(picture, meets):
    """A picture by its normals alone, uint8 [h, w, 3], the top row first: what differs in it differs in hits or normals."""
    light = 0.12 + 0.8 * np.maximum(np.asarray(picture["normal"], float) @ TOWARD_SUN, 0.0)
    encoded = 1.055 * np.maximum(0.75 * light, 1e-9) ** (1 / 2.4) - 0.055
    color = np.where((picture["hit"] == 1)[..., None], np.round(255 * np.clip(encoded, 0, 1))[..., None],
                     np.where(meets[..., None], THROUGH, BESIDE))
    return color.astype(np.uint8)[::-1]


def signed_colors(error):
    """Colors, float64 [..., 3], of depth errors in voxels."""
    share = np.clip(error, -1.0, 1.0)[..., None]
    return EQUAL + np.where(share < 0, (NEARER - EQUAL) * -share, (FARTHER - EQUAL) * share)


def difference(picture, truth, depth, meets):
    """As `shaded`: depth errors [h, w] (voxels, NaN unless both hit) as colors, strong ones where only one of both hits."""
    hit, true_hit = picture["hit"] == 1, truth["hit"] == 1
    color = np.where(meets[..., None], THROUGH, BESIDE).astype(float)
    both = hit & true_hit
    color[both] = signed_colors(depth[both])
    color[hit & ~true_hit] = FALSE_HIT
    color[~hit & true_hit] = FALSE_MISS
    return np.round(color).astype(np.uint8)[::-1]


def legend_strip(width):
    """What the colors mean, uint8 [h, width, 3]; as many lines as the width needs."""
    swatch, line, ramp = 26, 24, 160
    items = [(ramp, "depth error in voxels, -1 to +1: too near is blue, too far orange"), (FALSE_HIT, "hit, truth has none"),
             (FALSE_MISS, "no hit, truth has one"), (THROUGH, "through the shell"), (BESIDE, "beside it")]
    strip = np.full((10, width, 3), PAPER, np.uint8)
    left = width
    for color, text in items:
        sample = ramp if color is ramp else swatch
        needed = sample + 8 + 6 * len(text) + 20
        if left + needed > width:
            strip = np.concatenate([strip, np.full((line, width, 3), PAPER, np.uint8)])
            left = 8
        box = strip[-line:-line + 14, left:left + sample]
        box[:] = FAINT  # an outline, for colors close to the paper's
        inside = box[1:-1, 1:-1]
        inside[:] = np.round(signed_colors(np.linspace(-1, 1, inside.shape[1]))) if color is ramp else color
        draw_text(strip, text, left + sample + 8, len(strip) - line + 4, INK)
        left += needed
    return strip


def wrapped(words, width):
    """The words in lines of at most `width` pixels, two spaces apart; a word that is longer has a line of its own."""
    lines = []
    for word in words:
        if lines and 6 * (len(lines[-1]) + 2 + len(word)) <= width:
            lines[-1] += "  " + word
        else:
            lines.append(word)
    return lines


def row(name, cells):
    """One scene: its name (lines) and its cells (picture, words of a caption), pictures of equal height; uint8 [h, w, 3]."""
    height, width = cells[0][0].shape[:2]
    captions = [wrapped(words, width + GAP) for _, words in cells]
    high = max(height + 3 + LINE * max(map(len, captions)), 60) + GAP
    strip = np.full((high, MARGIN + len(cells) * (width + GAP), 3), PAPER, np.uint8)
    for number, line in enumerate(name):
        draw_text(strip, line, 8, 4 + 18 * number, INK, 2)
    for number, ((picture, _), lines) in enumerate(zip(cells, captions)):
        left = MARGIN + number * (width + GAP)
        strip[:height, left:left + width] = picture
        for index, line in enumerate(lines):
            draw_text(strip, line, left, height + 3 + LINE * index, FAINT)
    return strip


def sheet(columns, rows):
    """The whole sheet of rows made by `row`, under the columns' names and the legend."""
    width = max(part.shape[1] for part in rows)
    cell = (rows[0].shape[1] - MARGIN) // len(columns)
    header = np.full((HEADER, width, 3), PAPER, np.uint8)
    for number, name in enumerate(columns):
        draw_text(header, name, MARGIN + number * cell, 10, INK, 2 if 12 * len(name) < cell else 1)
    padded = [np.pad(part, ((0, 0), (0, width - part.shape[1]), (0, 0))) for part in rows]
    return np.concatenate([legend_strip(width), header, *padded])


def cropped(pictures, meets):
    """The pictures, top row first, without the rows above and below the shell; row 0 of `meets` is the bottom."""
    inside = np.flatnonzero(meets[::-1].any(axis=1))
    first, last = (0, len(meets)) if len(inside) == 0 else (inside[0], inside[-1] + 1)
    return [picture[first:last] for picture in pictures]
