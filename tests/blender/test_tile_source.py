"""Laws of what a tile may be made of: however Blender comes to show a surface, the same surface is read."""

import itertools

import bpy
import numpy as np
import pytest
import scenes
from mathutils import Euler, Matrix, Vector

BALL_POSITIONS, BALL_TRIANGLES = scenes.make_sphere_mesh(8, 12)


def update():
    bpy.context.view_layer.update()


def make_box(name="Box", location=(0.5, 0.5, 0.5), scale=(1.0, 1.0, 1.0), rotation=(0.0, 0.0, 0.0)):
    """An empty that shows a box of size `scale`."""
    box = bpy.data.objects.new(name, None)
    box.empty_display_type, box.empty_display_size = 'CUBE', 0.5
    box.location, box.scale, box.rotation_euler = location, scale, rotation
    bpy.context.scene.collection.objects.link(box)
    return box


def make_ball(name="Ball", radius=0.3, center=(0.5, 0.5, 0.5)):
    return scenes.make_object(name, BALL_POSITIONS * radius + np.asarray(center), BALL_TRIANGLES)


def in_collection(name, *objects, parent=None):
    """A collection that holds `objects`, which are nowhere else afterwards."""
    collection = bpy.data.collections.new(name)
    (parent or bpy.context.scene.collection).children.link(collection)
    for obj in objects:
        for old in list(obj.users_collection):
            old.objects.unlink(obj)
        collection.objects.link(obj)
    return collection


@pytest.fixture
def read(part):
    """read(tile or collection, box): its TileSurface."""
    def call(source, box=None):
        update()
        chosen = part("host.chosen_source")
        if isinstance(source, bpy.types.Collection):
            choice = chosen.choose(bpy.context, source='COLLECTION', collection=source, box=box)
        else:
            choice = chosen.choose(bpy.context, source='OBJECT', tile=source, box=box)
        return chosen.read(choice, bpy.context.evaluated_depsgraph_get())
    return call


def features(surface):
    """Center and area vector of each triangle, [m, 6]: the same whichever corner it starts at, not whichever way round."""
    a, b, c = np.moveaxis(surface.positions[surface.triangles], 1, 0)
    return np.hstack([(a + b + c) / 3, np.cross(b - a, c - a)])


def assert_same_surface(found, expected):
    """Each triangle of one is a triangle of the other, in whatever order."""
    assert found.triangles.shape == expected.triangles.shape
    apart = np.abs(features(found)[:, None] - features(expected)[None]).max(axis=2)
    assert apart.min(axis=1).max() < 1e-5 and apart.min(axis=0).max() < 1e-5
    assert (found.height, found.aspect) == pytest.approx((expected.height, expected.aspect), rel=1e-5)


def volume(surface):
    a, b, c = np.moveaxis(surface.positions[surface.triangles], 1, 0)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def joined(objects, name="Joined"):
    """One mesh object of what the objects' own meshes are, in world space."""
    positions, faces, count = [], [], 0
    for obj in objects:
        own = np.array([vertex.co for vertex in obj.data.vertices])
        matrix = np.array(obj.matrix_world)
        positions.append(own @ matrix[:3, :3].T + matrix[:3, 3])
        flipped = np.linalg.det(matrix[:3, :3]) < 0
        faces += [[i + count for i in (reversed(face.vertices) if flipped else face.vertices)] for face in obj.data.polygons]
        count += len(own)
    return scenes.make_object(name, np.concatenate(positions), faces)


# --- the box


def test_box_is_the_period_and_the_shape(fresh, read):
    """A ball that fills a 2 x 3 x 1 box touches its borders at 0 and 1, at 0 and 1.5, at 0 and 0.5 tile widths."""
    box = make_box(location=(5.0, -2.0, 1.0), scale=(2.0, 3.0, 1.0))
    ball = scenes.make_object("Egg", BALL_POSITIONS * [1.0, 1.5, 0.5] + [5.0, -2.0, 1.0], BALL_TRIANGLES)
    surface = read(ball, box)
    assert (surface.aspect, surface.height) == pytest.approx((1.5, 0.5))
    np.testing.assert_allclose(surface.positions.min(axis=0), 0.0, atol=1e-5)
    np.testing.assert_allclose(surface.positions.max(axis=0), [1.0, 1.5, 0.5], atol=1e-5)
    assert volume(surface) > 0


