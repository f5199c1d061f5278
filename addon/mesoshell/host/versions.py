"""All that differs between Blender 3.4 and 5.2, for the add-on as a whole; nobody else asks for the version."""

import bpy
import numpy as np

# For properties of subtype FILE_PATH: since 4.5 "//" must be allowed explicitly.
PATH_OPTIONS = {'PATH_SUPPORTS_BLEND_RELATIVE'} if bpy.app.version >= (4, 5, 0) else set()


# GPUShader's names for shaders that fill triangles with one color, with colors of vertices, and that draw wide lines.
_PREFIX = "" if bpy.app.version >= (4, 0, 0) else "3D_"
FLAT_COLOR_SHADER, SMOOTH_COLOR_SHADER, LINE_SHADER = (
    _PREFIX + name for name in ('UNIFORM_COLOR', 'SMOOTH_COLOR', 'POLYLINE_UNIFORM_COLOR'))


# Whether the sizes of faces follow from where each begins: since 3.6.
FACE_SIZES_FOLLOW = bpy.types.MeshPolygon.bl_rna.properties["loop_total"].is_readonly
# The name of the render pass of objects' indices, by which the compositor and files know it.
OBJECT_INDEX_PASS = "Object Index" if bpy.app.version >= (5, 0, 0) else "IndexOB"

WIDEST_SUN = 3.14  # radians, of what is rendered: less than half of all directions, which Blender's greatest angle is

# Whether Cycles multiplies a spot by the cosine to its axis.
SPOTS_HAVE_COSINE = bpy.app.version < (4, 0, 0)

_BLENDERS_OWN_ENGINES = {'BLENDER_EEVEE', 'BLENDER_EEVEE_NEXT', 'BLENDER_WORKBENCH'}

_CREASES_ARE_ATTRIBUTES = "crease" not in bpy.types.MeshEdge.bl_rna.properties  # since 4.0


def object_key(obj):
    """Tells objects apart for the length of a session, whatever their names; undo may change it before 4.1."""
    uid = getattr(obj, "session_uid", None)
    return uid if uid is not None else obj.as_pointer()


def uv_array(layer, corner_count):
    """UVs of a layer of a mesh, float32 [corner_count, 2]."""
    uvs = np.empty(corner_count * 2, np.float32)
    if hasattr(layer, "uv"):  # since 3.5, an attribute: one block copy
        layer.uv.foreach_get("vector", uvs)
    else:
        layer.data.foreach_get("uv", uvs)
    return uvs.reshape(-1, 2)


def set_uv_array(layer, uvs):
    """Sets the UVs of a layer of a mesh, float32 [corners, 2]."""
    if hasattr(layer, "uv"):
        layer.uv.foreach_set("vector", uvs.ravel())
    else:
        layer.data.foreach_set("uv", uvs.ravel())


def corner_normals(mesh):
    """Normals of a mesh's corners as it is shaded, float32 [corners, 3]; invalidates its triangulation."""
    normals = np.empty(len(mesh.loops) * 3, np.float32)
    if hasattr(mesh, "corner_normals"):  # since 4.1, computed on demand
        mesh.corner_normals.foreach_get("vector", normals)
    else:
        mesh.calc_normals_split()
        mesh.loops.foreach_get("normal", normals)
        mesh.free_normals_split()
    return normals.reshape(-1, 3)


def set_corner_normals(mesh, normals):
    """Shades a mesh whose faces are smooth by normals [corners, 3]; before 4.1 that takes Auto Smooth."""
    mesh.normals_split_custom_set(normals)
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True


def shade_flat(mesh):
    """Makes the faces of a mesh flat."""
    mesh.polygons.foreach_set("use_smooth", np.zeros(len(mesh.polygons), bool))


def has_custom_normals(mesh):
    """Whether a mesh is shaded by normals of its own making; before 4.1 it is if Auto Smooth is on."""
    return mesh.has_custom_normals and getattr(mesh, "use_auto_smooth", True)


def edge_creases(mesh):
    """Creases of a mesh's edges, float32 [edges] from 0 to 1, or None where it has none."""
    if not _CREASES_ARE_ATTRIBUTES:
        creases = np.empty(len(mesh.edges), np.float32)
        mesh.edges.foreach_get("crease", creases)
        return creases
    return _creases(mesh, "crease_edge")


def vertex_creases(mesh):
    """Creases of a mesh's vertices, float32 [vertices] from 0 to 1, or None where it has none."""
    if _CREASES_ARE_ATTRIBUTES:
        return _creases(mesh, "crease_vert")
    if not mesh.vertex_creases:
        return None
    creases = np.empty(len(mesh.vertices), np.float32)
    mesh.vertex_creases[0].data.foreach_get("value", creases)
    return creases


def _creases(mesh, name):
    attribute = mesh.attributes.get(name)
    if attribute is None:
        return None
    creases = np.empty(len(attribute.data), np.float32)
    attribute.data.foreach_get("value", creases)
    return creases


def material_nodes(material):
    """A material's node tree, or None where it is a plain color; since 5.0 every material has one."""
    if bpy.app.version < (5, 0, 0) and not material.use_nodes:
        return None
    return material.node_tree


def light_exposure(light):
    """The factor of a light's exposure, which 4.5 and later have."""
    return 2.0 ** getattr(light, "exposure", 0.0)


def light_color(light):
    """A light's linear color, with the temperature that 4.5 and later may tint it by."""
    color = np.array(light.color, np.float64)
    if getattr(light, "use_temperature", False):
        color *= np.array(light.temperature_color, np.float64)
    return color


def light_gain(light):
    """What Cycles makes of a light's power, over what it made of it in 3.4 (seen on 4.3.2 and 5.2.2 too).

    An area emits all of its power instead of a pi / 4 of it, and a sun's irradiance is what it says, whatever its angle.
    """
    if bpy.app.version >= (4, 0, 0) and light.type == 'AREA':
        return 4.0 / np.pi
    if bpy.app.version >= (4, 0, 0) and light.type == 'SUN':
        cosine = np.cos(min(light.angle, WIDEST_SUN) / 2.0)
        return (1.0 + cosine) / (2.0 * cosine)
    return 1.0


def world_nodes(world):
    """The node tree that makes a world's light, or None; since 5.0 every world has one."""
    if bpy.app.version < (5, 0, 0) and not world.use_nodes:
        return None
    return world.node_tree


def draw_progress(layout, text, fraction, fallback, fallback_property):
    """A progress bar; before 4.0 a slider of the read-only property `fallback_property` of `fallback`."""
    if hasattr(layout, "progress"):
        layout.progress(text=text, factor=fraction)
    else:
        layout.prop(fallback, fallback_property, text=text, slider=True)


def handlers_see_depth(space, engine):
    """Whether draw handlers of a 3D View find the scene's depth in the framebuffer (seen on 3.4.1, 4.3.2 and 5.2.2).

    X-ray views have none before 5.0. With overlays off, Cycles leaves none, nor do engines of other add-ons, and since 4.2
    Eevee neither.
    """
    shading, overlays = space.shading, space.overlay.show_overlays
    if shading.type in {'SOLID', 'WIREFRAME'}:
        xray = shading.show_xray if shading.type == 'SOLID' else shading.show_xray_wireframe
        return not xray or bpy.app.version >= (5, 0, 0)
    if shading.type == 'RENDERED' and engine not in _BLENDERS_OWN_ENGINES:
        return overlays
    return overlays or bpy.app.version < (4, 2, 0)
