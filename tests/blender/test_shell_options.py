"""Every option of a shell reaches what is built: what comes out, in closed form where there is one."""

import bpy
import numpy as np
import pytest
import scenes


@pytest.fixture
def shells(part):
    part("host.shells").forget()
    return part("host.shells")


@pytest.fixture
def instance_of(shells, map_file):
    """instance_of(obj, **settings) -> what is drawn of a shell 0.1 thick, unless it says otherwise."""
    def add(obj, **settings):
        scenes.add_shell(obj, map_file, **{"thickness": 0.1} | settings)
        return now(shells)
    return add


def now(shells):
    bpy.context.view_layer.update()
    instance, = shells.visible(bpy.context.evaluated_depsgraph_get())
    return instance


def base(shell):
    """[n, 3] of the vertices that prisms have, at their bases, and their tops."""
    low, high = np.zeros((len(shell.positions), 3)), np.zeros((len(shell.positions), 3))
    triangles = np.asarray(shell.triangles)
    corners = np.asarray(shell.prisms)[:, :6, :3]
    low[triangles], high[triangles] = corners[:, :3], corners[:, 3:]
    used = np.unique(triangles)
    return low[used], high[used]


def base_uvs(shell):
    """[p, 3, 2]: tiles at the corners of prisms."""
    return np.asarray(shell.uvs)[np.asarray(shell.uv_triangles)]


def test_settings_of_the_operator_stay_with_the_object(shells, part, instance_of, fresh):
    grid = scenes.make_grid("Sheet")
    given = dict(surface='CAGE', subdivision='OWN', refine='LENGTH', levels=2, most_levels=3, edge_length=0.5,
                 edge_pixels=8.0, scheme="bilinear", boundary="edges", uv_rule="linear", use_creases=False, part='ALL',
                 part_name="x", thickness=0.25, offset="centered", smooth_directors=2, repair=True, relax=3, fins="paper",
                 placement='METER', tiles_u=2.0, tiles_v=3.0, uv_rotation=0.5, uv_offset=(0.25, 0.5), traversal="gdm",
                 base_color=(0.5, 0.25, 0.125))
    instance = instance_of(grid, **given)
    for name, value in given.items():
        held = getattr(grid.mesoshell, name)
        assert (tuple(held) if isinstance(value, tuple) else held) == value, name
    left = set(part("host.shell_options").NAMES) - set(given)
    assert left == {"thickness_group", "fit_thickness"}, "another option is to be added here"
    assert instance.settings.fins == "paper"
    assert now(shells).shell is instance.shell, "what the operator built is what is drawn"


@pytest.mark.parametrize("kind", ['MATERIAL', 'SLOT', 'VERTEX_GROUP', 'BOOLEAN', 'INT', 'FLOAT', 'POINT'])
def test_prisms_stand_on_the_part_only(instance_of, fresh, kind):
    """The faces left of x = 1 are marked, each in its own way; the others have no prisms."""
    grid = scenes.make_grid("Sheet", 4)
    mesh = grid.data
    marked = np.array([face.center.x < 1.0 for face in mesh.polygons])
    name = "Left"
    if kind in {'MATERIAL', 'SLOT'}:
        for material in ("Other", "Left"):
            mesh.materials.append(bpy.data.materials.new(material))
        mesh.polygons.foreach_set("material_index", marked.astype(np.int32))
        settings, name = dict(part='MATERIAL'), mesh.materials[1].name if kind == 'MATERIAL' else "1"
    elif kind == 'VERTEX_GROUP':
        group = grid.vertex_groups.new(name=name)
        for vertex in mesh.vertices:
            group.add([vertex.index], 0.5 if vertex.co.x <= 1.0 else 0.49, 'REPLACE')
        settings = dict(part='VERTEX_GROUP')
    else:
        domain = 'POINT' if kind == 'POINT' else 'FACE'
        attribute = mesh.attributes.new(name, 'FLOAT' if kind == 'POINT' else kind, domain)
        values = marked if domain == 'FACE' else np.array([vertex.co.x <= 1.0 for vertex in mesh.vertices])
        low, high = {'BOOLEAN': (False, True), 'INT': (0, 3)}.get(kind, (0.4, 0.6))
        attribute.data.foreach_set("value", np.where(values, high, low))
        settings = dict(part='ATTRIBUTE')
    mesh.update()
    for levels in (0, 1):
        shell = instance_of(grid, part_name=name, levels=levels, **settings).shell
        assert set(np.asarray(shell.faces)) == set(np.flatnonzero(marked))
        assert shell.prism_count == 2 * marked.sum() * 4 ** levels
        assert np.asarray(shell.prisms)[:, :6, 0].max() <= 1.0 + 1e-6


