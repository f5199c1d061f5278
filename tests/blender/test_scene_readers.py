"""What a render is told of a scene's ordinary objects, lamps, world and camera."""

import bpy
import numpy as np
import pytest
import rendering
import scenes
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Euler, Matrix, Vector

CUBE = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
CUBE_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


@pytest.fixture
def read(part, fresh):
    """The meshes that a render of the emptied scene gets."""
    hidden = [obj for obj in fresh.objects if not obj.hide_render]
    for obj in hidden:
        obj.hide_render = True
    notices = []
    yield lambda: rendering.in_render(lambda depsgraph: part("host.scene_meshes").read(depsgraph, notices))
    assert notices == []
    for obj in hidden:
        obj.hide_render = False


def make_cube(name, matrix=Matrix()):
    obj = scenes.make_object(name, CUBE, CUBE_FACES)
    obj.matrix_world = matrix
    return obj


def make_material(name, color, view_color=(0.9, 0.9, 0.9)):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.diffuse_color = (*view_color, 1.0)
    shader = next(node for node in material.node_tree.nodes if node.type == 'BSDF_PRINCIPLED')
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    return material, shader


def outward(mesh):
    """Normals of a mesh's triangles as they wind, [m, 3], and the volume that they enclose."""
    a, b, c = np.moveaxis(np.float64(mesh["positions"])[mesh["triangles"]], 1, 0)
    cross = np.cross(b - a, c - a)
    return cross / np.linalg.norm(cross, axis=1, keepdims=True), np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0


@pytest.mark.parametrize("mirrored", [False, True])
def test_meshes_are_in_world_space_and_face_outward(read, mirrored):
    linear = np.array([[1.0, 0.3, 0.0], [0.0, -0.7 if mirrored else 0.7, 0.2], [0.1, 0.0, 2.0]])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, (5.0, -3.0, 1.0)
    parent = bpy.data.objects.new("Shear", None)  # a matrix of its own would lose the shear
    bpy.context.scene.collection.objects.link(parent)
    cube = make_cube("Cube")
    cube.parent, cube.matrix_parent_inverse = parent, Matrix(matrix.tolist())
    mesh, = read()
    np.testing.assert_allclose(mesh["positions"], CUBE @ linear.T + (5.0, -3.0, 1.0), atol=1e-5)
    normals, volume = outward({**mesh, "positions": mesh["positions"] - np.array([5.0, -3.0, 1.0])})
    assert volume == pytest.approx(8.0 * abs(np.linalg.det(linear)), rel=1e-5)
    corner_normals = mesh["normals"].reshape(-1, 3, 3)
    corner_normals = corner_normals / np.linalg.norm(corner_normals, axis=-1, keepdims=True)
    np.testing.assert_allclose(corner_normals, np.repeat(normals[:, None], 3, axis=1), atol=1e-5)


def test_what_is_not_rendered_is_not_read(read):
    shown, hidden = make_cube("Shown"), make_cube("Hidden")
    hidden.hide_render = True
    scene = bpy.context.scene
    collection = bpy.data.collections.new("Hidden collection")
    scene.collection.children.link(collection)
    for name in ("In it", "In it and hidden from the viewport"):
        obj = make_cube(name)
        scene.collection.objects.unlink(obj)
        collection.objects.link(obj)
    shown.hide_viewport = True  # is rendered all the same
    assert len(read()) == 3
    collection.hide_render = True
    assert len(read()) == 1
    collection.hide_render = False
    layer = bpy.context.view_layer.layer_collection.children["Hidden collection"]
    layer.exclude = True
    assert len(read()) == 1
    shown.visible_camera = False
    assert (read()[0]["visible_camera"], read()[0]["visible_shadow"]) == (False, True)
    shown.visible_shadow = False
    assert read() == []


def test_copies_modifiers_and_curves_are_read(read):
    """Of a collection that is instanced twice; evaluated as for renders; a curve and a metaball once each."""
    collection = bpy.data.collections.new("Copied")
    cube = make_cube("Copied cube")
    cube.pass_index = 7
    bpy.context.scene.collection.objects.unlink(cube)
    collection.objects.link(cube)
    cube.modifiers.new("Subdivision", 'SUBSURF').render_levels = 3
    for x in (-5.0, 5.0):
        empty = bpy.data.objects.new("Instancer", None)
        empty.instance_type, empty.instance_collection, empty.location.x = 'COLLECTION', collection, x
        bpy.context.scene.collection.objects.link(empty)
    first, second = read()
    assert len(first["triangles"]) == 2 * 6 * 4 ** 3
    assert {first["object_index"], second["object_index"]} == {7}
    apart = second["positions"] - first["positions"]
    np.testing.assert_allclose(apart, np.broadcast_to([10.0, 0.0, 0.0], apart.shape), atol=1e-5)
    empty.visible_camera = False
    assert sorted(mesh["visible_camera"] for mesh in read()) == [False, True]
    bpy.data.collections.remove(collection)
    bpy.ops.curve.primitive_bezier_circle_add()
    bpy.context.object.data.bevel_depth = 0.25
    bpy.ops.object.metaball_add()
    meshes = read()
    assert len(meshes) == 2
    radius = [np.linalg.norm(mesh["positions"], axis=1).max() for mesh in meshes]
    assert max(radius) == pytest.approx(1.25, rel=0.02), "the circle and its bevel"


