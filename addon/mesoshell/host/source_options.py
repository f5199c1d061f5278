"""How a tile is made of its source: core/tile_options.py's choices by name, as properties of scene and operator."""

from bpy.props import EnumProperty, FloatProperty, IntProperty, StringProperty

from ..core.periodic import MOST_BLEND
from ..core.tile_options import TileOptions
from ..core.variation import MOST_COPIES
from . import versions

SOURCES = (
    ('OBJECT', "Object", "One object, with its modifiers and all that it instances"),
    ('SELECTION', "Selection", "All selected objects together"),
    ('COLLECTION', "Collection", "All visible objects of a collection, and of those in it"),
    ('IMAGE', "Image", "A height field: an image, solid below"),
    ('FILE', "File", "A grid: an OpenVDB file (.vdb), or an array [nz, ny, nx] of NumPy's (.npy)"),
)
_INSIDE = (
    ('ABOVE', "Above", "Values above the threshold are solid, as in a density"),
    ('BELOW', "Below", "Values below the threshold are solid, as in a level set or signed distances"),
)
_PERIODIC = (
    ('NONE', "As It Is", "The source is periodic: what leaves a side comes back on the other"),
    ('MIRROR', "Mirror", "2 × 2 mirrored copies. Of objects, what stands over the sides of the box is cut off"),
    ('BLEND', "Blend", "Cross-fade the borders into each other; for images and arrays"),
)
# SKIP_SAVE speaks of operators only: a button must not repeat what the last script asked for.
ONCE = {'SKIP_SAVE'}
_DEFAULTS = TileOptions()


def _with_default(kind, field, /, **arguments):
    return kind(default=getattr(_DEFAULTS, field), options=ONCE, **arguments)


class SourceOptions:
    """Properties that the scene and the operator share: those of TileOptions by name, and what the source is."""

    source: EnumProperty(name="Source", description="What the tile is", items=SOURCES, default='OBJECT', options=ONCE)
    grid_path: StringProperty(name="Grid", description="A .vdb file, or a .npy file of NumPy's", subtype='FILE_PATH',
                              options=ONCE | versions.PATH_OPTIONS)

    height_low: _with_default(FloatProperty, "height_low", name="Black Height", min=0.0, soft_max=1.0, precision=3,
                              description="Height of black above the base, in widths of the image")
    height_high: _with_default(FloatProperty, "height_high", name="White Height", min=0.0, soft_max=1.0, precision=3,
                               description="Height of white above the base, in widths of the image. Stored values are taken "
                               "as they are: a height is data, not a color")
    most_nodes: _with_default(IntProperty, "most_nodes", name="Most Nodes", min=4, soft_max=1024, max=4096,
                              description="A side; pixels of larger images are averaged")

    threshold: _with_default(FloatProperty, "threshold", name="Threshold",
                             description="Where the surface of a grid is: 0 for a level set, about half of what is dense "
                             "for a density")
    inside: _with_default(EnumProperty, "inside", name="Solid", items=_INSIDE, description="Which values of an array are "
                          "solid; OpenVDB's grids say so themselves")
    grid_name: _with_default(StringProperty, "grid_name", name="Grid Name", description="Which grid of a volume it is; if "
                             "empty, \"density\" or the active one")
    grid_height: _with_default(FloatProperty, "grid_height", name="Grid Height", min=0.0, soft_max=2.0,
                               description="Height of an array, in its widths; 0: its voxels are cubes")

    periodic: _with_default(EnumProperty, "periodic", name="Periodic", items=_PERIODIC,
                            description="What is done to a source whose borders do not match")
    blend_width: _with_default(FloatProperty, "blend_width", name="Blend Width", min=0.01, max=MOST_BLEND,
                               description="Of the cross-fade along each border, in tile widths")
    copies: _with_default(IntProperty, "copies", name="Copies", min=1, max=MOST_COPIES,
                          description="A side, each bent in its own way, so that repetition is not seen. Nodes are spread "
                          "over all of them; 1: no variation")
    variation: _with_default(FloatProperty, "variation", name="Variation", min=0.0, max=1.0, subtype='FACTOR',
                             description="How far the copies are bent; 0: not at all")
    seed: _with_default(IntProperty, "seed", name="Seed", min=0, description="Other copies, just as good")
    thickness: _with_default(FloatProperty, "thickness", name="Sheet Thickness", min=0.0, soft_max=1.0, unit='LENGTH',
                             precision=4, description="Open parts of a mesh become sheets of this thickness, half of it to "
                             "either side; 0: only what is closed is solid")


def options(value):
    """The TileOptions that `value(name)` gives."""
    return TileOptions(**{name: value(name) for name in TileOptions._fields})


def from_scene(context):
    """The TileOptions of the scene's settings."""
    return options(lambda name: getattr(context.scene.mesoshell, name))
