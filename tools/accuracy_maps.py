"""The maps that ./dev accuracy measures, baked once a module and tile, and what each traversal reads of them."""

from __future__ import annotations

import hashlib
import json
import shutil
from dataclasses import dataclass

from common import BUILD, STAGE

CACHE = BUILD / "accuracy"
LIBRARY = STAGE / "mesoshell_native.libs" / "libmesoshell.so"

# The distance fields: the default of the add-on, and one of twice the nodes each way, 2.1 MB in halves.
FIELDS = {"default": (64, 64, 33), "fine": (128, 128, 65)}

# What a traversal and the normal at its hit read.
READS = {"gdm": ("terms", "sdf"), "sdf": ("sdf",), "refined": ("facets", "sdf"), "march": ("density", "sdf"),
         "slices": ("density", "sdf"), "exact": ("triangles",)}



@dataclass(frozen=True)
class Variant:
    """A traversal on one of the maps: a row of the table."""

    traversal: str
    field: str = "default"

    @property
    def name(self):
        return self.traversal + ("" if self.field == "default" else f" {self.field}")

    @property
    def in_sheet(self):
        """Whether pictures of it are shown: one for each traversal, so that they stay large enough to look at."""
        return self.field == "default"


def variants_of(traversals):
    """All that is measured, in the table's order: each traversal, and sphere tracing in finer fields to judge `refined` by."""
    return [Variant(traversal, field) for traversal in traversals for field in (FIELDS if traversal == "sdf" else ["default"])]


def sample_of(native, tile):
    return native.Sample(tile.positions, tile.triangles, height=tile.height, aspect=tile.aspect)


def tile_map(native, tile, sample, variant, small=False):
    """The variant's map of the tile, from the cache where it is there. `small`: few nodes and terms of the GDM."""
    settings = {"sdf": FIELDS[variant.field], "small": small}
    folder = CACHE / hashlib.sha256(LIBRARY.read_bytes()).hexdigest()[:16]
    key = hashlib.sha256(json.dumps([settings, tile.height, tile.aspect]).encode())
    key.update(tile.positions.tobytes() + tile.triangles.tobytes())
    path = folder / f"{tile.name}-{key.hexdigest()[:16]}.exr"
    if not path.is_file():
        forget_others(folder)
        grid = {"resolution": (32, 32, 16), "directions": (8, 12), "terms": 8} if small else {}
        native.bake_map(sample, sdf=native.bake_sdf(sample, resolution=FIELDS[variant.field]),
                        facets=native.bake_facets(sample), **grid).save(str(path))
    # Always as a file holds it, so that a run from the cache is the run that filled it.
    return native.load(str(path))


def forget_others(folder):
    """Makes the cache of this module and removes those of others, which nothing asks for again."""
    folder.mkdir(parents=True, exist_ok=True)
    for other in CACHE.iterdir():
        if other.is_dir() and other != folder:
            shutil.rmtree(other)


def data_bytes(native, traversal, a_map, sample):
    """Bytes of what the traversal reads: terms as they are compressed, distances in halves, densities in bytes."""
    nodes = a_map.sdf.size
    sizes = {
        "terms": lambda: native.plan_bake(resolution=a_map.resolution, directions=a_map.directions, terms=a_map.terms,
                                          layout=a_map.layout, precision=a_map.precision)["term_bytes"],
        "sdf": lambda: 2 * nodes,
        "density": lambda: nodes,
        "facets": lambda: a_map.facets.nbytes,
        "triangles": lambda: 12 * (sample.vertex_count + sample.triangle_count),
    }
    return int(sum(sizes[part]() for part in READS[traversal]))
