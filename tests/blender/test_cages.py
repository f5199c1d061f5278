"""The surface that a shell is built on, against Blender's own subdivision: cages, creases, boundaries, UVs, normals."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes


@pytest.fixture
def shells(part):
    part("host.shells").forget()
    return part("host.shells")


@pytest.fixture
def put(shells, map_file):
    """put(obj, **settings) -> the native Shell that is drawn, of thickness 0.01 unless it says otherwise."""
    def add(obj, **settings):
        scenes.add_shell(obj, map_file, **{"thickness": 0.01} | settings)
        return shells.visible(bpy.context.evaluated_depsgraph_get())[0].shell
    return add


def subdivide(obj, levels=2, **settings):
    modifier = obj.modifiers.new("Subdivision", 'SUBSURF')
    modifier.levels = modifier.render_levels = levels
    modifier.quality = 10  # as near to the limit as Blender goes
    modifier.use_limit_surface = True
    for name, value in settings.items():
        setattr(modifier, name, value)
    return modifier


def evaluated_points(obj):
    """What Blender makes of an object: [corners, 5], positions and UVs of all corners."""
    bpy.context.view_layer.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    positions = np.array([vertex.co for vertex in mesh.vertices])
    corners = np.array([loop.vertex_index for loop in mesh.loops])
    uvs = np.array([entry.uv for entry in mesh.uv_layers.active.data])
    evaluated.to_mesh_clear()
    return np.hstack([positions[corners], uvs])


def shell_points(shell):
    """[3 p, 5], positions on the surface and UVs of all corners of prisms."""
    positions = np.asarray(shell.positions)[np.asarray(shell.triangles)]
    uvs = np.asarray(shell.uvs)[np.asarray(shell.uv_triangles)]
    return np.concatenate([positions, uvs], axis=2).reshape(-1, 5)


def farthest(points, others):
    """The largest distance from any of `points` to the nearest of `others`."""
    points, others = np.unique(points.round(6), axis=0), np.unique(others.round(6), axis=0)
    return max(np.sqrt(((block[:, None] - others[None]) ** 2).sum(-1).min(1)).max()
               for block in np.array_split(points, len(points) // 64 + 1))


def check_same_points(points, others, tolerance):
    """Each of `points` has one of `others` beside it, and the other way around."""
    distances = farthest(points, others), farthest(others, points)
    assert max(distances) < tolerance, f"apart by {distances[0]:.2g} and {distances[1]:.2g}"


def make_cube():
    """A cube of side 2 with UVs."""
    places = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return scenes.make_object("Block", places, faces, [(0, 0), (1, 0), (1, 1), (0, 1)] * 6)


def crease(obj, edges=(), vertices=()):
    """Sets creases in any version: {index: crease}."""
    edited = bmesh.new()
    edited.from_mesh(obj.data)
    for elements, values, name in ((edited.edges, edges, "crease_edge"), (edited.verts, vertices, "crease_vert")):
        if not values:
            continue
        elements.ensure_lookup_table()
        if hasattr(elements.layers, "crease"):
            layer = elements.layers.crease.verify()
        else:
            layer = elements.layers.float.get(name) or elements.layers.float.new(name)
        for index, value in dict(values).items():
            elements[index][layer] = value
    edited.to_mesh(obj.data)
    edited.free()


def ring(cube):
    """The edges around the cube's top, creased sharply."""
    places = cube.data.vertices
    return {edge.index: 1.0 for edge in cube.data.edges if all(places[index].co.z > 0 for index in edge.vertices)}


@pytest.mark.parametrize("edges, vertices", [(None, {}), (ring, {}), (None, {0: 1.0, 5: 1.0}), (ring, {0: 1.0})],
                         ids=["smooth", "sharp ring", "sharp corners", "both"])
def test_creased_cages_reach_the_limit_that_blender_does(put, fresh, edges, vertices):
    """Blender's evaluated vertices are ours, at the same level."""
    cube = make_cube()
    crease(cube, edges(cube) if edges else {}, vertices)
    subdivide(cube, 3)
    theirs = evaluated_points(cube)[:, :3]
    shell = put(cube, surface='CAGE', subdivision='MODIFIER')
    assert shell.prism_count == 2 * 6 * 4 ** 3
    check_same_points(theirs, np.asarray(shell.positions), 1e-4)