def test_a_part_of_a_mesh_with_n_gons(instance_of, fresh):
    """A pentagon that is split at level 0 is covered as one face."""
    places = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [3, .5, 0], [2, 1, 0]]
    faces = [[0, 1, 2, 3], [1, 4, 5, 6, 2]]
    mixed = scenes.make_object("Mixed", places, faces, np.array(places)[np.concatenate(faces)][:, :2])
    mixed.data.attributes.new("mark", 'BOOLEAN', 'FACE').data.foreach_set("value", [False, True])
    shell = instance_of(mixed, part='ATTRIBUTE', part_name="mark").shell
    assert shell.prism_count == 3 and np.asarray(shell.prisms)[:, :6, 0].min() >= 1.0 - 1e-6


@pytest.mark.parametrize("settings, words", [
    (dict(part='MATERIAL', part_name="Gold"), 'no material "Gold"'),
    (dict(part='VERTEX_GROUP', part_name="Head"), 'no vertex group "Head"'),
    (dict(part='ATTRIBUTE', part_name="mark"), 'no attribute "mark"'),
    (dict(part='ATTRIBUTE', part_name="UVMap"), "UVMap"),
    (dict(part='ATTRIBUTE'), "has no name"),
    (dict(thickness_group="Head"), 'no vertex group "Head"'),
    (dict(thickness_image="Dust"), "Dust"),
    (dict(refine='SCREEN'), "no camera"),
])
def test_what_is_not_there_is_a_sentence(fresh, map_file, settings, words):
    grid = scenes.make_grid("Sheet")
    camera, fresh.camera = fresh.camera, None
    bpy.context.view_layer.update()
    try:
        with pytest.raises(RuntimeError, match=words):
            bpy.ops.mesoshell.add_shell(object=grid.name, filepath=str(map_file), thickness=0.1, **settings)
    finally:
        fresh.camera = camera
    assert not grid.mesoshell.enabled


def test_thickness_follows_a_vertex_group(instance_of, shells, fresh):
    """The weight is x / 2; a vertex that is not in the group has none."""
    grid = scenes.make_grid("Sheet", 4)
    group = grid.vertex_groups.new(name="Thick")
    for vertex in grid.data.vertices:
        if vertex.co.x > 0.0:
            group.add([vertex.index], vertex.co.x / 2, 'REPLACE')
    shell = instance_of(grid, thickness_group="Thick").shell
    low, high = base(shell)
    np.testing.assert_allclose(high[:, 2] - low[:, 2], 0.1 * low[:, 0] / 2, atol=1e-6)
    group.add(range(len(grid.data.vertices)), 1.0, 'REPLACE')
    grid.data.update()
    grid.update_tag()
    low, high = base(now(shells).shell)
    np.testing.assert_allclose(high[:, 2] - low[:, 2], 0.1, atol=1e-6)


