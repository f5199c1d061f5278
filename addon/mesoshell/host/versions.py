"""All that differs between Blender 3.4 and 5.2, for the add-on as a whole; nobody else asks for the version."""

import bpy
import numpy as np

# For properties of subtype FILE_PATH: since 4.5 "//" must be allowed explicitly.
PATH_OPTIONS = {'PATH_SUPPORTS_BLEND_RELATIVE'} if bpy.app.version >= (4, 5, 0) else set()


# GPUShader's name for a shader that fills triangles with one color.
FLAT_COLOR_SHADER = 'UNIFORM_COLOR' if bpy.app.version >= (4, 0, 0) else '3D_UNIFORM_COLOR'


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


def corner_normals(mesh):
    """Normals of a mesh's corners as it is shaded, float32 [corners, 3]; invalidates its triangulation."""
    normals = np.empty(len(mesh.loops) * 3, np.float32)
    if hasattr(mesh, "corner_normals"):  # since 4.1, computed on demand
        mesh.corner_normals.foreach_get("vector", normals)
    else:
        mesh.calc_normals_split()
        mesh.loops.foreach_get("normal", normals)
    return normals.reshape(-1, 3)


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

    X-ray views have none before 5.0. With overlays off, Cycles leaves none, and since 4.2 Eevee neither.
    """
    shading, overlays = space.shading, space.overlay.show_overlays
    if shading.type in {'SOLID', 'WIREFRAME'}:
        xray = shading.show_xray if shading.type == 'SOLID' else shading.show_xray_wireframe
        return not xray or bpy.app.version >= (5, 0, 0)
    if shading.type == 'RENDERED' and engine == 'CYCLES':
        return overlays
    return overlays or bpy.app.version < (4, 2, 0)
