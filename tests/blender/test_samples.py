"""Laws of the committed scene, blend_samples/chain_torus.blend, asked of the file and not of the numbers behind it."""

from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Vector
from mathutils.bvhtree import BVHTree

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"
NAMES = ["ChainTile", "Torus", "Cube", "Sun", "Camera"]
SHIFTS = [(i, j) for i in range(-2, 3) for j in range(-2, 3)]  # whole periods within which rings could meet


def mesh_arrays(mesh):
    """positions float64 [n, 3] and faces int32 [m, corners] of a mesh whose faces all have the same number of corners."""
    positions = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", positions)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    assert {len(face.vertices) for face in mesh.polygons} == {len(corners) // len(mesh.polygons)}
    return positions.reshape(-1, 3).astype(float), corners.reshape(len(mesh.polygons), -1)


def uv_array(mesh):
    """UVs by face corner, float64 [faces, 4, 2]."""
    uvs = np.empty(len(mesh.loops) * 2, np.float32)
    mesh.uv_layers[0].data.foreach_get("uv", uvs)
    return uvs.reshape(len(mesh.polygons), -1, 2).astype(float)


def append_sample(path):
    """The scene in the file, appended: the session's own data stays as it was, whatever other tests hold of it."""
    with bpy.data.libraries.load(str(path)) as (available, wanted):
        assert set(NAMES) <= set(available.objects)
        wanted.scenes, wanted.objects = available.scenes[:1], list(NAMES)
    return SimpleNamespace(path=path, scene=wanted.scenes[0], **dict(zip(map(str.lower, NAMES), wanted.objects)))


def remove_sample(sample):
    for name in NAMES:
        bpy.data.objects.remove(getattr(sample, name.lower()))
    bpy.data.scenes.remove(sample.scene)


@pytest.fixture(scope="module")
def committed():
    sample = append_sample(SAMPLES / "chain_torus.blend")
    yield sample
    remove_sample(sample)


@pytest.fixture(scope="module")
def regenerated(made_samples):
    sample = append_sample(made_samples / "chain_torus.blend")
    yield sample
    remove_sample(sample)


@pytest.fixture(scope="module")
def tile(committed):
    """The tile's arrays: positions, triangles, and of each ring its own positions and triangles; period and height."""
    obj = committed.chaintile
    positions, triangles = mesh_arrays(obj.data)
    label = np.arange(len(positions))
    while True:  # every vertex takes the least label among its triangles, until nothing changes
        least = label.copy()
        for corner in range(3):
            np.minimum.at(least, triangles[:, corner], label[triangles].min(axis=1))
        if (least == label).all():
            break
        label = least
    rings = []
    for name in np.unique(label):
        own = np.flatnonzero(label == name)
        rings.append((positions[own], np.searchsorted(own, triangles[label[triangles[:, 0]] == name])))
    return SimpleNamespace(positions=positions, triangles=triangles, rings=rings,
                           period=np.array(obj["mesoshell_period"]), height=obj["mesoshell_height"])


def assert_closed_manifold(faces):
    """Every edge lies in exactly two faces, which run along it in opposite directions."""
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    assert len(np.unique(edges, axis=0)) == len(edges), "an edge is run along twice in one direction"
    assert set(map(tuple, edges)) == set(map(tuple, edges[:, ::-1])), "an edge lies in one face only"


