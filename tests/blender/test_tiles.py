"""Laws of the committed scene blend_samples/tiles.blend: each object evaluates to its tile, its colors and settings with it."""

import subprocess
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils.bvhtree import BVHTree
from mathutils.kdtree import KDTree

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"
NAMES = ["weave", "grid", "chain", "squama", "bark", "fur"]


@pytest.fixture(scope="module")
def tiles():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(SAMPLES))
        import tiles

        assert list(tiles.NAMES) == NAMES
        yield {name: tiles.make(name) for name in NAMES}


def append_tiles(path):
    """The six objects of the file, in the session's own scene, and the scene that they come from."""
    before = {name: set(getattr(bpy.data, name)) for name in ("objects", "meshes", "collections", "scenes", "node_groups")}
    with bpy.data.libraries.load(str(path)) as (available, wanted):
        wanted.scenes, wanted.objects = available.scenes[:1], [name.title() for name in NAMES]
    for obj in wanted.objects:
        bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    return SimpleNamespace(path=path, scene=wanted.scenes[0], before=before, **dict(zip(NAMES, wanted.objects)))


def remove_tiles(sample):
    bpy.data.batch_remove([item for name, known in sample.before.items() for item in getattr(bpy.data, name)
                           if item not in known])


@pytest.fixture(scope="module")
def committed():
    sample = append_tiles(SAMPLES / "tiles.blend")
    yield sample
    remove_tiles(sample)


@pytest.fixture(scope="module")
def regenerated(made_samples):
    sample = append_tiles(made_samples / "tiles.blend")
    yield sample
    remove_tiles(sample)


def shown(obj):
    """What the object evaluates to, mesh by mesh: positions [n, 3] in its own space, triangles [m, 3], colors [n, 3]."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    object_from_world = np.array(obj.matrix_world.inverted())
    meshes = []
    for instance in depsgraph.object_instances:
        if (instance.parent if instance.is_instance else instance.object).original != obj:
            continue
        mesh = instance.object.to_mesh()
        matrix = object_from_world @ np.array(instance.matrix_world)
        positions = np.empty(len(mesh.vertices) * 3, np.float32)
        mesh.vertices.foreach_get("co", positions)
        mesh.calc_loop_triangles()
        triangles = np.empty(len(mesh.loop_triangles) * 3, np.int32)
        mesh.loop_triangles.foreach_get("vertices", triangles)
        attribute = mesh.attributes["Color"]
        assert (attribute.domain, attribute.data_type) == ('POINT', 'FLOAT_COLOR')
        colors = np.empty(len(mesh.vertices) * 4, np.float32)
        attribute.data.foreach_get("color", colors)
        meshes.append((positions.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3], triangles.reshape(-1, 3),
                       colors.reshape(-1, 4)[:, :3]))
        instance.object.to_mesh_clear()
    return meshes


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("which", ["committed", "regenerated"])
def test_object_evaluates_to_its_tile(which, name, tiles, request):
    """To the copies' roundings: the same triangles at the same places in the same colors, each once."""
    tile = tiles[name]
    meshes = shown(getattr(request.getfixturevalue(which), name))
    positions, colors = (np.concatenate([mesh[part] for mesh in meshes]) for part in (0, 2))
    assert len(positions) == len(tile.positions)
    tree = KDTree(len(tile.positions))
    for index, position in enumerate(tile.positions):
        tree.insert(position, index)
    tree.balance()
    found = np.array([tree.find(position)[1:] for position in positions])
    own, distance = found[:, 0].astype(int), found[:, 1]
    assert distance.max() < 3e-6
    assert len(np.unique(own)) == len(own)
    np.testing.assert_allclose(colors, tile.colors[own], atol=2e-3)

    first = np.cumsum([0] + [len(mesh[0]) for mesh in meshes])
    triangles = own[np.concatenate([mesh[1] + start for mesh, start in zip(meshes, first)])]
    starts = triangles.argmin(axis=1)
    turned = [np.stack([np.take_along_axis(part, ((at + k) % 3)[:, None], 1)[:, 0] for k in range(3)], 1)
              for part, at in ((triangles, starts), (tile.triangles, tile.triangles.argmin(axis=1)))]
    np.testing.assert_array_equal(*(part[np.lexsort(part.T)] for part in turned))


