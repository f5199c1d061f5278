"""What both sample scenes are put together from: objects, meshes, materials, tile settings, saving. Blender 3.4 to 5.2."""

import os

import bpy
import numpy as np

COLORS = "Color"  # the color attribute of the tiles


def add_object(name, data, location=(0.0, 0.0, 0.0), rotation=(0.0, 0.0, 0.0)):
    """A new object in the scene, at `location`, turned by the Euler angles `rotation` in radians."""
    obj = bpy.data.objects.new(name, data)
    obj.location, obj.rotation_euler = location, rotation
    bpy.context.scene.collection.objects.link(obj)
    return obj


def mesh_from_arrays(name, positions, faces, material, colors=None):
    """A smooth mesh from positions [n, 3] and faces [m, 3 or 4], with one material and perhaps colors [n, 3], linear RGB."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(positions.tolist(), [], faces.tolist())
    mesh.polygons.foreach_set("use_smooth", np.full(len(faces), True))
    mesh.materials.append(material)
    mesh.update()
    if colors is not None:
        attribute = mesh.color_attributes.new(COLORS, 'FLOAT_COLOR', 'POINT')
        attribute.data.foreach_set("color", np.append(colors, np.ones((len(colors), 1)), axis=1).astype(np.float32).ravel())
    return mesh


def use_nodes(owner):
    """The node tree of a material or a world, made first where the version does not make it by itself (before 5.0)."""
    if owner.node_tree is None:
        owner.use_nodes = True
    return owner.node_tree.nodes


def make_material(name, color, metallic, roughness):
    """A principled material, its color also used where the viewport draws without materials. A color of None: the one that
    the mesh's attribute COLORS gives."""
    material = bpy.data.materials.new(name)
    shader = next(node for node in use_nodes(material) if node.type == "BSDF_PRINCIPLED")
    if color is None:
        attribute = material.node_tree.nodes.new("ShaderNodeAttribute")
        attribute.attribute_name = COLORS
        attribute.location = shader.location.x - 250.0, shader.location.y
        material.node_tree.links.new(attribute.outputs["Color"], shader.inputs["Base Color"])
        color = (0.5, 0.5, 0.5)
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Metallic"].default_value = metallic
    shader.inputs["Roughness"].default_value = roughness
    material.diffuse_color, material.metallic, material.roughness = (*color, 1.0), metallic, roughness
    return material


def set_tile_settings(obj, period, height):
    """Marks `obj` as a tile, in its own units, so that a file made without the add-on is understood by it.

    Object.mesoshell_tile is a PropertyGroup of the add-on, which need not be there. Up to Blender 4.x a group lives among
    the object's ID properties under its own name, so a plain ID property of that name becomes the group's values as soon
    as the add-on registers it. From 5.0 on the two are kept apart: values of a group lie in the system properties.
    Blender copies them there when it opens a file of an earlier version; in a session of 5.x they must be written there.
    The two plain properties are what any version and any script can read.
    """
    settings = {"period_u": period[0], "period_v": period[1], "height": height, "is_tile": True}
    obj["mesoshell_tile"] = settings
    if hasattr(obj, "bl_system_properties_get"):
        obj.bl_system_properties_get(do_create=True)["mesoshell_tile"] = settings
    obj["mesoshell_period"] = tuple(period)
    obj["mesoshell_height"] = height


def look_through_camera():
    """The 3D views look through the scene's camera; file browsers forget the home folder of whoever makes the file."""
    for space in (space for screen in bpy.data.screens for area in screen.areas for space in area.spaces):
        if space.type == "VIEW_3D":
            space.region_3d.view_perspective = "CAMERA"
        elif space.type == "FILE_BROWSER" and space.params:
            space.params.directory = b"//"


def save(path):
    """Saves compressed, whole or not at all, without a backup beside it and without this machine's folders inside."""
    partial = path.with_suffix(".part.blend")
    bpy.ops.wm.save_as_mainfile(filepath=str(partial), compress=True, copy=True)
    os.replace(partial, path)
