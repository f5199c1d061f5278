"""chain_torus.blend: a tile of chain mail, a torus to wear it, a cube that stands in it, a light and a camera."""

import bmesh
import bpy
import numpy as np
from mathutils import Euler, Vector

from scene_parts import add_object, look_through_camera, make_material, mesh_from_arrays, set_tile_settings, use_nodes
from tiles import chain

TORUS_MAJOR, TORUS_MINOR = 1.0, 0.42  # scene units (meters)
TORUS_QUADS = (48, 20)  # around the axis and around the tube
TILES = (20, 10)  # whole numbers, so the mail closes; atop the tube, halfway up the shell, a tile is 0.314 square
THICKNESS = 0.157  # of the shell: chain.HEIGHT such tile widths, so the rings stay round there
CUBE_SIZE = 0.5


def torus_uvs(segments, sides):
    """UVs of chain.torus by face corner: float64 [segments * sides * 4, 2], 0 to 1 around the axis and the tube.

    A face at the seam ends at 1, not at 0: no face runs backwards through the whole texture.
    """
    i, j = np.meshgrid(np.arange(segments), np.arange(sides), indexing="ij")
    u = np.stack([i, i + 1, i + 1, i], axis=-1) / segments
    v = np.stack([j, j, j + 1, j + 1], axis=-1) / sides
    return np.stack([u, v], axis=-1).reshape(-1, 2)


def add_chain_tile(detail):
    """The tile, beside the torus and out of the picture; 1 unit wide, so its lengths are tile widths."""
    steel = make_material("Steel", (0.55, 0.56, 0.58), 1.0, 0.35)
    positions, triangles = chain.chain_links(round(64 * detail))
    obj = add_object("ChainTile", mesh_from_arrays("ChainTile", positions, triangles, steel), (2.4, 0.4, -0.6))
    obj.hide_render = True
    set_tile_settings(obj, chain.PERIOD, chain.HEIGHT)


def add_torus():
    """The surface that wears the mail; how many tiles suit it and how thick a shell are stored on it as a suggestion."""
    leather = make_material("Leather", (0.10, 0.065, 0.045), 0.0, 0.7)
    positions, quads = chain.torus(TORUS_MAJOR, TORUS_MINOR, *TORUS_QUADS)
    mesh = mesh_from_arrays("Torus", positions, quads, leather)
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", torus_uvs(*TORUS_QUADS).ravel())
    obj = add_object("Torus", mesh)
    obj["mesoshell_tiles"] = TILES
    obj["mesoshell_thickness"] = THICKNESS
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)


def add_cube():
    """An ordinary cube, half sunk into the mail: it hides some of it and is partly hidden by it."""
    mesh = bpy.data.meshes.new("Cube")
    cube = bmesh.new()
    bmesh.ops.create_cube(cube, size=CUBE_SIZE)
    cube.to_mesh(mesh)
    cube.free()
    mesh.materials.append(make_material("Clay", (0.72, 0.20, 0.06), 0.0, 0.6))

    around, tube = np.radians(-52.0), np.radians(86.0)
    middle = TORUS_MINOR + THICKNESS / 2
    distance = TORUS_MAJOR + middle * np.cos(tube)
    location = (distance * np.cos(around), distance * np.sin(around), middle * np.sin(tube))
    add_object("Cube", mesh, location, (0.0, 0.0, np.radians(38.0)))


def add_light_and_camera():
    """A sun from above on the left, and a camera that sees the torus, shell included, fill a square picture."""
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.5, np.radians(1.0)
    add_object("Sun", sun, (-3.0, -2.0, 4.0), Euler(np.radians((38.0, -28.0, 0.0))))

    camera = bpy.data.cameras.new("Camera")
    camera.lens, camera.sensor_width = 50.0, 36.0
    toward = Vector((0.25, -0.72, 0.78)).normalized()  # from the torus to the camera
    location = toward * 5.0 + Vector((0.02, 0.0, -0.05))
    obj = add_object("Camera", camera, location, toward.to_track_quat("Z", "Y").to_euler())
    bpy.context.scene.camera = obj


def set_scene():
    """The picture: 512 x 512, Standard view transform, a dark gray world; the 3D views look through the camera."""
    scene = bpy.context.scene
    scene.name = "Chain torus"
    scene.render.resolution_x = scene.render.resolution_y = 512
    scene.render.resolution_percentage = 100
    scene.render.filepath = "//"  # beside the file, wherever that is
    scene.view_settings.view_transform = "Standard"
    scene.frame_start = scene.frame_end = 1
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.05, 0.05, 0.05)
    background = next(node for node in use_nodes(scene.world) if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.05, 0.05, 0.05, 1.0)
    look_through_camera()


def build(detail):
    """Fills the empty scene; a ring of the mail has 64 * detail segments."""
    set_scene()
    add_chain_tile(detail)
    add_torus()
    add_cube()
    add_light_and_camera()
