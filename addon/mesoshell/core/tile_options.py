"""How a tile is made of its source: the choices that the panel and the operator offer, as plain values."""

from typing import NamedTuple


class TileOptions(NamedTuple):
    """Lengths are in widths of the source unless they say otherwise; `periodic.py` and `variation.py` say what theirs do."""

    # A height-field image.
    height_low: float = 0.05  # of black
    height_high: float = 0.25  # of white
    most_nodes: int = 256  # a side; larger images are averaged

    # A grid: a volume, or a file that holds one.
    threshold: float = 0.5
    inside: str = 'ABOVE'  # of an array; or 'BELOW': which values are solid. A volume's class says it of itself
    grid_name: str = ""  # empty: "density", or else the active grid
    grid_height: float = 0.0  # of an array; 0: its voxels are cubes

    periodic: str = 'NONE'  # or 'MIRROR', 'BLEND'
    blend_width: float = 0.25  # of the cross-fade along each border, at most 0.45

    copies: int = 1  # a side; 1: no variation
    variation: float = 0.5  # 0 to 1
    seed: int = 0

    thickness: float = 0.0  # of open sheets, in world units; 0: closed solids only
