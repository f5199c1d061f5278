"""A tile's surface as arrays, copied out of wherever it comes from: what the native Sample is made of."""

from dataclasses import dataclass, field, replace

import numpy as np

_CORNER_ARRAYS = ("normals", "colors", "uvs")


@dataclass(frozen=True)
class TileSurface:
    """Triangles in metric texture space (tile widths; x has period 1, y period `aspect`, w = 0 at z = 0).

    name           for sentences
    positions      float64 [n, 3]
    triangles      int32 [m, 3], outward
    height, aspect of the tile: in tile widths, and period v / period u
    thickness      tile widths: open parts become sheets of it; 0: only what is closed has an inside
    normals        float32 [m, 3, 3], unit length, a corner; or None: those of the triangles
    colors         linear RGB float32 [m, 3, 3], a corner, that the materials' colors are multiplied with; or None: white
    uvs            float32 [m, 3, 2], for the materials' images; or None
    material_indices  int32 [m], into `materials`; or None without materials
    materials      dicts {"color": (r, g, b), "roughness": f, "metallic": f, "image": None or float32 [h, w, 3]}
    slots          int32 [m], into `slot_names`; or None
    slot_names     what the host calls its materials; None where there is none
    color_name, uv_name  what the host calls the colors and the UVs; empty if they have no name
    notices        sentences about what was left out or read otherwise than one may expect
    """

    name: str
    positions: np.ndarray
    triangles: np.ndarray
    height: float
    aspect: float = 1.0
    thickness: float = 0.0
    normals: np.ndarray = None
    colors: np.ndarray = None
    uvs: np.ndarray = None
    material_indices: np.ndarray = None
    materials: tuple = ()
    slots: np.ndarray = None
    slot_names: tuple = ()
    color_name: str = ""
    uv_name: str = ""
    notices: tuple = field(default=())

    def rebuilt(self, positions, triangles, source, *, weights=None, corners=None, **changes):
        """A copy of other triangles, each a part of one of these, with what corners and materials say of it.

        source   int [m], the triangle that each is part of
        weights  float [m, 3, 3], how much of each of its corners a corner is; or else `corners`, int [3], which one it is
        """
        for name in _CORNER_ARRAYS:
            values = getattr(self, name)
            if values is None:
                continue
            values = values[source]
            values = values[:, corners] if weights is None else np.einsum("mij,mjk->mik", weights, values)
            if name == "normals":
                values = values / np.maximum(np.linalg.norm(values, axis=-1, keepdims=True), 1e-30)
            changes.setdefault(name, values.astype(np.float32))
        for name in ("material_indices", "slots"):
            if getattr(self, name) is not None:
                changes[name] = getattr(self, name)[source]
        return replace(self, positions=positions, triangles=np.ascontiguousarray(triangles, np.int32), **changes)


def check_finite(positions, who):
    """Raises ValueError, in a sentence that starts with `who`, if a position is not a finite number."""
    bad = np.flatnonzero(~np.isfinite(positions).all(axis=1))
    if len(bad):
        raise ValueError(f"{who} has {len(bad)} vertices that are not finite numbers (the first is vertex {bad[0]}): "
                         "delete them, or correct what moved them there")