def signed_volume(positions, triangles):
    a, b, c = (positions[triangles[:, corner]] for corner in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def bvh(positions, faces):
    return BVHTree.FromPolygons(positions.tolist(), faces.tolist())


def center_line(positions, samples=128):
    """A closed curve inside a ring, [samples, 3]: means of its vertices, weighted by nearness in angle around its axis."""
    centered = positions - positions.mean(axis=0)
    axes = np.linalg.svd(centered, full_matrices=False)[2]  # the last, in which a ring is thinnest, is its axis
    angle = np.arctan2(centered @ axes[1], centered @ axes[0])
    around = np.arange(samples) * (2 * np.pi / samples)
    weight = np.exp(100.0 * (np.cos(around[:, None] - angle) - 1.0))  # about 0.1 radians wide
    return weight @ positions / weight.sum(axis=1, keepdims=True)


def linking_number(first, second):
    """Gauss's integral over two closed curves, each sampled [n, 3]; a float near a whole number."""
    along_first = (np.roll(first, -1, axis=0) - np.roll(first, 1, axis=0)) / 2
    along_second = (np.roll(second, -1, axis=0) - np.roll(second, 1, axis=0)) / 2
    between = first[:, None] - second[None]
    volume = np.einsum("ijk,ijk->ij", between, np.cross(along_first[:, None], along_second[None]))
    return (volume / np.linalg.norm(between, axis=-1) ** 3).sum() / (4 * np.pi)


def pairs_within_reach(tile):
    """(a ring of the tile, another, the other's shift [3]) for all pairs of the endless sheet whose boxes overlap."""
    for a, (first, _) in enumerate(tile.rings):
        for b, (second, _) in enumerate(tile.rings):
            for cell in SHIFTS:
                shift = np.array([*(tile.period * cell), 0.0])
                apart = (first.min(0) > second.max(0) + shift) | (second.min(0) + shift > first.max(0))
                if not apart.any() and not (a == b and cell == (0, 0)):
                    yield a, b, shift


# --- the tile


def test_tile_is_a_closed_manifold_of_about_ten_thousand_triangles(tile):
    assert 5_000 <= len(tile.triangles) <= 15_000
    assert_closed_manifold(tile.triangles)
    assert len(np.unique(tile.triangles)) == len(tile.positions), "a vertex without a triangle"


def test_tile_rings_are_tori_that_face_outward(tile):
    assert len(tile.rings) == 4
    for positions, triangles in tile.rings:
        assert signed_volume(positions, triangles) > 0
        assert len(positions) - len(triangles) * 3 // 2 + len(triangles) == 0  # Euler: one handle


def test_tile_lies_within_its_height(tile):
    bottom, top = tile.positions[:, 2].min(), tile.positions[:, 2].max()
    assert 0 < bottom and top < tile.height
    assert bottom + top == pytest.approx(tile.height, abs=1e-5), "not in the middle"
    assert 0.3 <= tile.height / tile.period[0] <= 0.6


def test_tile_holds_each_ring_once(tile):
    centers = np.array([positions.mean(axis=0)[:2] for positions, _ in tile.rings]) / tile.period
    assert (centers > -1e-6).all() and (centers < 1 - 1e-6).all()
    between = centers[:, None] - centers[None]
    between -= np.round(between)
    assert (np.linalg.norm(between, axis=-1) + np.eye(len(centers)) > 0.1).all(), "a ring and its own periodic copy"


@pytest.mark.parametrize("axis", [0, 1])
def test_rings_cross_both_borders(tile, axis):
    ranges = [(positions[:, axis].min(), positions[:, axis].max()) for positions, _ in tile.rings]
    for border in (0.0, tile.period[axis]):
        assert any(low < border < high for low, high in ranges)


def test_every_ring_is_linked_with_four_others_and_no_more(tile):
    lines = [center_line(positions) for positions, _ in tile.rings]
    for line, (positions, triangles) in zip(lines, tile.rings):
        wire = bvh(positions, triangles)
        for point in map(Vector, line):  # the curve stands for the ring only if it stays within its wire
            nearest, normal, _, _ = wire.find_nearest(point)
            assert (point - nearest).dot(normal) < 0
    links = np.zeros(len(tile.rings), int)
    for a, b, shift in pairs_within_reach(tile):
        linking = linking_number(lines[a], lines[b] + shift)
        assert abs(linking - round(linking)) < 0.01
        assert abs(round(linking)) <= 1
        links[a] += abs(round(linking))
    assert (links == 4).all()


def test_no_two_rings_of_the_endless_sheet_touch(tile):
    trees = [bvh(*ring) for ring in tile.rings]
    gap = np.inf
    for a, b, shift in pairs_within_reach(tile):
        positions, triangles = tile.rings[b]
        assert not trees[a].overlap(bvh(positions + shift, triangles))
        gap = min(gap, min(trees[a].find_nearest(point)[3] for point in (positions + shift).tolist()))
    assert gap > 0.5 / 64, "less than half a voxel of a 64-voxel tile between two wires"


@pytest.mark.parametrize("which", ["committed", "regenerated"])
def test_tile_settings_reach_the_property_group(which, request):
    """With the add-on, its own group is read; without, a stand-in of the same name and fields, registered meanwhile."""
    obj = request.getfixturevalue(which).chaintile
    assert tuple(obj["mesoshell_period"]) == (1.0, 1.0)
    assert obj["mesoshell_height"] == 0.5

    if hasattr(bpy.types.Object, "mesoshell_tile"):
        stand_in = None
    else:
        numbers = {name: bpy.props.FloatProperty(default=-1.0) for name in ("period_u", "period_v", "height")}
        stand_in = type("MESOSHELL_TEST_tile", (bpy.types.PropertyGroup,),
                        {"__annotations__": {**numbers, "is_tile": bpy.props.BoolProperty()}})
        bpy.utils.register_class(stand_in)
        bpy.types.Object.mesoshell_tile = bpy.props.PointerProperty(type=stand_in)
    try:
        group = obj.mesoshell_tile
        assert (group.period_u, group.period_v, group.height, group.is_tile) == (1.0, 1.0, 0.5, True)
    finally:
        if stand_in:
            del bpy.types.Object.mesoshell_tile
            bpy.utils.unregister_class(stand_in)


# --- the torus


def test_torus_is_closed_and_faces_outward(committed):
    positions, quads = mesh_arrays(committed.torus.data)
    assert quads.shape == (960, 4)
    assert_closed_manifold(quads)
    assert signed_volume(positions, quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)) > 0
    assert len(positions) - len(quads) * 2 + len(quads) == 0  # Euler: one handle