def test_thickness_follows_an_image(instance_of, shells, fresh):
    """Its red channel at the UVs, whatever the tiles: 0.25 on the left, 0.75 on the right half."""
    image = bpy.data.images.new("Thick", 64, 8, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.zeros((8, 64, 4), np.float32)
    pixels[:, :32, 0], pixels[:, 32:, 0], pixels[..., 3] = 0.25, 0.75, 1.0
    image.pixels.foreach_set(pixels.ravel())
    grid = scenes.make_grid("Sheet", 8)
    low, high = base(instance_of(grid, thickness_image=image.name, tiles_u=3.0, tiles_v=2.0).shell)
    inside = np.abs(low[:, 0] - 1.0) < 0.9  # images repeat, so that borders blend with the other side
    inside &= np.abs(low[:, 0] - 1.0) > 0.1
    np.testing.assert_allclose((high[:, 2] - low[:, 2])[inside], np.where(low[inside, 0] < 1.0, 0.025, 0.075), atol=1e-6)
    pixels[..., 0] = 0.5
    image.pixels.foreach_set(pixels.ravel())
    image.update_tag()
    low, high = base(now(shells).shell)
    np.testing.assert_allclose(high[:, 2] - low[:, 2], 0.05, atol=1e-6)
    grid.mesoshell.thickness_image = None
    low, high = base(now(shells).shell)
    np.testing.assert_allclose(high[:, 2] - low[:, 2], 0.1, atol=1e-6)


@pytest.mark.parametrize("offset, low, high", [("outward", 0.0, 0.1), ("centered", -0.05, 0.05), ("inward", -0.1, 0.0)])
def test_offset(instance_of, fresh, offset, low, high):
    bottom, top = base(instance_of(scenes.make_grid("Sheet"), offset=offset).shell)
    np.testing.assert_allclose(bottom[:, 2], low, atol=1e-6)
    np.testing.assert_allclose(top[:, 2], high, atol=1e-6)


def test_directors_are_smoothed(instance_of, fresh):
    """A ridge's directors differ less from their neighbors' after some steps."""
    grid = scenes.make_grid("Sheet", 6)
    for vertex in grid.data.vertices:
        vertex.co.z = 0.5 if abs(vertex.co.x - 1.0) < 0.01 else 0.0
    rough, smooth = (np.asarray(instance_of(grid, smooth_directors=steps).shell.directors) for steps in (0, 10))
    assert smooth[:, 2].min() > rough[:, 2].min() + 0.05


def test_placement_scales_then_turns_then_moves(instance_of, fresh):
    grid = scenes.make_grid("Sheet", 2)
    shell = instance_of(grid, tiles_u=3.0, tiles_v=2.0, uv_rotation=np.pi / 2, uv_offset=(0.25, -0.5)).shell
    places = np.asarray(shell.prisms)[:, :3, :2] / 2.0  # the grid's UVs
    expected = np.stack([-2.0 * places[..., 1] + 0.25, 3.0 * places[..., 0] - 0.5], axis=-1)
    np.testing.assert_allclose(base_uvs(shell), expected, atol=1e-5)


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (3.0, 3.0, 3.0), (2.0, 0.5, 1.0), (-1.0, 2.0, 1.0)])
def test_tiles_per_meter(instance_of, shells, fresh, scale):
    """Two tiles a meter along x and three along y, whatever the object's scale, its UVs and the scene's unit."""
    grid = scenes.make_grid("Sheet", 4)
    uvs = np.empty(2 * len(grid.data.loops), np.float32)
    grid.data.uv_layers[0].data.foreach_get("uv", uvs)
    grid.data.uv_layers[0].data.foreach_set("uv", (uvs.reshape(-1, 2) * [0.2, 7.0]).astype(np.float32).ravel())
    grid.scale = scale
    for unit in (1.0, 0.01):
        fresh.unit_settings.scale_length = unit
        try:
            shell = instance_of(grid, placement='METER', tiles_u=2.0, tiles_v=3.0).shell
        finally:
            fresh.unit_settings.scale_length = 1.0
        size = 2.0 * np.abs(scale[:2]) * unit  # meters
        np.testing.assert_allclose(np.ptp(base_uvs(shell).reshape(-1, 2), axis=0), size * [2.0, 3.0], rtol=1e-5)


def test_a_fitted_thickness_follows_the_tiles(instance_of, shells, fresh):
    """A tile as wide as 2 / tiles_u of the object's units is scenes.HEIGHT of that high."""
    grid = scenes.make_grid("Sheet")
    grid.scale = (5.0, 5.0, 5.0)
    instance_of(grid, fit_thickness=True)
    for tiles in (1.0, 4.0):
        grid.mesoshell.tiles_u = tiles
        low, high = base(now(shells).shell)
        np.testing.assert_allclose(high[:, 2] - low[:, 2], scenes.HEIGHT * 2.0 / tiles, rtol=1e-5)
        assert shells.thickness(grid) == pytest.approx(scenes.HEIGHT * 2.0 / tiles, rel=1e-5)
    grid.mesoshell.placement = 'METER'  # four tiles a meter, on 10 m: of 2 units, a fourtieth
    low, high = base(now(shells).shell)
    np.testing.assert_allclose(high[:, 2] - low[:, 2], scenes.HEIGHT * 2.0 / 40.0, rtol=1e-5)
    grid.mesoshell.uv_rotation = 1.0
    grid.mesoshell.tiles_v = 4.0
    low, high = base(now(shells).shell)
    np.testing.assert_allclose(high[:, 2] - low[:, 2], scenes.HEIGHT * 2.0 / 40.0, rtol=1e-5)