def test_base_colors_are_those_of_the_slots(read):
    cube = make_cube("Painted")
    materials = [make_material(f"Color {k}", (0.1 * k, 0.5, 0.25))[0] for k in range(3)]
    for material in materials:
        cube.data.materials.append(material)
    cube.data.polygons.foreach_set("material_index", np.arange(6) % 3)
    mesh, = read()
    _normals, volume = outward(mesh)
    assert volume > 0.0
    # Each face is two triangles, in order.
    np.testing.assert_allclose(mesh["colors"][:, 0], 0.1 * np.repeat(np.arange(6) % 3, 2), rtol=1e-6)
    cube.data.polygons.foreach_set("material_index", np.ones(6, np.int32))
    assert read()[0]["base_color"] == pytest.approx((0.1, 0.5, 0.25))
    cube.material_slots[1].link = 'OBJECT'
    cube.material_slots[1].material = materials[2]
    assert read()[0]["base_color"] == pytest.approx((0.2, 0.5, 0.25))
    materials[2].node_tree.nodes.clear()
    assert read()[0]["base_color"] == pytest.approx((0.9, 0.9, 0.9)), "without a shader, the viewport's"


def test_colors_follow_an_attribute_and_an_image(read):
    plane = scenes.make_grid("Painted", side=2)
    material, shader = make_material("Linked", (0.0, 0.0, 0.0))
    plane.data.materials.append(material)
    attribute = plane.data.color_attributes.new("Paint", 'FLOAT_COLOR', 'POINT')
    positions = np.array([vertex.co for vertex in plane.data.vertices])
    paint = np.column_stack([positions / 2.0, np.ones(len(positions))])
    attribute.data.foreach_set("color", paint.astype(np.float32).ravel())
    node = material.node_tree.nodes.new("ShaderNodeVertexColor")
    node.layer_name = "Paint"
    material.node_tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    mesh, = read()
    middles = mesh["positions"][mesh["triangles"]].mean(axis=1)
    np.testing.assert_allclose(mesh["colors"], middles / 2.0, atol=1e-6)
    image = bpy.data.images.new("Quarters", 2, 2, float_buffer=True)
    quarters = np.array([[0.1, 0.2], [0.3, 0.4]], np.float32)  # rows from the bottom
    image.pixels.foreach_set(np.repeat(quarters.ravel(), 4))
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    expected = quarters[(middles[:, 1] > 1.0).astype(int), (middles[:, 0] > 1.0).astype(int)]
    np.testing.assert_allclose(read()[0]["colors"], np.repeat(expected[:, None], 3, axis=1), atol=1e-6)


def test_a_mesh_that_is_not_finite_is_named_and_left_out(part, fresh):
    make_cube("Sound")
    make_cube("Broken").data.vertices[3].co.x = np.nan
    notices = []
    meshes = rendering.in_render(lambda depsgraph: part("host.scene_meshes").read(depsgraph, notices))
    assert len(notices) == 1 and '"Broken"' in notices[0]
    assert len(meshes) >= 1 and all(np.isfinite(mesh["positions"]).all() for mesh in meshes)


def make_light(name, kind, rotation=(0.0, 0.0, 0.0), **settings):
    data = bpy.data.lights.new(name, kind)
    for key, value in settings.items():
        setattr(data, key, value)
    obj = bpy.data.objects.new(name, data)
    obj.rotation_euler, obj.location = rotation, (1.0, 2.0, 3.0)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def test_lamps_shine_along_their_axis_with_their_power(part, read):
    rotation = (0.5, 0.2, 1.0)
    objects = [
        make_light("A", 'SUN', rotation, energy=3.0, color=(1.0, 0.5, 0.25), angle=0.001),
        make_light("B", 'POINT', rotation, energy=100.0, shadow_soft_size=0.3),
        make_light("C", 'SPOT', rotation, energy=50.0, spot_size=1.0, spot_blend=0.4, use_shadow=False),
        make_light("D", 'AREA', rotation, energy=20.0, shape='RECTANGLE', size=2.0, size_y=0.5)]
    objects[3].scale = (2.0, 3.0, 1.0)
    hidden = make_light("E", 'POINT')
    hidden.hide_render = True
    lights = {light["type"]: light for light in rendering.in_render(part("host.scene_lights").read)}
    assert set(lights) == {'SUN', 'POINT', 'SPOT', 'AREA'}
    turn = Euler(rotation).to_matrix()
    for light in lights.values():
        along = np.array(light["direction"])
        np.testing.assert_allclose(along / np.linalg.norm(along), turn @ Vector((0.0, 0.0, -1.0)), atol=1e-6)
        np.testing.assert_allclose(light["position"], (1.0, 2.0, 3.0))
    np.testing.assert_allclose(lights['SUN']["color"], (3.0, 1.5, 0.75), rtol=1e-6)
    assert lights['SUN']["angle"] == pytest.approx(0.001)
    np.testing.assert_allclose(lights['POINT']["color"], 100.0)
    assert lights['POINT']["radius"] == pytest.approx(0.3)
    spot = lights['SPOT']
    assert (spot["spot_size"], spot["spot_blend"], spot["cast_shadow"]) == (pytest.approx(1.0), pytest.approx(0.4), False)
    np.testing.assert_allclose(lights['AREA']["size"], (4.0, 1.5), rtol=1e-6)
    axis = lights['AREA']["axes"][1]
    np.testing.assert_allclose(axis / np.linalg.norm(axis), turn @ Vector((0.0, 1.0, 0.0)), atol=1e-6)