def test_torus_tangents_are_right_handed(committed):
    """On every face, tangent_u x tangent_v points outward, as the face's normal does."""
    positions, quads = mesh_arrays(committed.torus.data)
    corners, uvs = positions[quads], uv_array(committed.torus.data)
    for a, b, c in ((0, 1, 2), (0, 2, 3)):
        edges = np.stack([corners[:, b] - corners[:, a], corners[:, c] - corners[:, a]], axis=1)
        uv_edges = np.stack([uvs[:, b] - uvs[:, a], uvs[:, c] - uvs[:, a]], axis=1)
        tangents = np.linalg.solve(uv_edges, edges)  # rows: d position / du, d position / dv
        outward = np.cross(tangents[:, 0], tangents[:, 1])
        assert (np.einsum("ij,ij->i", outward, np.cross(edges[:, 0], edges[:, 1])) > 0).all()


def test_torus_uvs_run_from_zero_to_one_and_break_only_at_the_seams(committed):
    _, quads = mesh_arrays(committed.torus.data)
    uvs = uv_array(committed.torus.data)
    assert uvs.min() == 0.0 and uvs.max() == 1.0
    np.testing.assert_allclose(np.ptp(uvs, axis=1), np.broadcast_to([1 / 48, 1 / 20], (960, 2)), atol=1e-6)

    ends = {}  # (from vertex, to vertex): UVs there
    for quad, uv in zip(quads.tolist(), uvs):
        for k in range(4):
            ends[quad[k], quad[(k + 1) % 4]] = uv[[k, (k + 1) % 4]]
    jumps = [np.abs(uv - ends[b, a][::-1]).round(6) for (a, b), uv in ends.items()]
    assert all((jump[0] == jump[1]).all() and tuple(jump[0]) in {(0, 0), (1, 0), (0, 1)} for jump in jumps)
    assert sum(jump.any() for jump in jumps) == 2 * (20 + 48)  # both sides of one seam each way


def test_torus_suggests_whole_tiles_and_a_thickness_that_keeps_proportions(committed, tile):
    tiles, thickness = list(committed.torus["mesoshell_tiles"]), committed.torus["mesoshell_thickness"]
    assert all(isinstance(count, int) and count > 0 for count in tiles)
    radius = 0.42 + thickness / 2  # of the tube, halfway up the shell
    width, depth = 2 * np.pi / tiles[0], 2 * np.pi * radius / tiles[1]
    assert depth / width == pytest.approx(tile.period[1] / tile.period[0], rel=0.05)
    assert thickness / width == pytest.approx(tile.height / tile.period[0], rel=0.05)


# --- the scene


def camera_coordinates(sample, points):
    """Points [n, 3] on the camera's picture, [n, 2]: -1 and 1 are its borders."""
    camera = sample.camera
    camera_from_world = np.array(camera.matrix_basis.inverted())
    seen = points @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]
    return seen[:, :2] / -seen[:, 2:] / np.tan(camera.data.angle / 2)


def shell_top(sample):
    """The torus's vertices moved outward by the thickness, and its faces."""
    positions, quads = mesh_arrays(sample.torus.data)
    normals = np.array([vertex.normal for vertex in sample.torus.data.vertices])
    return positions + normals * sample.torus["mesoshell_thickness"], quads