@pytest.mark.parametrize("name", ["weave", "grid", "chain", "bark"])
def test_plain_meshes_hold_the_very_bits(name, committed, tiles):
    (positions, _, _), = shown(getattr(committed, name))
    mesh = getattr(committed, name).data
    stored = np.empty(len(positions) * 3, np.float32)
    mesh.vertices.foreach_get("co", stored)
    np.testing.assert_array_equal(stored.reshape(-1, 3), tiles[name].positions)


def test_scales_are_instances_and_hairs_one_mesh(committed):
    assert len(shown(committed.squama)) == 1 + 16
    assert len(shown(committed.fur)) == 1
    for obj in (committed.squama, committed.fur):
        assert [modifier.type for modifier in obj.modifiers] == ['NODES']
        assert len(obj.data.polygons) < 1500, "all but the skin comes from the modifier"


def test_scales_do_not_touch_each_other(committed):
    """Nor those of the next tiles."""
    _, *scales = shown(committed.squama)
    period = np.array([1.0, 0.75, 0.0])
    trees = [BVHTree.FromPolygons(positions.tolist(), triangles.tolist()) for positions, triangles, _ in scales]
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            for a, (positions, triangles, _) in enumerate(scales):
                moved = BVHTree.FromPolygons((positions + period * (i, j, 0)).tolist(), triangles.tolist())
                for b, tree in enumerate(trees):
                    assert (a == b and (i, j) == (0, 0)) or not tree.overlap(moved)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("which", ["committed", "regenerated"])
def test_settings_and_material(which, name, tiles, request):
    obj, tile = getattr(request.getfixturevalue(which), name), tiles[name]
    assert tuple(obj["mesoshell_period"]) == (1.0, tile.aspect)
    assert obj["mesoshell_height"] == tile.height
    if hasattr(bpy.types.Object, "mesoshell_tile"):
        group = obj.mesoshell_tile
        np.testing.assert_allclose([group.period_u, group.period_v, group.height], [1.0, tile.aspect, tile.height], rtol=1e-6)
        assert group.is_tile
    nodes = obj.data.materials[0].node_tree.nodes
    shader = next(node for node in nodes if node.type == 'BSDF_PRINCIPLED')
    assert shader.inputs["Base Color"].links[0].from_node.attribute_name == "Color"
    assert shader.inputs["Roughness"].default_value == pytest.approx(tile.roughness)
    assert shader.inputs["Metallic"].default_value == tile.metallic


def test_camera_sees_every_tile_apart(committed, tiles):
    camera = committed.scene.camera
    render = committed.scene.render
    assert render.resolution_x > render.resolution_y
    camera_from_world = np.array(camera.matrix_basis.inverted())
    slope = np.tan(camera.data.angle / 2) * np.array([1.0, render.resolution_y / render.resolution_x])
    boxes = []
    for name in NAMES:
        seen = (tiles[name].positions + np.array(getattr(committed, name).location)) @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]
        seen = seen[:, :2] / -seen[:, 2:] / slope
        assert np.abs(seen).max() < 1.0
        boxes.append((seen.min(axis=0), seen.max(axis=0)))
    for a in range(6):
        for b in range(a):
            assert (boxes[a][0] > boxes[b][1]).any() or (boxes[b][0] > boxes[a][1]).any()


def test_file_is_small_and_asks_for_no_other(committed):
    assert committed.path.stat().st_size < 1_500_000
    assert not [item for item in (*bpy.data.images, *bpy.data.libraries) if item.library]


def test_detail_makes_coarser_scenes(tmp_path):
    run = subprocess.run(
        [bpy.app.binary_path, "--background", "--factory-startup", "--python-exit-code", "1", "--python",
         str(SAMPLES / "make_samples.py"), "--", "--out", str(tmp_path), "--detail", "0.33"],
        check=True, timeout=240, stdout=subprocess.PIPE, text=True).stdout
    faces = {line.split(":")[0]: int(line.split()[1]) for line in run.splitlines() if line.endswith("faces")}
    assert faces["tiles.blend"] < 10_000 and faces["chain_torus.blend"] < 3_000
    assert (tmp_path / "tiles.blend").stat().st_size < 500_000
