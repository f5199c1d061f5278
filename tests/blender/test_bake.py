"""Laws of mesoshell.bake: what it saves is the tile, whatever the object's units and place."""

import itertools

import bpy
import numpy as np
import pytest
import scenes

# The sphere's facets lie up to 3e-4 below it; a ray that clears by 0.03 meets them at 0.43 of their normal or more.
CLEARANCE, TOLERANCE = 0.03, 2e-3


def nodes():
    nx, ny, nz = scenes.SMALL_BAKE["resolution"]
    ntheta, nphi = scenes.SMALL_BAKE["directions"]
    return nx, ny, nz, ntheta, nphi


def position(i, j, k):
    """Node (i, j, k), which may be a fraction: in texture space, and in metric texture space."""
    nx, ny, nz = nodes()[:3]
    texture = np.array([i / nx, j / ny, k / (nz - 1)])
    return texture, texture * [1.0, scenes.ASPECT, scenes.HEIGHT]


def direction(a, b):
    ntheta, nphi = nodes()[3:]
    theta, phi = np.pi * a / (ntheta - 1), 2 * np.pi * b / nphi
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def lookup(native, path, samples):
    """The stored map's distance for each (i, j, k, a, b)."""
    points = np.array([position(*s[:3])[0] for s in samples], np.float32)
    directions = np.array([direction(*s[3:]) for s in samples], np.float32)
    return np.asarray(native.load(str(path)).lookup(points, directions))


def random_nodes(rng, count):
    """Nodes of the grid above the bottom and below the top, where a ray has a way to go."""
    nx, ny, nz, ntheta, nphi = nodes()
    low, high = [0, 0, 1, 0, 0], [nx, ny, nz - 1, ntheta, nphi]
    return rng.integers(low, high, (count, 5))


def test_nodes_hold_the_closed_form_distance(native, map_file, rng):
    samples = random_nodes(rng, 400)
    found = lookup(native, map_file, samples)
    truth = [scenes.lattice_distance(position(*s[:3])[1], direction(*s[3:])) for s in samples]
    checked = [(f, t) for f, (t, clearance) in zip(found, truth) if clearance > CLEARANCE]
    assert len(checked) > 200
    assert any(t == 0.0 for _, t in checked) and any(t > 1.0 for _, t in checked)
    np.testing.assert_allclose(*np.transpose(checked), atol=TOLERANCE)


def test_between_nodes_it_lies_between_the_nodes(native, map_file, rng):
    """Interpolation leaves no value outside those of the 32 nodes around a sample."""
    samples = random_nodes(rng, 300) + rng.random((300, 5))
    samples[:, 2] = np.minimum(samples[:, 2], nodes()[2] - 1.001)
    samples[:, 3] = np.minimum(samples[:, 3], nodes()[3] - 1.001)
    checked = 0
    for sample, found in zip(samples, lookup(native, map_file, samples)):
        base = np.floor(sample)
        around = [base + corner for corner in itertools.product((0, 1), repeat=5)]
        truth = [scenes.lattice_distance(position(*s[:3])[1], direction(*s[3:])) for s in around]
        if min(clearance for _, clearance in truth) > 0.01:
            checked += 1
            distances = [distance for distance, _ in truth]
            assert min(distances) - 2 * TOLERANCE <= found <= max(distances) + 2 * TOLERANCE
    assert checked > 20


def test_sdf_is_the_distance_to_the_nearest_sphere(native, map_file, rng):
    points = rng.random((500, 3))
    metric = points * [1.0, scenes.ASPECT, scenes.HEIGHT]
    away = np.abs(metric - scenes.CENTER)
    away[:, :2] = np.minimum(away[:, :2], [1.0, scenes.ASPECT] - away[:, :2])
    truth = np.linalg.norm(away, axis=1) - scenes.RADIUS
    found = np.asarray(native.load(str(map_file)).sample_sdf(points.astype(np.float32)))
    # Trilinear between nodes 1/32 apart: half a cell near the ridges halfway between spheres, far less elsewhere.
    np.testing.assert_allclose(found, truth, atol=0.5 / 32)
    near = np.abs(truth) < 0.05
    assert near.sum() > 20
    np.testing.assert_allclose(found[near], truth[near], atol=4e-3)


