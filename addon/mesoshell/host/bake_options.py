"""How a scene bakes, and what from. The bake operator has the same options: what a call does not give, the scene does."""

import bpy
from bpy.props import (EnumProperty, FloatProperty, IntProperty, IntVectorProperty, PointerProperty, StringProperty)

from ..core import presets
from . import instances, versions
from .source_options import ONCE as _ONCE
from .source_options import SourceOptions

PRECISIONS = (
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
    terms: IntProperty(name="Terms", description="Terms of the singular value decomposition to keep", default=16,
                       min=1, max=1024, options=_ONCE)
    precision: EnumProperty(name="Precision", items=PRECISIONS, default="half", options=_ONCE)


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
