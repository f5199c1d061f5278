"""tiles.blend: the six tiles side by side, each an object in whose own space a period is [0, 1] x [0, aspect] x [0, height].

Weave, grid, chain and bark are meshes. The scales and the hairs are copies made by Geometry Nodes from few templates; they come out
as the arrays of tiles.make() do. The scales stay instances, the hairs become one mesh.
"""

import bpy
import numpy as np
from mathutils import Euler, Vector

import tiles
from scene_parts import add_object, make_material, mesh_from_arrays, set_tile_settings, use_nodes
from tile_nodes import SHADE, copies_on_roots, set_attribute, set_roots
from tiles import fur, squama
from tiles.tile import make_tile

COLUMNS = 3
PITCH = (1.9, 1.75)  # between the middles of tiles, across and down the picture


def add_templates(name, meshes):
    """A hidden collection of objects that show the meshes, in the order that picks them."""
    collection = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(collection)
    for index, mesh in enumerate(meshes):
        collection.objects.link(bpy.data.objects.new(f"{name} {index}", mesh))
    collection.hide_viewport = collection.hide_render = True
    return collection


def add_copies(tile, skin, templates, placement, tinted):
    """An object that is the tile once its modifier has put copies of the templates (meshes) on the skin."""
    roots, turns, scales, variants, *tints = placement
    ground = make_tile(tile.name, skin, height=tile.height, aspect=tile.aspect)
    material = templates[0].materials[0]
    points = np.concatenate([ground.positions, roots])
    colors = np.concatenate([ground.colors, np.zeros_like(roots)])
    mesh = mesh_from_arrays(tile.name.title(), points, ground.triangles, material, colors)
    set_roots(mesh, len(ground.positions), turns, scales, variants, *tints)
    obj = add_object(tile.name.title(), mesh)
    modifier = obj.modifiers.new("Copies", 'NODES')
    name = f"{tile.name.title()} templates"
    modifier.node_group = copies_on_roots(f"{tile.name.title()} on roots", add_templates(name, templates), tinted)
    return obj


def add_squama(tile, material, detail):
    templates = []
    for variant in range(squama.VARIANTS):
        positions, triangles, colors = squama.template(variant, *squama.resolution(detail))
        templates.append(mesh_from_arrays(f"Scale {variant}", positions, triangles, material, colors))
    return add_copies(tile, squama.skin(detail), templates, squama.placement(), tinted=False)


def add_fur(tile, material, detail):
    templates = []
    for variant in range(fur.VARIANTS):
        positions, triangles, share = fur.template(variant, *fur.resolution(detail))
        mesh = mesh_from_arrays(f"Hair {variant}", positions, triangles, material)
        set_attribute(mesh, SHADE, 'FLOAT_VECTOR', fur.hair_color(np.ones((1, 3)), share)[0])
        templates.append(mesh)
    return add_copies(tile, fur.skin(detail), templates, fur.placement(detail), tinted=True)


def add_plain(tile, material, _detail):
    mesh = mesh_from_arrays(tile.name.title(), tile.positions, tile.triangles, material, tile.colors)
    return add_object(tile.name.title(), mesh)


def add_light_and_camera():
    """A sun from the left, soft light from all sides, and a camera above the lower edge that sees all six tiles."""
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.0, np.radians(4.0)
    add_object("Sun", sun, (-3.0, -2.0, 4.0), Euler(np.radians((40.0, -28.0, 15.0))))

    camera = bpy.data.cameras.new("Camera")
    camera.lens, camera.sensor_width = 50.0, 36.0
    toward = Vector((0.0, -0.55, 1.0)).normalized()
    center = Vector((PITCH[0], -PITCH[1] / 2 - 0.05, 0.2))
    bpy.context.scene.camera = add_object("Camera", camera, center + toward * 8.3, toward.to_track_quat("Z", "Y").to_euler())


def set_scene():
    """The picture: 960 x 720, Standard view transform, a pale gray world."""
    scene = bpy.context.scene
    scene.name = "Tiles"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 960, 720, 100
    scene.render.filepath = "//"  # beside the file, wherever that is
    scene.view_settings.view_transform = "Standard"
    scene.frame_start = scene.frame_end = 1
    scene.world = bpy.data.worlds.new("World")
    background = next(node for node in use_nodes(scene.world) if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.31, 0.33, 0.37, 1.0)
    scene.world.color = (0.31, 0.33, 0.37)
    for space in (space for screen in bpy.data.screens for area in screen.areas for space in area.spaces):
        if space.type == "FILE_BROWSER" and space.params:
            space.params.directory = b"//"  # else the file would carry the home folder of whoever made it


def build(detail):
    """Fills the empty scene with the tiles of tiles.make(name, detail)."""
    set_scene()
    for index, name in enumerate(tiles.NAMES):
        tile = tiles.make(name, detail)
        material = make_material(name.title(), None, tile.metallic, tile.roughness)
        obj = {"squama": add_squama, "fur": add_fur}.get(name, add_plain)(tile, material, detail)
        row, column = divmod(index, COLUMNS)
        # Solids are whole, so a tile reaches over its box; what is there stands in the middle of its place.
        middle = (tile.positions.min(axis=0) + tile.positions.max(axis=0)) / 2
        obj.location = column * PITCH[0] - middle[0], -row * PITCH[1] - middle[1], 0.0
        set_tile_settings(obj, (1.0, tile.aspect), tile.height)
    add_light_and_camera()