def cube_in_world(sample):
    positions, faces = mesh_arrays(sample.cube.data)
    world_from_object = np.array(sample.cube.matrix_basis)
    return positions @ world_from_object[:3, :3].T + world_from_object[:3, 3], faces


def test_camera_sees_the_whole_shell_and_not_the_tile(committed, tile):
    assert committed.scene.camera == committed.camera
    shell = camera_coordinates(committed, shell_top(committed)[0])
    assert np.abs(shell).max() < 1.0
    assert np.ptp(shell[:, 0]) > 2 * 0.85, "the picture is not filled"
    assert np.abs(camera_coordinates(committed, cube_in_world(committed)[0])).max() < 1.0

    beside = camera_coordinates(committed, tile.positions + np.array(committed.chaintile.location))
    assert (beside[:, 0] > 1.0).all()
    assert committed.chaintile.hide_render


def test_cube_hides_mail_and_is_hidden_by_it(committed):
    positions, quads = mesh_arrays(committed.torus.data)
    base, top, cube = bvh(positions, quads), bvh(*shell_top(committed)), bvh(*cube_in_world(committed))
    eye = committed.camera.matrix_basis.translation
    target = committed.cube.matrix_basis.translation
    half = np.tan(committed.camera.data.angle / 2)

    def distance(tree, direction):
        hit = tree.ray_cast(eye, direction)[3]
        return np.inf if hit is None else hit

    before = within = 0
    center = camera_coordinates(committed, np.array([target]))[0]
    for x in np.linspace(-0.3, 0.3, 49) + center[0]:
        for y in np.linspace(-0.3, 0.3, 49) + center[1]:
            direction = (committed.camera.matrix_basis.to_3x3() @ Vector((x * half, y * half, -1.0))).normalized()
            at_cube, at_top, at_base = (distance(tree, direction) for tree in (cube, top, base))
            before += at_cube < at_top < np.inf  # the cube stands before mail
            within += at_top < at_cube < at_base  # the ray passes through mail on its way to the cube
    assert before > 100 and within > 30


def test_cube_is_half_inside(committed):
    corners, faces = cube_in_world(committed)
    assert_closed_manifold(faces)
    tube = np.hypot(np.hypot(corners[:, 0], corners[:, 1]) - 1.0, corners[:, 2])  # from the center circle
    outside = tube > 0.42 + committed.torus["mesoshell_thickness"]
    assert 2 <= outside.sum() <= 6


def test_scene_is_ready_to_render(committed):
    render = committed.scene.render
    assert (render.resolution_x, render.resolution_y, render.resolution_percentage) == (512, 512, 100)
    assert committed.scene.view_settings.view_transform == "Standard"
    assert committed.sun.data.type == "SUN"
    color = next(node for node in committed.scene.world.node_tree.nodes if node.type == "BACKGROUND").inputs["Color"]
    assert max(color.default_value[:3]) < 0.1
    assert all(obj.matrix_basis.is_negative is False for obj in (committed.chaintile, committed.torus, committed.cube))


# --- the file and its script


def test_file_is_small_and_asks_for_no_other(committed):
    assert committed.path.stat().st_size < 1_000_000
    assert not [image for image in bpy.data.images if image.library]


def test_script_makes_the_committed_geometry(committed, regenerated):
    for name in ("chaintile", "torus", "cube"):
        old, new = getattr(committed, name), getattr(regenerated, name)
        for old_array, new_array in zip(mesh_arrays(old.data), mesh_arrays(new.data)):
            np.testing.assert_allclose(new_array, old_array, rtol=0, atol=1e-6)
        np.testing.assert_allclose(new.matrix_basis, old.matrix_basis, rtol=0, atol=1e-6)
    np.testing.assert_array_equal(uv_array(regenerated.torus.data), uv_array(committed.torus.data))
    for key in ("mesoshell_tiles", "mesoshell_thickness"):
        assert np.array_equal(regenerated.torus[key], committed.torus[key])


@pytest.mark.parametrize("detail", [8, 13, 160])
def test_links_are_closed_at_any_detail(detail, monkeypatch):
    monkeypatch.syspath_prepend(str(SAMPLES))
    from tiles import chain

    positions, triangles = chain.chain_links(detail)
    assert_closed_manifold(triangles)
    assert signed_volume(positions, triangles) > 0


def test_links_refuse_too_little_detail(monkeypatch):
    monkeypatch.syspath_prepend(str(SAMPLES))
    from tiles import chain

    with pytest.raises(ValueError, match="at least 8 segments"):
        chain.chain_links(2)