@pytest.mark.parametrize("display_size", [0.5, 1.0, 3.0])
def test_box_is_what_the_empty_is_drawn_as(fresh, read, display_size):
    expected = read(make_ball(), make_box())
    box = make_box("Drawn", scale=np.full(3, 0.5 / display_size))
    box.empty_display_size = display_size
    assert_same_surface(read(bpy.data.objects["Ball"], box), expected)


def test_box_and_tile_may_turn_together(fresh, read):
    ball, box = make_ball(), make_box(scale=(1.0, 1.25, 0.8))
    expected = read(ball, box)
    turn = Matrix.LocRotScale((3.0, -1.0, 7.0), Euler((0.5, 1.1, -2.0)), (4.0, 4.0, 4.0))
    update()
    for obj in (ball, box):
        obj.matrix_world = turn @ obj.matrix_world
    assert_same_surface(read(ball, box), expected)


def test_a_box_of_an_object_equals_its_own_period(fresh, read):
    """An object marked as a tile and the same one with an empty around that very part of its space."""
    tile = scenes.make_tile("SphereTile")
    own = read(tile)
    size = np.array([1.0, scenes.ASPECT, scenes.HEIGHT]) * scenes.WIDTH
    box = make_box()
    update()
    box.matrix_world = tile.matrix_world @ Matrix.LocRotScale(size / 2, None, size)
    boxed = read(tile, box)
    np.testing.assert_array_equal(boxed.triangles, own.triangles)
    np.testing.assert_allclose(boxed.positions, own.positions, atol=1e-6)
    assert (boxed.height, boxed.aspect) == pytest.approx((scenes.HEIGHT, scenes.ASPECT), rel=1e-6)


def test_mirrored_box_mirrors_the_tile_and_keeps_its_inside(fresh, read):
    ball = make_ball(center=(0.3, 0.5, 0.5))
    plain = read(ball, make_box())
    mirrored = read(ball, make_box("Mirrored", scale=(-1.0, 1.0, 1.0)))
    np.testing.assert_allclose(mirrored.positions, [1.0, 0.0, 0.0] + plain.positions * [-1.0, 1.0, 1.0], atol=1e-6)
    assert volume(mirrored) == pytest.approx(volume(plain), rel=1e-5)


def test_added_box_is_around_the_source(fresh, read, part):
    ball = make_ball(radius=0.7, center=(3.0, 4.0, 5.0))
    ball.rotation_euler, ball.scale = (0.3, -0.4, 0.9), (1.0, 2.0, 0.5)
    modifier = ball.modifiers.new("Row", 'ARRAY')
    modifier.count = 3
    update()
    fresh.mesoshell.tile = ball
    assert bpy.ops.mesoshell.add_tile_box() == {'FINISHED'}
    box = fresh.mesoshell.box
    assert box.type == 'EMPTY' and box.empty_display_type == 'CUBE'
    surface = read(ball, box)
    np.testing.assert_allclose(surface.positions.min(axis=0), 0.0, atol=2e-5)
    np.testing.assert_allclose(surface.positions.max(axis=0), [1.0, surface.aspect, surface.height], atol=2e-5)


def test_snapped_box_equals_the_bounds(fresh):
    ball = make_ball(radius=0.7, center=(3.0, 4.0, 5.0))
    ball.modifiers.new("Row", 'ARRAY').count = 3
    box = make_box(location=(9.0, 9.0, 9.0), scale=(2.0, 3.0, 4.0))
    fresh.mesoshell.tile, fresh.mesoshell.box = ball, box
    update()
    assert bpy.ops.mesoshell.snap_tile_box() == {'FINISHED'}
    update()
    evaluated = ball.evaluated_get(bpy.context.evaluated_depsgraph_get())
    bounds = np.array([evaluated.matrix_world @ Vector(corner) for corner in evaluated.bound_box])
    np.testing.assert_allclose(box.location, (bounds.min(axis=0) + bounds.max(axis=0)) / 2, rtol=1e-5)
    np.testing.assert_allclose(box.scale, np.ptp(bounds, axis=0), rtol=3e-5)


