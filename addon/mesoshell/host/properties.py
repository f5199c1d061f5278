"""What a .blend file keeps of Mesoshell: which objects are tiles, and which have a shell."""

import bpy
from bpy.props import (BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, PointerProperty,
                       StringProperty)

from . import versions

SCHEMES = (
    ("catmark", "Catmull-Clark", "Subdivide quads and polygons"),
    ("loop", "Loop", "Subdivide triangles; other faces are triangulated first"),
    ("bilinear", "Bilinear", "Split faces without smoothing them"),
)
TRAVERSALS = (
    ("gdm", "GDM", "One lookup of the generalized displacement map a prism"),
    ("sdf", "SDF", "Sphere tracing of the tile's signed distance field"),
)

def tag_redraw(_self=None, _context=None):
    """Draws every 3D view again; also an update callback. What is drawn compares settings and finds the change itself."""
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for area in window.screen.areas:
                if area.type == 'VIEW_3D':
                    area.tag_redraw()


class MesoshellTile(bpy.types.PropertyGroup):
    """The period of a tile object: [0, period_u] x [0, period_v] x [0, height] of its local space."""

    is_tile: BoolProperty(name="Tile", description="This object is the period of a mesostructure")
    period_u: FloatProperty(name="Period U", description="Along the object's local X", default=1.0, min=0.0,
                            unit='LENGTH')
    period_v: FloatProperty(name="Period V", description="Along the object's local Y", default=1.0, min=0.0,
                            unit='LENGTH')
    height: FloatProperty(name="Height", description="Along the object's local Z; geometry beyond it is clipped",
                          default=0.5, min=0.0, unit='LENGTH')


class MesoshellShell(bpy.types.PropertyGroup):
    """The shell of a surface object."""

    enabled: BoolProperty(name="Shell", description="Draw the map on this object", update=tag_redraw)
    map_path: StringProperty(name="Map", description="A baked map (.gdm.exr)", subtype='FILE_PATH',
                             options=versions.PATH_OPTIONS, update=tag_redraw)
    thickness: FloatProperty(name="Thickness", description="Of the shell, in the object's own units", default=0.1,
                             min=0.0, soft_max=10.0, unit='LENGTH', precision=4, update=tag_redraw)
    levels: IntProperty(name="Levels", description="Subdivisions of the surface before the shell is built", default=0,
                        min=0, max=5, update=tag_redraw)
    scheme: EnumProperty(name="Scheme", description="Subdivision scheme", items=SCHEMES, default="catmark",
                         update=tag_redraw)
    tiles_u: FloatProperty(name="Tiles U", description="Tiles along one unit of U", default=1.0, min=0.001,
                           soft_max=100.0, update=tag_redraw)
    tiles_v: FloatProperty(name="Tiles V", description="Tiles along one unit of V", default=1.0, min=0.001,
                           soft_max=100.0, update=tag_redraw)
    traversal: EnumProperty(name="Traversal", description="How a ray finds the surface", items=TRAVERSALS,
                            default="sdf", update=tag_redraw)
    base_color: FloatVectorProperty(name="Color", description="Reflectance, linear", subtype='COLOR', size=3,
                                    default=(0.55, 0.56, 0.58), min=0.0, max=1.0, update=tag_redraw)


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