@pytest.mark.parametrize("edges, vertices", [({0: 0.2, 3: 0.5, 4: 0.7, 7: 0.6}, {}), ({}, {1: 0.3, 6: 0.6}),
                                             ({2: 0.6, 9: 0.35}, {3: 0.7})], ids=["edges", "corners", "both"])
def test_semi_sharp_creases_are_as_sharp_as_blenders(put, fresh, edges, vertices):
    """Sharpness is 10 times the crease's square, up to 4.9 here: at level 2 much of it is left."""
    cube = make_cube()
    crease(cube, edges, vertices)
    subdivide(cube, 2)
    theirs = evaluated_points(cube)[:, :3]
    smooth = np.asarray(put(cube, surface='CAGE', levels=5, boundary="edges", use_creases=False).positions)
    assert farthest(theirs, smooth) > 0.01
    check_same_points(theirs, np.asarray(put(cube, surface='CAGE', subdivision='MODIFIER').positions), 1e-4)


def test_creases_can_be_left_out(put, fresh):
    cube = make_cube()
    crease(cube, {0: 1.0, 3: 1.0})
    subdivide(cube, 2, use_creases=False)
    theirs = evaluated_points(cube)[:, :3]
    ours = np.asarray(put(cube, surface='CAGE', subdivision='MODIFIER').positions)
    check_same_points(theirs, ours, 1e-4)
    np.testing.assert_array_equal(np.asarray(put(cube, surface='CAGE', levels=2, use_creases=False).positions), ours)
    assert farthest(np.asarray(put(cube, surface='CAGE', levels=2).positions), ours) > 0.05


@pytest.mark.parametrize("boundary", ['ALL', 'PRESERVE_CORNERS'])
def test_boundaries_as_blender_smooths_them(put, fresh, boundary):
    grid = scenes.make_grid("Sheet", 3)
    grid.data.vertices[5].co.z = 0.7
    subdivide(grid, 2, boundary_smooth=boundary)
    theirs = evaluated_points(grid)[:, :3]
    ours = np.asarray(put(grid, surface='CAGE', subdivision='MODIFIER').positions)
    check_same_points(theirs, ours, 1e-4)


@pytest.mark.parametrize("rule", ['NONE', 'PRESERVE_CORNERS', 'PRESERVE_CORNERS_AND_JUNCTIONS',
                                  'PRESERVE_CORNERS_JUNCTIONS_AND_CONCAVE', 'PRESERVE_BOUNDARIES', 'SMOOTH_ALL'])
def test_uvs_as_blender_smooths_them(put, fresh, rule):
    """A sheet with three islands that meet in one vertex, whose UVs are bent so that smoothing shows."""
    sheet = scenes.make_grid("Sheet", 4)
    places = np.array([sheet.data.vertices[loop.vertex_index].co[:2] for loop in sheet.data.loops])
    center = np.repeat([np.mean(places[face.loop_indices], axis=0) for face in sheet.data.polygons], 4, axis=0)
    uvs = places + 0.15 * np.sin(5.0 * places[:, ::-1] + 1.0) + np.where(center[:, :1] > 1.0, 3.0, 0.0)
    uvs[(center > 1.0).all(axis=1)] += 3.0
    sheet.data.uv_layers[0].data.foreach_set("uv", uvs.astype(np.float32).ravel())
    modifier = subdivide(sheet, 2, uv_smooth='NONE')
    plain = evaluated_points(sheet)
    modifier.uv_smooth = rule
    theirs = evaluated_points(sheet)
    assert rule == 'NONE' or farthest(theirs, plain) > 0.01
    check_same_points(theirs, shell_points(put(sheet, surface='CAGE', subdivision='MODIFIER')), 1e-4)