def test_box_snaps_along_one_axis_only(fresh):
    ball = make_ball(center=(3.0, 4.0, 5.0))
    box = make_box(location=(9.0, 9.0, 9.0), scale=(2.0, 3.0, 4.0))
    fresh.mesoshell.tile, fresh.mesoshell.box = ball, box
    update()
    assert bpy.ops.mesoshell.snap_tile_box(along_u=False, along_v=False) == {'FINISHED'}
    np.testing.assert_allclose(box.location, [9.0, 9.0, 5.0], rtol=1e-5)
    np.testing.assert_allclose(box.scale, [2.0, 3.0, 0.6], rtol=1e-4)


# --- what evaluates to a mesh


def test_collection_equals_the_joined_mesh(fresh, read):
    first, second = make_ball("First", 0.1), make_ball("Second", 0.2, (0.2, 0.7, 0.4))
    second.rotation_euler, second.scale = (0.1, 0.2, 0.3), (1.0, 1.1, 0.9)
    update()
    whole = joined([first, second])
    collection = in_collection("Tile", first)
    in_collection("Inner", second, parent=collection)
    assert_same_surface(read(collection, make_box()), read(whole, make_box("Other")))


def test_selection_equals_the_collection(fresh, part, read):
    first, second = make_ball("First", 0.1), make_ball("Second", 0.2, (0.2, 0.7, 0.4))
    box = make_box()
    collection = in_collection("Tile", first, second)
    expected = read(collection, box)
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in (first, second, box))
    chosen = part("host.chosen_source")
    choice = chosen.choose(bpy.context, source='SELECTION', box=box)
    assert_same_surface(chosen.read(choice, bpy.context.evaluated_depsgraph_get()), expected)


def test_instanced_collection_equals_the_joined_mesh(fresh, read):
    """Two empties show a collection whose objects are hidden from view; one of them is mirrored."""
    first, second = make_ball("First", 0.1, (0.1, 0.1, 0.1)), make_ball("Second", 0.15, (-0.1, 0.2, 0.0))
    collection = in_collection("Parts", first, second)
    instancers = []
    for place, scale in (((0.4, 0.4, 0.5), (1.0, 1.0, 1.0)), ((0.6, 0.5, 0.5), (-1.0, 0.8, 1.0))):
        empty = bpy.data.objects.new("Copy", None)
        empty.instance_type, empty.instance_collection = 'COLLECTION', collection
        empty.location, empty.scale = place, scale
        bpy.context.scene.collection.objects.link(empty)
        instancers.append(empty)
    update()
    copies = []
    for empty, obj in itertools.product(instancers, (first, second)):
        copies.append(make_ball(f"{obj.name} of {empty.name}"))
        copies[-1].data, copies[-1].matrix_world = obj.data, empty.matrix_world @ obj.matrix_world
    update()
    whole = joined(copies)
    bpy.context.view_layer.layer_collection.children["Parts"].exclude = True
    tile = in_collection("Tile", *instancers)
    surface = read(tile, make_box())
    assert_same_surface(surface, read(whole, make_box("Other")))
    assert volume(surface) > 0


def test_mirrored_object_keeps_its_inside(fresh, read):
    ball = make_ball()
    plain = volume(read(ball, make_box()))
    ball.scale, ball.location = (1.0, 1.0, -1.0), (0.0, 0.0, 1.0)
    surface = read(ball, make_box("Other"))
    assert volume(surface) == pytest.approx(plain, rel=1e-5)
    # Corner normals point away from the center, mirrored or not.
    outward = surface.positions[surface.triangles] - 0.5
    assert (np.einsum("mck,mck->mc", outward, surface.normals) > 0).all()


