"""Laws of add_shell and of the registry of what is to be drawn."""

import json
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
import scenes
import session


@pytest.fixture
def shells(part):
    part("host.shells").forget()
    return part("host.shells")


def add(obj, path, **settings):
    bpy.context.view_layer.update()
    assert bpy.ops.mesoshell.add_shell(object=obj.name, filepath=str(path), **settings) == {'FINISHED'}


def visible(shells, space=None):
    return {instance.object_name: instance
            for instance in shells.visible(bpy.context.evaluated_depsgraph_get(), space)}


def test_a_shell_is_what_was_asked_for(shells, chain_scene, map_file):
    torus = chain_scene.torus
    torus.location = (1.0, 2.0, 3.0)
    torus.scale = (1.0, 1.0, 2.0)
    add(torus, map_file, thickness=0.25, tiles_u=6.0, tiles_v=3.0, traversal="gdm")
    torus.mesoshell.base_color = (0.25, 0.5, 0.75)
    instance = visible(shells)[torus.name]
    np.testing.assert_allclose(instance.world_from_object, np.array(torus.matrix_world))
    assert instance.settings == ("gdm", (0.25, 0.5, 0.75, 1.0), "exact")
    assert instance.map.height == pytest.approx(scenes.HEIGHT, rel=1e-6)
    prisms = np.asarray(instance.shell.prisms)
    assert len(prisms) == instance.shell.prism_count == 2 * len(torus.data.polygons)
    sides = np.linalg.norm(prisms[:, 3:6, :3] - prisms[:, 0:3, :3], axis=-1)
    np.testing.assert_allclose(sides, 0.25, rtol=1e-4)  # object units, whatever the object's scale
    uvs = prisms[:, :3, 3]
    assert uvs.min() == pytest.approx(0.0, abs=1e-5) and uvs.max() == pytest.approx(6.0, rel=1e-5)


def test_default_thickness_keeps_the_tiles_proportions(shells, fresh, map_file):
    """A tile 0.5 wide on a flat plane is as thick as the tile is high, in tile widths; an object's scale takes no part."""
    plane = scenes.make_plane("Plate", size=2.0, uv_scale=4.0)
    plane.scale = (7.0, 7.0, 7.0)
    add(plane, map_file)
    assert plane.mesoshell.thickness == pytest.approx(0.5 * scenes.HEIGHT, rel=1e-5)
    add(plane, map_file, tiles_u=2.0)
    assert plane.mesoshell.thickness == pytest.approx(0.25 * scenes.HEIGHT, rel=1e-5)


def test_default_thickness_is_weighted_by_area(shells, chain_scene, map_file):
    """On a torus a unit of u is 2 pi r long at radius r; the area-weighted mean over the tube is 2 pi (R + r^2 / 2R)."""
    add(chain_scene.torus, map_file)
    expected = 2 * np.pi * (1.0 + 0.4 ** 2 / 2) * scenes.HEIGHT
    assert chain_scene.torus.mesoshell.thickness == pytest.approx(expected, rel=0.02)


def test_nothing_is_built_twice(shells, chain_scene, map_file):
    add(chain_scene.torus, map_file, thickness=0.1)
    first, second = visible(shells)[chain_scene.torus.name], visible(shells)[chain_scene.torus.name]
    assert first.shell is second.shell and first.map is second.map
    assert (first.shell_version, first.map_version) == (second.shell_version, second.map_version)
    chain_scene.torus.location.x += 1.0
    bpy.context.view_layer.update()
    moved = visible(shells)[chain_scene.torus.name]
    assert moved.shell is first.shell, "moving an object builds nothing"
    assert moved.world_from_object[0, 3] == pytest.approx(first.world_from_object[0, 3] + 1.0)


def test_two_shells_share_a_map(shells, chain_scene, map_file):
    plane = scenes.make_plane("Plate")
    add(plane, map_file, thickness=0.1)
    add(chain_scene.torus, map_file, thickness=0.1)
    both = visible(shells)
    assert both["Plate"].map is both[chain_scene.torus.name].map
    assert both["Plate"].shell_version != both[chain_scene.torus.name].shell_version


@pytest.mark.parametrize("name, value, factor", [("thickness", 0.3, 1), ("levels", 1, 4), ("tiles_v", 3.0, 1),
                                                 ("scheme", "bilinear", 1)])
