"""How a scene bakes, and what from. The bake operator has the same options: what a call does not give, the scene does."""

import bpy
from bpy.props import (EnumProperty, FloatProperty, IntProperty, IntVectorProperty, PointerProperty, StringProperty)

from ..core import presets
from . import instances, versions
from .source_options import ONCE as _ONCE
from .source_options import SourceOptions

LAYOUTS = (
    ("auto", "Best", "The layout with the smallest errors at equal bytes that the memory limit allows"),
    ("nodes", "By Nodes", "A weight a node, eigenmaps over all directions and heights: smaller errors, more lookups"),
    ("paper", "Paper", "A weight a node and azimuth, as in Wang et al. 2004: bakes in any memory"),
    ("share", "Shares", "The paper's, of shares of the way through the tile: fewer wrong hits, errors near the horizon"),
)
PRECISIONS = (
    ("byte", "Byte", "8 bits for nearly all numbers: half the size of halves, and the same errors"),
    ("half", "Half", "16-bit floats in the file"),
    ("float", "Float", "32-bit floats in the file"),
)
_PRESETS = tuple((preset.identifier, preset.label, preset.description, index)
                 for index, preset in enumerate(presets.PRESETS)) + (
    ('CUSTOM', "Custom", "Other numbers, as they stand under Quality", len(presets.PRESETS)),)


def _preset(settings):
    return presets.index_of({name: getattr(settings, name) for name in presets.NAMES})


def _set_preset(settings, index):
    if index < len(presets.PRESETS):
        for name, value in presets.PRESETS[index].values.items():
            setattr(settings, name, value)


class BakeOptions(SourceOptions):
    """Properties that the scene and the operator share."""

    preset: EnumProperty(name="Preset", description="How fine the map is", items=_PRESETS, get=_preset, set=_set_preset,
                         options=_ONCE)
    resolution: IntVectorProperty(name="Nodes", description="Nodes of the GDM along u, v and w", size=3,
                                  default=(64, 64, 32), min=2, max=1024, options=_ONCE)
    directions: IntVectorProperty(name="Directions", description="Directions along theta and phi", size=2,
                                  default=(16, 32), min=2, max=256, options=_ONCE)
    sdf_resolution: IntVectorProperty(name="SDF nodes", description="Nodes of the signed distance field", size=3,
                                      default=(64, 64, 33), min=2, max=1024, options=_ONCE)
    facet_cells: IntProperty(name="Facet cells", description="Cells along u of the facets, by which rays find the surface. "
                             "Along v and w there are so many that cells are nearly cubes", default=64, min=4, max=128,
                             options=_ONCE)
    attribute_resolution: IntVectorProperty(name="Color nodes", description="Nodes of color, roughness, metallic and normal",
                                            size=3, default=(64, 64, 33), min=2, max=1024, options=_ONCE)
    terms: IntProperty(name="Terms", description="Terms of the singular value decomposition to keep; 0: as many as have the "
                       "bytes of the paper's 16", default=0, min=0, max=1024, options=_ONCE)
    layout: EnumProperty(name="Layout", description="Which matrix is decomposed", items=LAYOUTS, default="auto", options=_ONCE)
    precision: EnumProperty(name="Precision", items=PRECISIONS, default="byte", options=_ONCE)
    memory_limit: FloatProperty(name="Memory limit", description="Gigabytes that a bake may take; 0: a quarter of the machine's. "
                                "A bake that needs more goes through in parts, which takes longer", default=0.0, min=0.0,
                                soft_max=256.0, precision=1, options=_ONCE)

    def quality(self, value):
        """Arguments of a BakeRequest and of an estimate; `value(name)` is what holds for a property."""
        names = ("resolution", "directions", "sdf_resolution", "attribute_resolution")
        return {name: tuple(value(name)) for name in names} | {
            "facet_cells": value("facet_cells"), "terms": value("terms"), "layout": value("layout"), "precision": value("precision"),
            "memory": 1e9 * value("memory_limit")}


def _shows_surface(_self, obj):
    return obj.type in instances.SOURCE_TYPES


def _is_empty(_self, obj):
    return obj.type == 'EMPTY'


class MesoshellBake(BakeOptions, bpy.types.PropertyGroup):
    """How a scene bakes; the operator's defaults."""

    tile: PointerProperty(name="Tile", description="The object to bake", type=bpy.types.Object, poll=_shows_surface)
    tile_collection: PointerProperty(name="Collection", description="The collection to bake as one tile",
                                     type=bpy.types.Collection)
    box: PointerProperty(name="Box", description="The empty that shows one period of the tile; without one, the period that "
                         "the object itself holds", type=bpy.types.Object, poll=_is_empty)
    image: PointerProperty(name="Image", description="The height field to bake", type=bpy.types.Image)
    output_path: StringProperty(name="Map", description="Where the bake is saved", subtype='FILE_PATH',
                                options=versions.PATH_OPTIONS, default="//tile.gdm.exr")


def register():
    bpy.utils.register_class(MesoshellBake)
    bpy.types.Scene.mesoshell = PointerProperty(type=MesoshellBake)


def unregister():
    del bpy.types.Scene.mesoshell
    bpy.utils.unregister_class(MesoshellBake)