def longest_edge(shell):
    corners = np.asarray(shell.positions, float)[np.asarray(shell.triangles)]
    sides = np.sort(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2), axis=1)
    return sides[:, 1].max()  # the longest is a quad's diagonal


def test_edges_are_as_short_in_the_scene_as_asked(instance_of, fresh):
    """A sheet of 2 x 2 units: edges of 0.3 ask for seven parts or more; scaled by four, of four times as many."""
    grid = scenes.make_grid("Sheet", 1)
    small = instance_of(grid, refine='LENGTH', edge_length=0.3, most_levels=8, scheme="bilinear").shell
    assert longest_edge(small) <= 0.3 + 1e-5 and 2 * 7 ** 2 <= small.prism_count <= 2 * 16 ** 2
    grid.scale = (4.0, 4.0, 4.0)
    large = instance_of(grid, refine='LENGTH', edge_length=0.3, most_levels=8, scheme="bilinear").shell
    assert 4.0 * longest_edge(large) <= 0.3 + 1e-5 and 2 * 27 ** 2 <= large.prism_count <= 2 * 64 ** 2
    assert instance_of(grid, refine='LENGTH', edge_length=0.3, most_levels=1, scheme="bilinear").shell.prism_count <= 8


def test_edges_are_as_short_in_the_picture_as_asked(instance_of, shells, fresh):
    """A sheet of 2 units that fills the width of 200 pixels: 40 pixels are a fifth of it; seen from twice as far, less."""
    grid = scenes.make_grid("Sheet", 1)
    camera = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
    fresh.collection.objects.link(camera)
    camera.location, camera.data.type, camera.data.ortho_scale = (1.0, 1.0, 5.0), 'ORTHO', 2.0
    render = fresh.render
    before = fresh.camera, render.resolution_x, render.resolution_y, render.resolution_percentage
    fresh.camera = camera
    render.resolution_x, render.resolution_y, render.resolution_percentage = 400, 400, 50
    try:
        near = instance_of(grid, refine='SCREEN', edge_pixels=40.0, most_levels=6, scheme="bilinear").shell
        camera.data.ortho_scale = 4.0
        far = now(shells).shell
    finally:
        fresh.camera, render.resolution_x, render.resolution_y, render.resolution_percentage = before
    assert longest_edge(near) <= 0.4 + 1e-5 and longest_edge(far) <= 0.8 + 1e-5
    assert 2 * 5 ** 2 <= near.prism_count <= 2 * 16 ** 2 and far.prism_count < near.prism_count


def test_repair_reaches_the_shell(native, instance_of, fresh):
    """A narrow valley, whose walls' prisms cross each other until they are thinner."""
    xs = [-1.0, -0.1, 0.1, 1.0]
    places = [(x, y, 0.0 if abs(x) > 0.5 else -1.0) for y in (0.0, 1.0) for x in xs]
    faces = [[i, i + 1, i + 5, i + 4] for i in range(3)]
    valley = scenes.make_object("Valley", places, faces, np.array(places)[np.concatenate(faces)][:, :2])
    broken = native.find_folds(instance_of(valley, thickness=0.8).shell)
    assert np.any(broken["inverted"]) or np.any(broken["intersecting"])
    mended = native.find_folds(instance_of(valley, thickness=0.8, repair=True).shell)
    assert not np.any(mended["inverted"]) and not np.any(mended["intersecting"])


def test_relaxation_reaches_the_shell(native, instance_of, chain_scene):
    before = instance_of(chain_scene.torus, tiles_u=6.0, tiles_v=3.0, thickness=0.3).shell
    after = instance_of(chain_scene.torus, tiles_u=6.0, tiles_v=3.0, thickness=0.3, relax=10).shell
    np.testing.assert_array_equal(np.asarray(before.uvs), np.asarray(after.uvs))
    assert native.stretch(after)["total"] < native.stretch(before)["total"]
