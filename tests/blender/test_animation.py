"""Shells of animated surfaces, in the background: they follow frame by frame, by updates, and nothing leaks."""

import bpy
import numpy as np
import pytest
import scenes


@pytest.fixture
def shells(part):
    part("host.shells").forget()
    return part("host.shells")


@pytest.fixture
def counted(native, monkeypatch):
    """How often the native module built and updated a shell, as a dict that goes on counting."""
    calls = {"build_shell": 0, "update_shell": 0}

    def counting(name):
        function = getattr(native, name)

        def call(*arguments, **keywords):
            calls[name] += 1
            return function(*arguments, **keywords)
        return call
    for name in calls:
        monkeypatch.setattr(native, name, counting(name))
    return calls


def at(frame, shells):
    bpy.context.scene.frame_set(frame)
    return shells.visible(bpy.context.evaluated_depsgraph_get())[0].shell


def add(obj, path, **settings):
    scenes.add_shell(obj, path, **{"thickness": 0.1} | settings)


def rigged_torus(frames, subdivision=True):
    torus = scenes.make_torus("Rigged", around=12, across=6)
    rig = scenes.make_bone("Rig", torus)
    if subdivision:
        torus.modifiers.new("Subdivision", 'SUBSURF').levels = 1
    scenes.animate_bone(rig, frames)
    return torus, rig


def tables(shell):
    return np.array(shell.prisms)[:, :6, :3], np.array(shell.prisms)[:, :6, 3]


@pytest.mark.parametrize("settings", [dict(surface='EVALUATED'), dict(surface='CAGE', subdivision='MODIFIER'),
                                      dict(surface='CAGE', levels=2, offset="centered"),
                                      dict(surface='CAGE', levels=1, smooth_directors=3, repair=True)],
                         ids=["evaluated", "as the modifier", "centered cage", "repaired cage"])
def test_a_bones_rigid_motion_moves_the_prisms_rigidly(shells, fresh, counted, map_file, settings):
    torus, rig = rigged_torus(5)
    fresh.frame_set(1)
    add(torus, map_file, **settings)
    rest, uvs = tables(at(1, shells))
    counted.update(build_shell=0, update_shell=0)
    for frame in (2, 3, 4, 5, 3):
        moved, moved_uvs = tables(at(frame, shells))
        motion = scenes.bone_motion(rig)
        assert np.abs(motion - np.eye(4)).max() > 0.1
        np.testing.assert_allclose(moved, rest @ motion[:3, :3].T + motion[:3, 3], atol=2e-5)
        np.testing.assert_array_equal(moved_uvs, uvs)
    assert counted == {"build_shell": 0, "update_shell": 5}