def test_a_setting_rebuilds_the_shell(shells, chain_scene, map_file, name, value, factor):
    add(chain_scene.torus, map_file, thickness=0.1)
    before = visible(shells)[chain_scene.torus.name]
    setattr(chain_scene.torus.mesoshell, name, value)
    after = visible(shells)[chain_scene.torus.name]
    assert after.shell_version != before.shell_version
    assert after.map_version == before.map_version
    assert after.shell.prism_count == factor * before.shell.prism_count


def test_appearance_rebuilds_nothing(shells, chain_scene, map_file):
    add(chain_scene.torus, map_file, thickness=0.1)
    before = visible(shells)[chain_scene.torus.name]
    chain_scene.torus.mesoshell.base_color = (1.0, 0.0, 0.0)
    chain_scene.torus.mesoshell.traversal = "gdm"
    after = visible(shells)[chain_scene.torus.name]
    assert after.shell is before.shell and after.settings.traversal == "gdm"


def test_an_edited_mesh_rebuilds_its_shell_only(shells, chain_scene, map_file):
    plane = scenes.make_plane("Plate")
    add(plane, map_file, thickness=0.1)
    add(chain_scene.torus, map_file, thickness=0.1)
    before = visible(shells)
    chain_scene.torus.data.vertices[0].co.z += 5.0
    chain_scene.torus.data.update()
    bpy.context.view_layer.update()
    after = visible(shells)
    assert after[chain_scene.torus.name].shell_version != before[chain_scene.torus.name].shell_version
    assert np.asarray(after[chain_scene.torus.name].shell.bounds)[1, 2] > 4.0
    assert after["Plate"].shell is before["Plate"].shell


def test_a_modifier_rebuilds_the_shell(shells, chain_scene, map_file):
    add(chain_scene.torus, map_file, thickness=0.1)
    before = visible(shells)[chain_scene.torus.name]
    chain_scene.torus.modifiers.new("Subdivision", 'SUBSURF').levels = 1
    bpy.context.view_layer.update()
    assert visible(shells)[chain_scene.torus.name].shell.prism_count == 4 * before.shell.prism_count


def test_animation_moves_the_shell(shells, chain_scene, map_file):
    torus = chain_scene.torus
    torus.shape_key_add(name="Basis")
    raised = torus.shape_key_add(name="Raised")
    for point in raised.data:
        point.co.z += 5.0
    for frame, value in ((1, 0.0), (10, 1.0)):
        raised.value = value
        raised.keyframe_insert("value", frame=frame)
    add(torus, map_file, thickness=0.1)
    bounds = {}
    for frame in (1, 10, 1):
        bpy.context.scene.frame_set(frame)
        bounds[frame] = np.array(visible(shells)[torus.name].shell.bounds)
    np.testing.assert_allclose(bounds[10] - bounds[1], [[0, 0, 5], [0, 0, 5]], atol=1e-5)


def test_a_map_without_a_distance_field_is_a_sentence(shells, native, chain_scene, tmp_path):
    sys.path.append(str(Path(__file__).resolve().parents[1]))
    import mail_scenes

    path = tmp_path / "bare.gdm.exr"
    sample = mail_scenes.chain_sample(native)
    native.compress(native.bake_gdm(sample, resolution=(4, 4, 4), directions=(4, 4)), terms=2).save(path)
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="bare.gdm.exr.*no distance field"):
        bpy.ops.mesoshell.add_shell(object=chain_scene.torus.name, filepath=str(path))


def test_edit_mode_shows_what_is_edited(shells, chain_scene, map_file):
    import bmesh
    add(chain_scene.torus, map_file, thickness=0.1)
    bpy.context.view_layer.objects.active = chain_scene.torus
    bpy.ops.object.mode_set(mode='EDIT')
    try:
        edited = bmesh.from_edit_mesh(chain_scene.torus.data)
        edited.verts.ensure_lookup_table()
        edited.verts[0].co.z += 5.0
        bmesh.update_edit_mesh(chain_scene.torus.data)
        bpy.context.view_layer.update()
        assert np.asarray(visible(shells)[chain_scene.torus.name].shell.bounds)[1, 2] > 4.0
    finally:
        bpy.ops.object.mode_set(mode='OBJECT')


def test_a_new_bake_reloads_the_map(shells, chain_scene, tmp_path):
    path = tmp_path / "map.gdm.exr"
    bake = dict(tile=chain_scene.tile.name, filepath=str(path), resolution=(4, 4, 2), directions=(2, 4),
                sdf_resolution=(4, 4, 3))
    bpy.ops.mesoshell.bake(terms=1, **bake)
    add(chain_scene.torus, path, thickness=0.1)
    before = visible(shells)[chain_scene.torus.name]
    bpy.ops.mesoshell.bake(terms=2, **bake)
    after = visible(shells)[chain_scene.torus.name]
    assert (before.map.terms, after.map.terms) == (1, 2)
    assert after.map_version != before.map_version


