"""How a shell is made on a surface: properties that the object and the operator Add Shell share, and what they may be.

Names of the native module's choices are its own; `MODIFIER_UV_RULES` and the like say what Blender's Subdivision Surface
modifier calls them.
"""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, StringProperty

# SKIP_SAVE speaks of operators only: a button must not repeat what the last script asked for.
_ONCE = {'SKIP_SAVE'}

SURFACES = (
    ('EVALUATED', "Evaluated", "The mesh with all its modifiers, as Blender shows it"),
    ('CAGE', "Control Cage", "The mesh without the Subdivision Surface modifiers at the end of its stack: the shell finds "
     "the limit itself. In Edit mode, the mesh that is edited"),
)
SUBDIVISIONS = (
    ('OWN', "Own", "As given here"),
    ('MODIFIER', "As the Modifier", "Levels, scheme, creases and smoothing of the object's Subdivision Surface modifier"),
)
SCHEMES = (
    ("catmark", "Catmull-Clark", "Subdivide quads and polygons"),
    ("loop", "Loop", "Subdivide triangles; other faces are triangulated first"),
    ("bilinear", "Bilinear", "Split faces without smoothing them"),
)
BOUNDARIES = (
    ("edges_and_corners", "Keep Corners", "Boundaries are smooth curves, but corners of a single face stay sharp"),
    ("edges", "All", "Boundaries are smooth curves, corners too"),
)
UV_RULES = (
    ("linear", "None", "UVs are not smoothed"),
    ("corners", "Keep Corners", "UVs are smoothed, corners of islands are kept"),
    ("corners_and_junctions", "Keep Corners, Junctions",
     "UVs are smoothed, corners of islands and where islands meet are kept"),
    ("corners_junctions_and_concave", "Keep Corners, Junctions, Concave",
     "UVs are smoothed, corners of islands, where islands meet, and darts and concave corners are kept"),
    ("boundaries", "Keep Boundaries", "UVs are smoothed, boundaries of islands are kept"),
    ("smooth", "All", "UVs and the boundaries of their islands are smoothed"),
)
REFINEMENTS = (
    ('LEVELS', "Levels", "Every face is split equally often"),
    ('LENGTH', "Edge Length", "Faces are split until their edges are short enough in the scene"),
    ('SCREEN', "Pixels", "Faces are split until their edges are short enough in what the scene's camera renders"),
)
PARTS = (
    ('ALL', "Whole Mesh", "Every face has prisms"),
    ('MATERIAL', "Material", "Faces of one material; a number is a slot, counted from 0"),
    ('VERTEX_GROUP', "Vertex Group", "Faces all of whose corners weigh a half or more"),
    ('ATTRIBUTE', "Attribute", "Faces that an attribute marks: true, a whole number that is not 0, or a half and more; "
     "of an attribute of vertices or corners, all of a face's"),
)
OFFSETS = (
    ("outward", "Outward", "From the surface along its normal"),
    ("centered", "Centered", "Half to either side of the surface"),
    ("inward", "Inward", "From the surface against its normal; the tile's top is on the surface"),
)
PLACEMENTS = (
    ('UV', "Tiles per UV Unit", "Tiles are counted in the UV map"),
    ('METER', "Tiles per Meter", "Tiles have a size in the scene, by the mean size of the UV map on the mesh at rest"),
)
FINS = (
    ("exact", "Bilinear", "Sides of prisms are bilinear patches, shared exactly by neighbors"),
    ("paper", "Two Planes", "Sides of prisms are two planes each, as in Wang et al. 2004"),
)
TRAVERSALS = (
    ("gdm", "GDM", "One lookup of the generalized displacement map a prism"),
    ("sdf", "SDF", "Sphere tracing of the tile's signed distance field"),
    ("march", "March", "Steps of one voxel through the tile's density, to compare others with"),
    ("slices", "Slices", "A stack of textured layers, as many as the density has in depth, to compare others with"),
    ("refined", "Refined", "From cell to cell of the tile's facets: the most exact, with the fewest lookups"),
)

# Blender's modifier has other words for the native module's choices.
MODIFIER_SCHEMES = {'CATMULL_CLARK': "catmark", 'SIMPLE': "bilinear"}
MODIFIER_BOUNDARIES = {'ALL': "edges", 'PRESERVE_CORNERS': "edges_and_corners"}
MODIFIER_UV_RULES = {'NONE': "linear", 'PRESERVE_CORNERS': "corners",
                     'PRESERVE_CORNERS_AND_JUNCTIONS': "corners_and_junctions",
                     'PRESERVE_CORNERS_JUNCTIONS_AND_CONCAVE': "corners_junctions_and_concave",
                     'PRESERVE_BOUNDARIES': "boundaries", 'SMOOTH_ALL': "smooth"}