def test_a_shape_key_moves_the_cage(shells, fresh, counted, map_file):
    """The cage has shape keys below the subdivision; twice as large, so is the limit."""
    torus = scenes.make_torus("Growing", around=12, across=6)
    torus.shape_key_add(name="Basis")
    key = torus.shape_key_add(name="Large")
    for point in key.data:
        point.co *= 2.0
    for frame, value in ((1, 0.0), (3, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    torus.modifiers.new("Subdivision", 'SUBSURF')
    fresh.frame_set(1)
    add(torus, map_file, surface='CAGE', levels=2)
    small = np.array(at(1, shells).positions)
    np.testing.assert_allclose(np.array(at(3, shells).positions), 2.0 * small, atol=1e-5)
    assert counted == {"build_shell": 1, "update_shell": 1}


def test_what_stands_still_is_left_alone(shells, fresh, counted, map_file):
    torus = scenes.make_torus("Still", around=12, across=6)
    add(torus, map_file, levels=1)
    first = at(1, shells)
    assert at(2, shells) is first and at(7, shells) is first
    assert counted == {"build_shell": 1, "update_shell": 0}


def test_an_object_that_turns_keeps_its_shell(shells, fresh, counted, map_file):
    """Lengths in the scene are those of its scale alone, to which a rotation adds rounding."""
    grid = scenes.make_grid("Sheet", 2)
    grid.scale = (1.5, 2.5, 0.75)
    for frame, angle in ((1, 0.0), (40, 3.0)):
        grid.rotation_euler = (angle, 0.7 * angle, 0.4 * angle)
        grid.keyframe_insert("rotation_euler", frame=frame)
    add(grid, map_file, placement='METER', refine='LENGTH', edge_length=0.3, scheme="bilinear")
    for frame in range(1, 40, 3):
        at(frame, shells)
    assert counted["build_shell"] == 1
    grid.animation_data_clear()
    grid.scale = (3.0, 5.0, 1.5)
    bpy.context.view_layer.update()
    shells.visible(bpy.context.evaluated_depsgraph_get())
    assert counted["build_shell"] == 2


def test_what_changes_besides_positions_builds_anew(shells, fresh, counted, map_file):
    """UVs, the part and the topology of a mesh that is edited; moved vertices alone do not."""
    grid = scenes.make_grid("Sheet", 4)
    group = grid.vertex_groups.new(name="Part")
    group.add(range(len(grid.data.vertices)), 1.0, 'REPLACE')
    add(grid, map_file, part='VERTEX_GROUP', part_name="Part")

    def change(what):
        what()
        grid.data.update()
        grid.update_tag()
        bpy.context.view_layer.update()
        before = dict(counted)
        shells.visible(bpy.context.evaluated_depsgraph_get())
        return tuple(counted[name] - before[name] for name in ("build_shell", "update_shell"))

    vertices, uvs = grid.data.vertices, grid.data.uv_layers[0].data
    assert change(lambda: setattr(vertices[3].co, "z", 0.25)) == (0, 1)
    assert change(lambda: setattr(uvs[3], "uv", (0.3, 0.9))) == (1, 0)
    assert change(lambda: group.add([0], 0.1, 'REPLACE')) == (1, 0)
    assert change(lambda: setattr(vertices[3].co, "z", 0.5)) == (0, 1)
    assert change(lambda: None) == (0, 0)


def test_tiles_neither_breathe_nor_depend_on_the_frame(shells, fresh, map_file):
    """Tiles per meter and a fitted thickness are those of the mesh at rest, at whichever frame a shell is built."""
    grid = scenes.make_grid("Sheet", 2)
    grid.shape_key_add(name="Basis")
    key = grid.shape_key_add(name="Large")
    for point in key.data:
        point.co *= 3.0
    for frame, value in ((1, 0.0), (3, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    seen = []
    for frames in ((1, 3), (3, 1)):
        fresh.frame_set(frames[0])
        add(grid, map_file, placement='METER', fit_thickness=True, tiles_u=2.0, tiles_v=2.0)
        for frame in frames:
            shell = at(frame, shells)
            seen.append((np.ptp(np.array(shell.uvs), axis=0).tolist(), float(np.max(shell.thickness))))
    np.testing.assert_allclose([uvs for uvs, _ in seen], [[4.0, 4.0]] * 4, rtol=1e-5)
    np.testing.assert_allclose([thickness for _, thickness in seen], scenes.HEIGHT / 2.0, rtol=1e-5)


def test_a_thousand_frames_leak_nothing(shells, fresh, counted, map_file):
    """A shell of 576 prisms, 74 kB as a table: what leaks one a frame takes 74 MB."""
    torus, rig = rigged_torus(1000)
    fresh.frame_set(1)
    add(torus, map_file, surface='CAGE', levels=1)
    for frame in range(1, 101):  # until allocators have what they need
        at(frame, shells)
    before = scenes.resident()
    for frame in range(101, 1101):
        at(frame, shells)
    grown = scenes.resident() - before
    print(f"1,000 frames: {grown / 1e6:.1f} MB more")
    assert counted["update_shell"] > 900
    assert grown < 15e6