@pytest.mark.parametrize("kind", ["curve", "text", "surface", "metaball"])
def test_what_is_no_mesh_equals_its_converted_mesh(fresh, read, kind):
    add = {"curve": bpy.ops.curve.primitive_bezier_circle_add, "text": bpy.ops.object.text_add,
           "surface": bpy.ops.surface.primitive_nurbs_surface_torus_add, "metaball": bpy.ops.object.metaball_add}[kind]
    add(location=(0.2, 0.1, 0.0), rotation=(0.2, 0.3, 0.0))
    obj = bpy.context.view_layer.objects.active
    if kind == "curve":
        obj.data.bevel_depth = 0.2
    elif kind == "text":
        obj.data.extrude = 0.1
    update()
    mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    assert len(mesh.polygons) > 50
    converted = bpy.data.objects.new("Converted", mesh)
    bpy.context.scene.collection.objects.link(converted)
    converted.matrix_world = obj.matrix_world
    box = make_box(location=(0.0, 0.0, 0.0), scale=(5.0, 5.0, 5.0))
    assert_same_surface(read(obj, box), read(converted, box))


def instance_on_vertices(obj, points):
    """A Geometry Nodes modifier on a mesh of single vertices at `points` that puts `obj` on each."""
    host = scenes.make_object("Points", points, [])
    tree = bpy.data.node_groups.new("Put", 'GeometryNodeTree')
    if hasattr(tree, "interface"):
        tree.interface.new_socket("Geometry", in_out='INPUT', socket_type='NodeSocketGeometry')
        tree.interface.new_socket("Geometry", in_out='OUTPUT', socket_type='NodeSocketGeometry')
    else:
        tree.inputs.new('NodeSocketGeometry', "Geometry")
        tree.outputs.new('NodeSocketGeometry', "Geometry")
    into, out = tree.nodes.new('NodeGroupInput'), tree.nodes.new('NodeGroupOutput')
    put, info = tree.nodes.new('GeometryNodeInstanceOnPoints'), tree.nodes.new('GeometryNodeObjectInfo')
    info.inputs["Object"].default_value = obj
    tree.links.new(into.outputs[0], put.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], put.inputs["Instance"])
    tree.links.new(put.outputs[0], out.inputs[0])
    host.modifiers.new("Put", 'NODES').node_group = tree
    return host


def test_instances_of_geometry_nodes_equal_the_joined_mesh(fresh, read):
    points = [(0.3, 0.3, 0.5), (0.7, 0.6, 0.4), (0.2, 0.8, 0.6)]
    ball = make_ball(radius=0.1, center=(0.0, 0.0, 0.0))
    host = instance_on_vertices(ball, points)
    copies = [make_ball(f"Copy {i}", 0.1, point) for i, point in enumerate(points)]
    update()
    try:
        assert_same_surface(read(host, make_box()), read(joined(copies), make_box("Other")))
    finally:
        bpy.data.node_groups.remove(host.modifiers["Put"].node_group)


def test_particle_instances_are_read(fresh, read):
    ball = make_ball(radius=0.05, center=(0.0, 0.0, 0.0))
    plane = scenes.make_plane("Ground", 1.0)
    plane.location.z = 0.5
    bpy.context.view_layer.objects.active = plane
    modifier = plane.modifiers.new("Grains", 'PARTICLE_SYSTEM')
    settings = modifier.particle_system.settings
    settings.count, settings.frame_start, settings.frame_end, settings.lifetime = 7, 1, 1, 100
    settings.physics_type, settings.render_type, settings.instance_object = 'NO', 'OBJECT', ball
    settings.particle_size = 1.0
    plane.show_instancer_for_viewport = False
    bpy.context.scene.frame_set(2)
    surface = read(plane, make_box())
    bpy.context.scene.frame_set(1)
    assert len(surface.triangles) == 7 * len(BALL_TRIANGLES)


def test_hidden_object_is_read(fresh, read):
    ball = make_ball()
    expected = read(ball, make_box())
    ball.hide_set(True)
    assert_same_surface(read(ball, bpy.data.objects["Box"]), expected)