def test_polygons_are_triangulated(shells, fresh, map_file):
    """A pentagon and a quad: the quad stays whole, the pentagon becomes three triangles that keep its UVs."""
    positions = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [3, .5, 0], [2, 1, 0]]
    faces = [[0, 1, 2, 3], [1, 4, 5, 6, 2]]
    uvs = np.array(positions)[np.concatenate(faces)][:, :2]
    obj = scenes.make_object("Mixed", positions, faces, uvs)
    bpy.context.view_layer.update()
    surface = session.part("host.meshes").read_surface(obj, bpy.context.evaluated_depsgraph_get())
    assert sorted(surface.face_sizes) == [3, 3, 3, 4]
    np.testing.assert_allclose(surface.positions[surface.corners][:, :2], surface.uvs)
    add(obj, map_file, thickness=0.1)
    assert visible(shells)["Mixed"].shell.prism_count == 5
    obj.mesoshell.levels = 1
    assert visible(shells)["Mixed"].shell.prism_count == 2 * (4 + 5), "subdivision takes polygons whole"


def test_uvs_are_those_active_for_render(part, fresh):
    plane = scenes.make_plane("Plate")
    other = plane.data.uv_layers.new(name="Other")
    other.data.foreach_set("uv", np.full(8, 0.5, np.float32))
    read = part("host.meshes").read_surface
    bpy.context.view_layer.update()
    assert np.ptp(read(plane, bpy.context.evaluated_depsgraph_get()).uvs) == 1.0
    plane.data.uv_layers["Other"].active_render = True
    plane.data.update()
    bpy.context.view_layer.update()
    assert np.ptp(read(plane, bpy.context.evaluated_depsgraph_get()).uvs) == 0.0


def test_hidden_objects_are_left_out(shells, chain_scene, map_file):
    torus = chain_scene.torus
    add(torus, map_file, thickness=0.1)
    assert torus.name in visible(shells)
    torus.hide_set(True)
    assert torus.name not in visible(shells)
    torus.hide_set(False)
    torus.hide_viewport = True
    bpy.context.view_layer.update()
    assert torus.name not in visible(shells)
    torus.hide_viewport = False
    torus.mesoshell.enabled = False
    bpy.context.view_layer.update()
    assert torus.name not in visible(shells)


@pytest.mark.window
def test_local_view_shows_its_own(shells, chain_scene, map_file):
    plane = scenes.make_plane("Plate")
    add(plane, map_file, thickness=0.1)
    add(chain_scene.torus, map_file, thickness=0.1)
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == 'VIEW_3D')
    region = next(region for region in area.regions if region.type == 'WINDOW')
    space = area.spaces.active
    for obj in bpy.context.scene.objects:
        obj.select_set(obj == plane)
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.view3d.localview(frame_selected=False)
        try:
            assert set(visible(shells, space)) == {"Plate"}
        finally:
            bpy.ops.view3d.localview(frame_selected=False)
    assert set(visible(shells, space)) == {"Plate", chain_scene.torus.name}


def test_a_lost_map_is_a_sentence_and_comes_back(shells, chain_scene, map_file, tmp_path):
    path = tmp_path / "moving.gdm.exr"
    path.write_bytes(map_file.read_bytes())
    add(chain_scene.torus, path, thickness=0.1)
    assert shells.problem(chain_scene.torus) is None
    assert shells.prism_count(chain_scene.torus) == 2 * len(chain_scene.torus.data.polygons)
    path.unlink()
    assert visible(shells) == {}
    assert "moving.gdm.exr" in shells.problem(chain_scene.torus)
    path.write_bytes(map_file.read_bytes()[:1000])
    assert visible(shells) == {}
    assert shells.problem(chain_scene.torus)
    path.write_bytes(map_file.read_bytes())
    assert chain_scene.torus.name in visible(shells)
    assert shells.problem(chain_scene.torus) is None