def test_the_sky_is_the_worlds_color_or_image(part, fresh):
    notices = []

    def sky():
        notices.clear()
        return rendering.in_render(lambda depsgraph: part("host.scene_lights").world(depsgraph, notices))
    before, world = fresh.world, bpy.data.worlds.new("Test world")
    fresh.world = world
    try:
        world.use_nodes, world.color = True, (0.1, 0.2, 0.3)
        nodes, links = world.node_tree.nodes, world.node_tree.links
        nodes.clear()
        background, output = nodes.new("ShaderNodeBackground"), nodes.new("ShaderNodeOutputWorld")
        assert sky() is None
        links.new(background.outputs[0], output.inputs["Surface"])
        background.inputs["Color"].default_value = (0.5, 0.25, 0.125, 1.0)
        background.inputs["Strength"].default_value = 2.0
        assert sky()["color"] == pytest.approx((1.0, 0.5, 0.25))
        image = bpy.data.images.new("Sky", 4, 2, float_buffer=True)
        image.pixels.foreach_set(np.arange(32, dtype=np.float32))
        texture = nodes.new("ShaderNodeTexEnvironment")
        texture.image = image
        links.new(texture.outputs["Color"], background.inputs["Color"])
        np.testing.assert_allclose(sky()["image"], 2.0 * np.arange(32, dtype=np.float32).reshape(2, 4, 4)[..., :3])
        assert notices == []
        texture.projection = 'MIRROR_BALL'
        assert sky()["color"] == pytest.approx((0.1, 0.2, 0.3)) and len(notices) == 1
        fresh.world = None
        assert sky() is None
    finally:
        fresh.world = before
        bpy.data.worlds.remove(world)


@pytest.mark.parametrize("kind", ["perspective", "shifted", "orthographic"])
@pytest.mark.parametrize("border", [False, True])
def test_the_camera_projects_as_blenders_does(part, fresh, rng, kind, border):
    data = bpy.data.cameras.new("Camera")
    camera = bpy.data.objects.new("Camera", data)
    fresh.collection.objects.link(camera)
    camera.location, camera.rotation_euler, camera.scale = (1.0, -4.0, 2.0), (1.2, 0.1, 0.3), (2.0, 1.0, 0.5)
    if kind == "orthographic":
        data.type, data.ortho_scale = 'ORTHO', 5.0
    elif kind == "shifted":
        data.shift_x, data.shift_y, data.lens = 0.2, -0.1, 20.0
    render, size = fresh.render, (40, 24)
    names = ("use_border", "border_min_x", "border_max_x", "border_min_y", "border_max_y")
    points = rng.uniform(-1.0, 1.0, (50, 3))
    before = fresh.camera
    try:
        with rendering.kept(render, *names):
            fresh.camera, render.use_border = camera, border
            for name, value in zip(names[1:], (0.26, 0.81, 0.1, 0.7)):
                setattr(render, name, value)
            view = rendering.in_render(lambda depsgraph: part("host.scene_camera").read(depsgraph, size), size)
            with rendering.kept(render, "resolution_x", "resolution_y", "resolution_percentage"):
                (render.resolution_x, render.resolution_y), render.resolution_percentage = size, 100
                expected = np.array([world_to_camera_view(fresh, camera, Vector(point)) for point in points])[:, :2] * size
    finally:
        fresh.camera = before
    low = (10, 2) if border else (0, 0)  # 0.26 * 40 and 0.1 * 24, cut off
    assert view.size == ((22, 14) if border else size)
    clip = np.column_stack([points, np.ones(len(points))]) @ view.clip_from_world.T
    pixels = (clip[:, :2] / clip[:, 3:] * 0.5 + 0.5) * view.size + low
    np.testing.assert_allclose(pixels, expected, atol=1e-3)


def test_a_camera_that_does_not_project_is_refused(part, fresh):
    data = bpy.data.cameras.new("Camera")
    data.type = 'PANO'
    camera = bpy.data.objects.new("Panorama", data)
    fresh.collection.objects.link(camera)
    before, fresh.camera = fresh.camera, camera
    try:
        with pytest.raises(ValueError, match='"Panorama" is neither perspective nor orthographic'):
            rendering.in_render(lambda depsgraph: part("host.scene_camera").read(depsgraph, (8, 8)))
    finally:
        fresh.camera = before