def test_cutters_are_left_out_with_a_notice(fresh, read):
    ball, cutter = make_ball(), make_ball("Cutter", 0.2, (0.7, 0.5, 0.5))
    expected = read(ball, make_box())
    cutter.display_type = 'WIRE'
    surface = read(in_collection("Tile", ball, cutter), bpy.data.objects["Box"])
    assert_same_surface(surface, expected)
    assert any("wires" in notice for notice in surface.notices)


# --- what comes back on the other side


def test_what_leaves_a_side_comes_back(native, fresh, read):
    """A tile whose ball is moved by whole periods, and one cut off by the border, bake alike."""
    ball, box = make_ball(center=(0.9, 0.1, 0.5)), make_box()
    whole = read(ball, box)
    ball.location = (-1.0, 1.0, 0.0)
    moved = read(ball, box)
    assert abs(moved.positions - whole.positions).max() > 0.5
    baked = []
    for surface in (whole, moved):
        sample = native.Sample(surface.positions, surface.triangles, height=surface.height, aspect=surface.aspect)
        baked.append(np.array(native.bake_gdm(sample, resolution=(8, 8, 4), directions=(6, 8)).values))
    np.testing.assert_allclose(baked[0], baked[1], atol=2e-5)
    assert (baked[0] == 0).any(), "some nodes lie inside"


def test_what_leaves_through_the_top_is_clipped_with_a_notice(native, fresh, part, tmp_path):
    make_ball(center=(0.5, 0.5, 0.9))
    make_box()
    update()
    assert bpy.ops.mesoshell.bake(tile="Ball", box="Box", filepath=str(tmp_path / "cut.gdm.exr"), resolution=(4, 4, 5),
                                  directions=(2, 4), sdf_resolution=(8, 8, 9), terms=2) == {'FINISHED'}
    assert any("Ball" in notice and "clipped" in notice for notice in part("host.bake_state").notices)


# --- color


def colored_material(name, **inputs):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    shader = next(node for node in material.node_tree.nodes if node.type == 'BSDF_PRINCIPLED')
    for key, value in inputs.items():
        shader.inputs[key.replace("_", " ")].default_value = value
    return material, shader


@pytest.fixture
def materials():
    """Materials and images that the test adds are removed."""
    before = {name: set(getattr(bpy.data, name)) for name in ("materials", "images")}
    yield
    for name, known in before.items():
        for item in set(getattr(bpy.data, name)) - known:
            getattr(bpy.data, name).remove(item)


def final_colors(surface):
    """The color that each corner ends with, where no image says it: float [m, 3, 3]."""
    base = np.array([material["color"] for material in surface.materials])[surface.material_indices][:, None, :]
    return base * (np.ones((1, 3, 1)) if surface.colors is None else surface.colors)


@pytest.mark.parametrize("kind, domain", itertools.product(["FLOAT_COLOR", "BYTE_COLOR"], ["POINT", "CORNER"]))
def test_vertex_colors_arrive(fresh, read, kind, domain):
    """Color = position, whatever the attribute's type and domain; 8-bit ones are stored encoded and read linear."""
    ball = make_ball()
    attribute = ball.data.color_attributes.new("Paint", kind, domain)
    positions = np.array([vertex.co for vertex in ball.data.vertices])
    where = positions if domain == 'POINT' else positions[[loop.vertex_index for loop in ball.data.loops]]
    attribute.data.foreach_set("color", np.column_stack([where, np.ones(len(where))]).astype(np.float32).ravel())
    surface = read(ball, make_box())
    tolerance = 1e-6 if kind == "FLOAT_COLOR" else 0.01
    np.testing.assert_allclose(final_colors(surface), surface.positions[surface.triangles], atol=tolerance)


