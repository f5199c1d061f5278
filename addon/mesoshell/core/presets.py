"""Named sets of resolutions: how fine each part of a map is."""

from typing import NamedTuple


class Preset(NamedTuple):
    identifier: str
    label: str
    description: str
    values: dict


def _preset(identifier, label, description, nodes, directions, sdf, cells):
    return Preset(identifier, label, description, {
        "resolution": nodes, "directions": directions, "sdf_resolution": sdf, "facet_cells": cells, "attribute_resolution": sdf})


PRESETS = (
    _preset('DRAFT', "Draft", "32 × 32 × 16 nodes, 8 × 16 directions: to see whether the tile is right",
            (32, 32, 16), (8, 16), (32, 32, 17), 32),
    _preset('PAPER', "Paper", "64 × 64 × 32 nodes, 16 × 32 directions, as in Wang et al. 2004",
            (64, 64, 32), (16, 32), (64, 64, 33), 64),
    _preset('HIGH', "High", "128 × 128 × 64 nodes, 32 × 64 directions",
            (128, 128, 64), (32, 64), (128, 128, 65), 80),
)
NAMES = tuple(PRESETS[0].values)


def _plain(value):
    return value if isinstance(value, int) else tuple(value)


def index_of(values):
    """Index of the preset that has these values of NAMES, or the number of presets."""
    for index, preset in enumerate(PRESETS):
        if all(_plain(values[name]) == preset.values[name] for name in NAMES):
            return index
    return len(PRESETS)