def tag_redraw(_self=None, _context=None):
    """Draws every 3D view again; also an update callback. What is drawn compares settings and finds the change itself."""
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for area in window.screen.areas:
                if area.type == 'VIEW_3D':
                    area.tag_redraw()


def _property(kind, name, description="", **arguments):
    return kind(name=name, description=description, options=_ONCE, update=tag_redraw, **arguments)


class ShellOptions:
    """Annotations of a property group and of an operator."""

    surface: _property(EnumProperty, "Surface", "Which mesh carries the shell", items=SURFACES, default='EVALUATED')
    subdivision: _property(EnumProperty, "Subdivision", "Where the settings of the subdivision come from",
                           items=SUBDIVISIONS, default='OWN')
    refine: _property(EnumProperty, "Refine", "How finely the surface is subdivided", items=REFINEMENTS, default='LEVELS')
    levels: _property(IntProperty, "Levels", "Subdivisions of the surface before the shell is built", default=0, min=0,
                      max=5)
    most_levels: _property(IntProperty, "Most Levels", "A face is subdivided no more often than this", default=4, min=1,
                           max=8)
    edge_length: _property(FloatProperty, "Edge Length", "Greatest length of an edge in the scene", default=0.1, min=0.0001,
                           soft_max=10.0, unit='LENGTH')
    edge_pixels: _property(FloatProperty, "Edge Pixels", "Greatest length of an edge in the rendered picture", default=16.0,
                           min=1.0, soft_max=200.0, subtype='PIXEL')
    scheme: _property(EnumProperty, "Scheme", "Subdivision scheme", items=SCHEMES, default="catmark")
    boundary: _property(EnumProperty, "Boundary", "How open boundaries are smoothed", items=BOUNDARIES,
                        default="edges_and_corners")
    uv_rule: _property(EnumProperty, "UVs", "How UVs are smoothed as the surface is", items=UV_RULES,
                       default="boundaries")
    use_creases: _property(BoolProperty, "Creases", "Edges and vertices with a crease stay sharp", default=True)

    part: _property(EnumProperty, "Part", "Which faces have prisms", items=PARTS, default='ALL')
    part_name: _property(StringProperty, "Name", "Name of the material, vertex group or attribute that marks the part")

    thickness: _property(FloatProperty, "Thickness", "Of the shell, in the object's own units", default=0.1, min=0.0,
                         soft_max=10.0, unit='LENGTH', precision=4)
    offset: _property(EnumProperty, "Offset", "On which side of the surface the shell lies", items=OFFSETS,
                      default="outward")
    fit_thickness: _property(BoolProperty, "Fit to Tile", "The thickness keeps the tile's proportions, whatever the number "
                             "of tiles", default=False)
    thickness_group: _property(StringProperty, "Vertex Group", "Weights that the thickness is multiplied with")
    smooth_directors: _property(IntProperty, "Smooth Directors", "Steps that smooth the directions in which the shell grows",
                                default=0, min=0, max=100, soft_max=20)
    repair: _property(BoolProperty, "Repair Folds", "Make the shell thinner where prisms would fold or cross", default=False)
    relax: _property(IntProperty, "Relax", "Steps that move the UVs of the shell's top to reduce stretch", default=0, min=0,
                     max=100, soft_max=20)
    fins: _property(EnumProperty, "Sides", "What bounds a prism where the next one begins", items=FINS, default="exact")

    placement: _property(EnumProperty, "Placement", "What tiles are counted in", items=PLACEMENTS, default='UV')
    tiles_u: _property(FloatProperty, "Tiles U", "Tiles along one unit of U, or one meter", default=1.0, min=0.001,
                       soft_max=100.0)
    tiles_v: _property(FloatProperty, "Tiles V", "Tiles along one unit of V, or one meter", default=1.0, min=0.001,
                       soft_max=100.0)
    uv_rotation: _property(FloatProperty, "Rotation", "Of the tiles on the surface, counterclockwise", default=0.0,
                           subtype='ANGLE')
    uv_offset: _property(FloatVectorProperty, "Offset", "Of the tiles on the surface, in tiles, after the rotation", size=2,
                         default=(0.0, 0.0))

    traversal: _property(EnumProperty, "Traversal", "How a ray finds the surface", items=TRAVERSALS, default="refined")
    base_color: _property(FloatVectorProperty, "Color", "Reflectance, linear", subtype='COLOR', size=3,
                          default=(0.55, 0.56, 0.58), min=0.0, max=1.0)


NAMES = tuple(ShellOptions.__annotations__)
