"""mesoshell.realize: a closed mesh object whose geometry is the native module's, and whose looks are the tile's."""

import bpy
import numpy as np
import pytest
import scenes

RINGS, SEGMENTS = 12, 24


@pytest.fixture
def ball(fresh):
    """A coarse sphere of the lattice that the map shows, with two materials, UVs (u, w) and colors (u, v, w) of the tile."""
    positions, triangles = scenes.make_sphere_mesh(RINGS, SEGMENTS)
    tile_places = positions * scenes.RADIUS + scenes.CENTER
    shares = tile_places / [1.0, scenes.ASPECT, scenes.HEIGHT]
    obj = scenes.make_object("Ball", tile_places * scenes.WIDTH, triangles, shares[triangles.ravel()][:, [0, 2]])
    obj.data.uv_layers[0].name = "Painted"
    colors = obj.data.color_attributes.new("Tint", 'FLOAT_COLOR', 'POINT')
    colors.data.foreach_set("color", np.column_stack([shares, np.ones(len(shares))]).astype(np.float32).ravel())
    for name in ("Lower", "Upper"):
        obj.data.materials.append(bpy.data.materials.new(name))
    upper = shares[triangles][..., 2].mean(axis=1) > 0.5
    obj.data.polygons.foreach_set("material_index", upper.astype(np.int32))
    obj.data.polygons.foreach_set("use_smooth", np.ones(len(triangles), bool))
    tile = obj.mesoshell_tile
    tile.is_tile, tile.height = True, scenes.WIDTH * scenes.HEIGHT
    tile.period_u, tile.period_v = scenes.WIDTH, scenes.WIDTH * scenes.ASPECT
    return obj


@pytest.fixture
def torus(fresh, map_file, ball):
    obj = scenes.make_torus("Ring", around=24, across=12)
    obj.location, obj.rotation_euler = (1.0, 2.0, 3.0), (0.1, 0.2, 0.3)
    scenes.add_shell(obj, map_file, thickness=0.2, tiles_u=5.0, tiles_v=2.0)
    return obj


def realize(obj, **settings):
    known = set(bpy.data.objects)
    assert bpy.ops.mesoshell.realize(object=obj.name, **settings) == {'FINISHED'}
    made, = set(bpy.data.objects) - known
    return made


def array(collection, name, width, kind=np.float32):
    values = np.empty(len(collection) * width, kind)
    collection.foreach_get(name, values)
    return values.reshape(-1, width) if width > 1 else values


def corners_of(mesh):
    return array(mesh.loops, "vertex_index", 1, np.int32).reshape(-1, 3)


@pytest.fixture
def native_mesh(native, part):
    """native_mesh(obj, tile): what the native module makes of the same, by the arrays that a bake reads."""
    def run(obj, tile, **settings):
        depsgraph = bpy.context.evaluated_depsgraph_get()
        chosen = part("host.chosen_source")
        choice = chosen.choose(bpy.context, source='OBJECT', tile=tile)
        surface = chosen.read(choice, depsgraph)
        sample = native.Sample(surface.positions, surface.triangles, height=surface.height, aspect=surface.aspect)
        return native.realize(part("host.shells").one(obj, depsgraph).shell, sample, **settings)
    return run


def test_geometry_is_the_native_modules(torus, ball, native_mesh):
    made = realize(torus, tile="Ball", error=0.004)
    expected = native_mesh(torus, ball, error=0.004)
    assert np.array_equal(array(made.data.vertices, "co", 3), expected["positions"])
    assert np.array_equal(corners_of(made.data), expected["triangles"])
    # Ten balls, each closed: two sides of every edge, and an Euler characteristic of two.
    faces_at = np.bincount(array(made.data.loops, "edge_index", 1, np.int32))
    assert (faces_at == 2).all()
    assert len(made.data.vertices) - len(faces_at) + len(made.data.polygons) == 2 * 10
    assert not made.data.validate(), "Blender found something to repair"


def test_it_lies_beside_its_surface(torus, ball, fresh):
    collection = bpy.data.collections.new("Second")
    fresh.collection.children.link(collection)
    collection.objects.link(torus)
    made = realize(torus, tile="Ball")
    assert made.name == "Ring Mesostructure"
    assert set(made.users_collection) == {fresh.collection, collection}
    assert np.allclose(np.array(made.matrix_world), np.array(torus.matrix_world))
    assert bpy.context.view_layer.objects.active == made and bpy.context.selected_objects == [made]
    assert not made.mesoshell.enabled and torus.mesoshell.enabled