def test_an_n_gon_is_subdivided_whole(put, fresh):
    ring = np.linspace(0.0, 2 * np.pi, 8)[:-1]
    places = np.stack([np.cos(ring), np.sin(ring), 0.3 * np.cos(2 * ring)], axis=1)
    plate = scenes.make_object("Heptagon", places, [range(7)], places[:, :2])
    subdivide(plate, 2)
    theirs = evaluated_points(plate)[:, :3]
    shell = put(plate, surface='CAGE', subdivision='MODIFIER')
    assert shell.prism_count == 2 * 7 * 4
    check_same_points(theirs, np.asarray(shell.positions), 1e-4)


def test_the_cage_of_a_stack_is_what_lies_below_the_subdivision(put, fresh):
    """Array, subdivision, a switched-off modifier: two copies of the cage, subdivided once."""
    grid = scenes.make_grid("Sheet", 2)
    array = grid.modifiers.new("Array", 'ARRAY')
    array.count, array.use_relative_offset, array.use_constant_offset = 2, False, True
    array.constant_offset_displace = (0.0, 0.0, 3.0)
    subdivide(grid, 3)
    grid.modifiers.new("Off", 'DISPLACE').show_viewport = False
    shell = put(grid, surface='CAGE', levels=0)
    assert shell.prism_count == 2 * 2 * 4
    assert sorted(set(np.asarray(shell.positions)[:, 2].round(5))) == [0.0, 3.0]
    assert put(grid, surface='EVALUATED').prism_count == 2 * 2 * 4 * 4 ** 3
    assert [modifier.show_viewport for modifier in grid.modifiers] == [True, True, False]


def test_levels_of_several_modifiers_add_up(put, fresh):
    grid = scenes.make_grid("Sheet", 2)
    subdivide(grid, 1)
    second = subdivide(grid, 1)
    second.show_viewport = False
    assert put(grid, surface='CAGE', subdivision='MODIFIER').prism_count == 2 * 4 * 4 ** 2
    fresh.render.use_simplify, fresh.render.simplify_subdivision = True, 1
    try:
        assert put(grid, surface='CAGE', subdivision='MODIFIER').prism_count == 2 * 4 * 4
    finally:
        fresh.render.use_simplify = False


def test_a_cage_in_edit_mode_is_what_is_edited(put, shells, fresh):
    cube = make_cube()
    subdivide(cube, 1)
    put(cube, surface='CAGE', levels=1)
    bpy.context.view_layer.objects.active = cube
    bpy.ops.object.mode_set(mode='EDIT')
    try:
        edited = bmesh.from_edit_mesh(cube.data)
        edited.verts.ensure_lookup_table()
        edited.verts[0].co *= 4.0
        bmesh.update_edit_mesh(cube.data)
        bpy.context.view_layer.update()
        instance, = shells.visible(bpy.context.evaluated_depsgraph_get())
        moved = np.asarray(instance.shell.positions)
    finally:
        bpy.ops.object.mode_set(mode='OBJECT')
    theirs = evaluated_points(cube)[:, :3]
    check_same_points(theirs, moved, 1e-4)


def test_without_a_modifier_to_follow_there_is_a_sentence(fresh, map_file):
    grid = scenes.make_grid("Sheet", 2)
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match='"Sheet" has no Subdivision Surface modifier'):
        bpy.ops.mesoshell.add_shell(object="Sheet", filepath=str(map_file), subdivision='MODIFIER')


def test_level_0_keeps_blenders_normals(put, fresh):
    """Directors are the normals that Blender shades the mesh with, custom ones averaged around a vertex."""
    cube = make_cube()
    directors = np.asarray(put(cube).directors)
    ours = {tuple(np.sign(place)): director for place, director in zip(np.asarray(put(cube).positions), directors)}
    for vertex in cube.data.vertices:
        np.testing.assert_allclose(ours[tuple(np.sign(vertex.co))], vertex.normal, atol=1e-5)
    up = np.array([0.6, 0.0, 0.8])
    if hasattr(cube.data, "use_auto_smooth"):
        cube.data.use_auto_smooth = True
    cube.data.normals_split_custom_set([up] * len(cube.data.loops))
    cube.data.update()
    np.testing.assert_allclose(np.asarray(put(cube).directors), np.tile(up, (8, 1)), atol=2e-3)