def test_constants_of_each_material_arrive(fresh, read, materials):
    ball = make_ball()
    steel, _ = colored_material("Steel", Base_Color=(0.1, 0.2, 0.3, 1.0), Roughness=0.25, Metallic=1.0)
    clay, _ = colored_material("Clay", Base_Color=(0.7, 0.2, 0.1, 1.0), Roughness=0.75)
    ball.data.materials.append(steel)
    ball.data.materials.append(clay)
    above = np.array([polygon.center.z > 0.5 for polygon in ball.data.polygons])
    ball.data.polygons.foreach_set("material_index", above.astype(np.int32))
    surface = read(ball, make_box())
    top = surface.positions[surface.triangles][:, :, 2].mean(axis=1) > 0.5
    for own, color, roughness, metallic in ((~top, (0.1, 0.2, 0.3), 0.25, 1.0), (top, (0.7, 0.2, 0.1), 0.75, 0.0)):
        assert own.any()
        np.testing.assert_allclose(final_colors(surface)[own], np.broadcast_to(color, (own.sum(), 3, 3)), atol=1e-6)
        found = [surface.materials[index] for index in set(surface.material_indices[own])]
        assert all((m["roughness"], m["metallic"]) == pytest.approx((roughness, metallic)) for m in found)
        assert all(m["image"] is None for m in found)


@pytest.mark.parametrize("is_float, space", [(True, "Non-Color"), (False, "sRGB"), (False, "Non-Color")])
def test_image_texture_arrives(fresh, read, materials, is_float, space):
    """A gradient image on UVs = (x, y): its pixels are linear, its first row is v = 0, the UVs come along."""
    ball = make_ball()
    corners = np.array([ball.data.vertices[loop.vertex_index].co for loop in ball.data.loops])
    ball.data.uv_layers.new(name="UVMap").data.foreach_set("uv", corners[:, :2].astype(np.float32).ravel())
    image = bpy.data.images.new("Gradient", 4, 2, float_buffer=is_float)
    image.colorspace_settings.name = space
    stored = np.zeros((2, 4, 4), np.float32)
    stored[..., 0], stored[1, :, 1], stored[..., 3] = [0.0, 0.25, 0.5, 1.0], 1.0, 1.0
    image.pixels.foreach_set(stored.ravel())
    material, shader = colored_material("Painted")
    texture = material.node_tree.nodes.new('ShaderNodeTexImage')
    texture.image = image
    material.node_tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    ball.data.materials.append(material)
    surface = read(ball, make_box())
    np.testing.assert_allclose(surface.uvs, surface.positions[surface.triangles][..., :2], atol=1e-6)
    pixels = surface.materials[surface.material_indices[0]]["image"]
    assert pixels.shape == (2, 4, 3) and pixels.dtype == np.float32
    linear = [0.0, 0.0508761, 0.2140411, 1.0] if space == "sRGB" else [0.0, 0.25, 0.5, 1.0]
    np.testing.assert_allclose(pixels[0, :, 0], linear, atol=0.004 if not is_float else 1e-6)
    np.testing.assert_allclose(pixels[:, 0, 1], [0.0, 1.0], atol=1e-6)
    assert surface.colors is None or (surface.colors == 1.0).all()


def test_large_images_are_averaged(fresh, part):
    image = bpy.data.images.new("Large", 4096, 1024, float_buffer=True)
    ramp = np.zeros((1024, 4096, 4), np.float32)
    ramp[..., 0] = np.arange(4096)
    image.pixels.foreach_set(ramp.ravel())
    pixels = part("host.images").linear_pixels(image)
    assert pixels.shape == (512, 2048, 3)
    np.testing.assert_allclose(pixels[0, :, 0], 2 * np.arange(2048) + 0.5)


def test_color_that_can_not_be_followed_is_a_notice(fresh, read, materials):
    ball = make_ball()
    material, shader = colored_material("Marble", Base_Color=(0.3, 0.4, 0.5, 1.0))
    noise = material.node_tree.nodes.new('ShaderNodeTexNoise')
    material.node_tree.links.new(noise.outputs["Color"], shader.inputs["Base Color"])
    ball.data.materials.append(material)
    surface = read(ball, make_box())
    assert any("Marble" in notice for notice in surface.notices)
    np.testing.assert_allclose(final_colors(surface), np.broadcast_to([0.3, 0.4, 0.5], (len(surface.triangles), 3, 3)),
                               rtol=1e-6)