def test_materials_uvs_and_colors_are_the_tiles(torus, ball, native_mesh):
    made = realize(torus, tile="Ball")
    texture = native_mesh(torus, ball)["texture"]
    within = texture.copy()
    within[..., :2] -= np.floor(texture[..., :2].mean(axis=1, keepdims=True))
    uvs = array(made.data.uv_layers["Painted"].data, "uv", 2).reshape(-1, 3, 2)
    assert np.abs(uvs - within[..., [0, 2]]).max() < 1e-5
    colors = array(made.data.color_attributes["Tint"].data, "color", 4).reshape(-1, 3, 4)
    assert np.abs(colors[..., :3] - within).max() < 1e-5 and (colors[..., 3] == 1.0).all()
    assert [material.name for material in made.data.materials] == ["Lower", "Upper"]
    upper = array(made.data.polygons, "material_index", 1, np.int32) == 1
    assert np.array_equal(upper, within[..., 2].mean(axis=1) > 0.5)


def test_normals_are_as_smooth_as_the_tiles(part, ball, fresh, map_file):
    """Over a plane, with the tile's proportions, balls are balls again; the border halves one, and is flat there."""
    plane = scenes.make_grid("Sheet", 3, size=3.0)
    scenes.add_shell(plane, map_file, thickness=2.0 * scenes.HEIGHT, tiles_u=1.5, tiles_v=1.5 / scenes.ASPECT)
    made = realize(plane, tile="Ball")
    normals = part("host.versions").corner_normals(made.data).reshape(-1, 3, 3)
    corners = array(made.data.vertices, "co", 3)[corners_of(made.data)]
    first = corners[..., :1].mean(axis=1, keepdims=True) < 2.0
    centers = np.where(first, [1.0, scenes.ASPECT, scenes.HEIGHT], [3.0, scenes.ASPECT, scenes.HEIGHT])
    away = corners - centers
    away /= np.maximum(np.linalg.norm(away, axis=-1, keepdims=True), 1e-30)
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat /= np.maximum(np.linalg.norm(flat, axis=-1, keepdims=True), 1e-30)
    ball_faces = (flat * away.mean(axis=1)).sum(axis=1) > 0.95
    assert ball_faces.sum() > 300
    # Blender keeps custom normals in 16 bits; the tile's vertices have the mean of their faces' normals.
    assert (normals * away)[ball_faces].sum(axis=-1).min() > np.cos(0.5 * np.pi / RINGS / 2)
    caps = ~ball_faces
    assert caps.any() and (normals[caps] * flat[caps][:, None]).sum(axis=-1).min() > 0.999


def test_the_scene_names_the_tile_if_the_call_does_not(torus, ball, fresh):
    with pytest.raises(RuntimeError, match="No tile is chosen"):
        bpy.ops.mesoshell.realize(object="Ring")
    fresh.mesoshell.tile = ball
    assert len(realize(torus).data.polygons) > 1000


def test_without_caps_it_is_open_where_it_is_cut(ball, fresh, map_file):
    plane = scenes.make_grid("Sheet", 3)
    scenes.add_shell(plane, map_file, thickness=0.2, tiles_u=1.5, tiles_v=1.5)
    for caps in (True, False):
        made = realize(plane, tile="Ball", caps=caps)
        faces_at = np.bincount(array(made.data.loops, "edge_index", 1, np.int32))
        assert (faces_at == 2).all() == caps


def test_refusals_name_the_thing_and_the_remedy(torus, ball, fresh):
    before = set(bpy.data.objects)
    sheet = scenes.make_grid("Bare", 2)
    with pytest.raises(RuntimeError, match='"Bare" has no shell'):
        bpy.ops.mesoshell.realize(object="Bare", tile="Ball")
    with pytest.raises(RuntimeError, match='no object in the scene .* called "Bell"'):
        bpy.ops.mesoshell.realize(object="Ring", tile="Bell")
    torus.mesoshell.tiles_u = torus.mesoshell.tiles_v = 150.0
    with pytest.raises(RuntimeError, match="triangles or more in 576 prisms.*Most Triangles"):
        bpy.ops.mesoshell.realize(object="Ring", tile="Ball", most_triangles=1)
    assert set(bpy.data.objects) == before | {sheet}


def test_estimates_are_near_what_comes_out(torus, ball, part, native_mesh):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    chosen = part("host.chosen_source")
    surface = chosen.read(chosen.choose(bpy.context, source='OBJECT', tile=ball), depsgraph)
    shell = part("host.shells").one(torus, depsgraph).shell
    estimate = part("core.realized").estimated_triangles(shell.prisms, surface)
    assert 0.6 < estimate / len(native_mesh(torus, ball, error=1.0)["triangles"]) < 1.7
