"""A tile's surface as arrays, copied out of wherever it comes from: what the native Sample is made of."""

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class TileSurface:
    """Triangles in metric texture space (tile widths; x has period 1, y period `aspect`, w = 0 at z = 0).

    name           for sentences
    positions      float64 [n, 3]
    triangles      int32 [m, 3], outward
    height, aspect of the tile: in tile widths, and period v / period u
    normals        float32 [m, 3, 3], unit length, a corner; or None: those of the triangles
    colors         linear RGB float32 [m, 3, 3], a corner, that the materials' colors are multiplied with; or None: white
    uvs            float32 [m, 3, 2], for the materials' images; or None
    material_indices  int32 [m], into `materials`; or None without materials
    materials      dicts {"color": (r, g, b), "roughness": f, "metallic": f, "image": None or float32 [h, w, 3]}
    notices        sentences about what was left out or read otherwise than one may expect
    """

    name: str
    positions: np.ndarray
    triangles: np.ndarray
    height: float
    aspect: float = 1.0
    normals: np.ndarray = None
    colors: np.ndarray = None
    uvs: np.ndarray = None
    material_indices: np.ndarray = None
    materials: tuple = ()
    notices: tuple = field(default=())


def check_finite(positions, who):
    """Raises ValueError, in a sentence that starts with `who`, if a position is not a finite number."""
    bad = np.flatnonzero(~np.isfinite(positions).all(axis=1))
    if len(bad):
        raise ValueError(f"{who} has {len(bad)} vertices that are not finite numbers (the first is vertex {bad[0]}): "
                         "delete them, or correct what moved them there")