def test_map_knows_the_tiles_shape(native, map_file):
    stored = native.load(str(map_file))
    assert stored.height == pytest.approx(scenes.HEIGHT, rel=1e-6)
    assert stored.aspect == pytest.approx(scenes.ASPECT, rel=1e-6)
    assert tuple(stored.resolution) == scenes.SMALL_BAKE["resolution"]
    assert tuple(stored.directions) == scenes.SMALL_BAKE["directions"]
    assert stored.terms == 64
    assert stored.rmse < 1e-4, "all terms leave nothing out"


def read(part, tile):
    source = part("host.chosen_source")
    return source.read(source.choose(bpy.context, source='OBJECT', tile=tile), bpy.context.evaluated_depsgraph_get())


def test_even_scale_and_place_do_not_matter(part, chain_scene):
    before = read(part, chain_scene.tile)
    chain_scene.tile.scale, chain_scene.tile.location = (5.0, 5.0, 5.0), (100.0, 0.0, 0.0)
    bpy.context.view_layer.update()
    after = read(part, chain_scene.tile)
    np.testing.assert_allclose(after.positions, before.positions, atol=1e-6)
    assert after.height == pytest.approx(before.height) == pytest.approx(scenes.HEIGHT)


def test_uneven_scale_is_the_shape_that_is_seen(part, chain_scene):
    chain_scene.tile.scale = (1.0, 2.0, 3.0)
    bpy.context.view_layer.update()
    tile = read(part, chain_scene.tile)
    assert tile.aspect == pytest.approx(2 * scenes.ASPECT)
    assert tile.height == pytest.approx(3 * scenes.HEIGHT)
    expected = (scenes.CENTER + [0.0, 0.0, scenes.RADIUS]) * [1.0, 2.0, 3.0]
    np.testing.assert_allclose(tile.positions[np.argmax(tile.positions[:, 2])], expected, atol=1e-5)


def test_modifiers_are_baked(part, chain_scene):
    before = read(part, chain_scene.tile)
    modifier = chain_scene.tile.modifiers.new("Second sphere", 'ARRAY')
    modifier.use_relative_offset, modifier.use_constant_offset = False, True
    modifier.constant_offset_displace = (0.25 * scenes.WIDTH, 0.0, 0.0)
    bpy.context.view_layer.update()
    after = read(part, chain_scene.tile)
    assert len(after.triangles) == 2 * len(before.triangles)
    assert np.ptp(after.positions[:, 0]) == pytest.approx(np.ptp(before.positions[:, 0]) + 0.25, abs=1e-5)


def test_edit_mode_is_baked_as_it_is_seen(part, chain_scene):
    import bmesh
    bpy.context.view_layer.objects.active = chain_scene.tile
    bpy.ops.object.mode_set(mode='EDIT')
    try:
        edited = bmesh.from_edit_mesh(chain_scene.tile.data)
        for vertex in edited.verts:
            vertex.co.z += 0.25 * scenes.WIDTH
        bmesh.update_edit_mesh(chain_scene.tile.data)
        tile = read(part, chain_scene.tile)
    finally:
        bpy.ops.object.mode_set(mode='OBJECT')
    assert tile.positions[:, 2].mean() == pytest.approx(scenes.CENTER[2] + 0.25, abs=1e-3)


def test_what_is_not_given_comes_from_the_scene(native, chain_scene, tmp_path):
    settings = chain_scene.scene.mesoshell
    settings.tile, settings.output_path = chain_scene.tile, str(tmp_path / "from_scene.gdm.exr")
    settings.resolution, settings.directions, settings.terms = (8, 9, 4), (4, 6), 3
    settings.sdf_resolution = (10, 11, 12)
    assert bpy.ops.mesoshell.bake(directions=(6, 4)) == {'FINISHED'}
    stored = native.load(settings.output_path)
    assert tuple(stored.resolution) == (8, 9, 4)
    assert tuple(stored.directions) == (6, 4)
    assert stored.terms == 3
    assert np.asarray(stored.sdf).shape == (12, 11, 10)
    # What one call gave is not what the next one gets.
    assert bpy.ops.mesoshell.bake() == {'FINISHED'}
    assert tuple(native.load(settings.output_path).directions) == (4, 6)


def test_baking_again_replaces_the_file(native, chain_scene, tmp_path):
    path = tmp_path / "again.gdm.exr"
    for terms in (2, 3):
        bpy.ops.mesoshell.bake(tile=chain_scene.tile.name, filepath=str(path), resolution=(8, 8, 4),
                               directions=(4, 4), sdf_resolution=(8, 8, 5), terms=terms)
        assert native.load(str(path)).terms == terms
    assert [entry.name for entry in tmp_path.iterdir()] == ["again.gdm.exr"]