def test_a_bad_object_leaves_the_others(shells, chain_scene, map_file):
    plane = scenes.make_plane("Plate")
    add(plane, map_file, thickness=0.1)
    add(chain_scene.torus, map_file, thickness=0.1)
    while plane.data.uv_layers:
        plane.data.uv_layers.remove(plane.data.uv_layers[0])
    plane.data.update()
    bpy.context.view_layer.update()
    assert set(visible(shells)) == {chain_scene.torus.name}
    assert "Plate" in shells.problem(plane) and "UVs" in shells.problem(plane)
    plane.mesoshell.thickness = 0.0
    visible(shells)
    assert "thickness" in shells.problem(plane)


def test_another_object_of_the_same_name_is_another_shell(shells, chain_scene, map_file):
    add(chain_scene.torus, map_file, thickness=0.1)
    before = visible(shells)["MailTorus"]
    bpy.data.objects.remove(chain_scene.torus)
    plane = scenes.make_plane("MailTorus")
    add(plane, map_file, thickness=0.1)
    assert visible(shells)["MailTorus"].shell.prism_count == 2 != before.shell.prism_count


def test_remove_shell(shells, chain_scene, map_file):
    add(chain_scene.torus, map_file, thickness=0.1, levels=2)
    assert bpy.ops.mesoshell.remove_shell(object=chain_scene.torus.name) == {'FINISHED'}
    assert visible(shells) == {}
    assert chain_scene.torus.mesoshell.levels == 0 and not chain_scene.torus.mesoshell.map_path
    with pytest.raises(RuntimeError, match=chain_scene.torus.name):
        bpy.ops.mesoshell.remove_shell(object=chain_scene.torus.name)


def test_add_shell_takes_the_active_object(shells, chain_scene, map_file):
    bpy.context.view_layer.objects.active = chain_scene.torus
    assert bpy.ops.mesoshell.add_shell(filepath=str(map_file)) == {'FINISHED'}
    assert set(visible(shells)) == {chain_scene.torus.name}


@pytest.mark.window
def test_undo_and_redo(shells, chain_scene, map_file):
    name = chain_scene.torus.name
    bpy.ops.ed.undo_push(message="before the shell")
    add(chain_scene.torus, map_file, thickness=0.125)
    bpy.ops.ed.undo_push(message="shell")
    assert name in visible(shells)
    bpy.ops.ed.undo()
    assert not bpy.data.objects[name].mesoshell.enabled
    assert visible(shells) == {}
    bpy.ops.ed.redo()
    assert bpy.data.objects[name].mesoshell.thickness == 0.125
    assert name in visible(shells)


@pytest.mark.window
def test_undo_of_an_edit_rebuilds(shells, chain_scene, map_file):
    name = chain_scene.torus.name
    add(chain_scene.torus, map_file, thickness=0.1)
    bpy.ops.ed.undo_push(message="shell")
    chain_scene.torus.data.vertices[0].co.z += 5.0
    chain_scene.torus.data.update()
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="edit")
    assert np.asarray(visible(shells)[name].shell.bounds)[1, 2] > 4.0
    bpy.ops.ed.undo()
    assert np.asarray(visible(shells)[name].shell.bounds)[1, 2] < 1.0


def test_a_saved_file_keeps_it_all(map_file, tmp_path):
    """In a Blender of its own: settings survive saving and loading, relative paths start at the file, caches are dropped."""
    found_path = tmp_path / "found.json"
    run = subprocess.run(
        [*session.blender_arguments(), "--background", "--python-exit-code", "1",
         "--python", str(session.ROOT / "tests" / "blender" / "children" / "reload.py"), "--",
         str(map_file), str(tmp_path), str(found_path)],
        env=session.blender_environment(), capture_output=True, text=True, errors="replace", timeout=180)
    assert run.returncode == 0, run.stdout[-3000:] + run.stderr[-3000:]
    found = json.loads(found_path.read_text())
    assert found["tile"] == pytest.approx([1, scenes.WIDTH, scenes.WIDTH * scenes.ASPECT, scenes.WIDTH * scenes.HEIGHT])
    assert found["shell"] == [True, "//mail.gdm.exr", 0.125, 2, "bilinear", 6.0, 3.0, "gdm", [0.25, 0.5, 0.75]]
    assert found["options"] == [] and found["others"] == [[0.25, 0.5], "Thick", True]
    assert found["bake"] == ["SphereTile", [8, 9, 10], [4, 6], [12, 13, 14], 5, "float", "//mail.gdm.exr"]
    assert found["after_new_file"] == []
    assert found["after_load"] == ["MailTorus"]
    assert found["problem"] is None
    assert found["prisms_before"] == found["prisms_after"] == 2 * 4 ** 2 * 32 * 16
