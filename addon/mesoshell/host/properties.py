"""What a .blend file keeps of Mesoshell: which objects are tiles, and which have a shell."""

import bpy
from bpy.props import BoolProperty, FloatProperty, PointerProperty, StringProperty

from . import versions
from .shell_options import ShellOptions, tag_redraw


class MesoshellTile(bpy.types.PropertyGroup):
    """The period of a tile object: [0, period_u] x [0, period_v] x [0, height] of its local space."""

    is_tile: BoolProperty(name="Tile", description="This object is the period of a mesostructure")
    period_u: FloatProperty(name="Period U", description="Along the object's local X", default=1.0, min=0.0,
                            unit='LENGTH')
    period_v: FloatProperty(name="Period V", description="Along the object's local Y", default=1.0, min=0.0,
                            unit='LENGTH')
    height: FloatProperty(name="Height", description="Along the object's local Z; geometry beyond it is clipped",
                          default=0.5, min=0.0, unit='LENGTH')


class MesoshellShell(ShellOptions, bpy.types.PropertyGroup):
    """The shell of a surface object."""

    enabled: BoolProperty(name="Shell", description="Draw the map on this object", update=tag_redraw)
    map_path: StringProperty(name="Map", description="A baked map (.gdm.exr)", subtype='FILE_PATH',
                             options=versions.PATH_OPTIONS, update=tag_redraw)
    thickness_image: PointerProperty(name="Image", description="Its red channel multiplies the thickness; on the same UVs, "
                                     "before tiles are placed", type=bpy.types.Image, update=tag_redraw)


CLASSES = (MesoshellTile, MesoshellShell)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.mesoshell_tile = PointerProperty(type=MesoshellTile)
    bpy.types.Object.mesoshell = PointerProperty(type=MesoshellShell)


def unregister():
    del bpy.types.Object.mesoshell
    del bpy.types.Object.mesoshell_tile
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
