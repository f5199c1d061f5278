"""The offer to unwrap: UVs for any mesh, in any mode, with mode and selection left as they were."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes


def bare(name="Bare"):
    """A cube without UVs, of which two faces are selected and one is hidden."""
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    obj = scenes.make_object(name, corners, faces)
    obj.data.polygons.foreach_set("select", [True, True, False, False, False, False])
    obj.data.polygons.foreach_set("hide", [False, False, False, False, False, True])
    bpy.context.view_layer.update()
    return obj


def uvs_of(part, obj):
    layer = part("host.meshes").render_layer(obj.data)
    return part("host.versions").uv_array(layer, len(obj.data.loops)).reshape(-1, 4, 2)


def area(uvs):
    return 0.5 * np.abs(np.sum(uvs[..., 0] * np.roll(uvs[..., 1], -1, axis=-1)
                               - uvs[..., 1] * np.roll(uvs[..., 0], -1, axis=-1), axis=-1))


@pytest.mark.parametrize("method", ['SMART', 'ANGLE', 'CONFORMAL', 'CUBE'])
def test_every_face_gets_an_area(part, fresh, method):
    cube = bare()
    if method in {'ANGLE', 'CONFORMAL'}:
        cube.data.edges.foreach_set("use_seam", np.ones(12, bool))
    assert bpy.ops.mesoshell.unwrap(object=cube.name, method=method) == {'FINISHED'}
    areas = area(uvs_of(part, cube))
    np.testing.assert_allclose(areas, areas[0], rtol=1e-3)
    assert areas[0] > 0.01


def test_mode_and_selection_stay(part, fresh):
    cube, other = bare(), scenes.make_plane("Other")
    view_layer = bpy.context.view_layer
    for obj in view_layer.objects:
        obj.select_set(obj == other)
    view_layer.objects.active = other
    before = scenes.everything(), [scene.name for scene in bpy.data.scenes], len(bpy.data.meshes)
    assert bpy.ops.mesoshell.unwrap(object=cube.name) == {'FINISHED'}
    assert (scenes.everything(), [scene.name for scene in bpy.data.scenes], len(bpy.data.meshes)) == before
    assert bpy.context.mode == 'OBJECT' and view_layer.objects.active == other
    assert [obj for obj in view_layer.objects if obj.select_get()] == [other]
    assert [face.select for face in cube.data.polygons] == [True, True, False, False, False, False]
    assert [face.hide for face in cube.data.polygons] == [False] * 5 + [True]


@pytest.mark.parametrize("edited", ["itself", "another"])
def test_in_edit_mode(part, fresh, edited):
    cube, other = bare(), scenes.make_plane("Other")
    bpy.context.view_layer.objects.active = active = cube if edited == "itself" else other
    bpy.ops.object.mode_set(mode='EDIT')

    def chosen():
        return [(face.select, face.hide) for face in bmesh.from_edit_mesh(active.data).faces]

    try:
        before = chosen()
        assert bpy.ops.mesoshell.unwrap(object=cube.name) == {'FINISHED'}
        assert bpy.context.mode == 'EDIT_MESH' and bpy.context.view_layer.objects.active == active
        assert chosen() == before
    finally:
        bpy.ops.object.mode_set(mode='OBJECT')
    assert area(uvs_of(part, cube)).min() > 0.01


def test_a_shell_without_uvs_asks_for_them_and_gets_them(part, fresh, map_file):
    shells = part("host.shells")
    cube = bare()
    cube.mesoshell.map_path, cube.mesoshell.enabled = str(map_file), True

    def visible():
        bpy.context.view_layer.update()
        return shells.visible(bpy.context.evaluated_depsgraph_get())

    assert visible() == [] and shells.needs_unwrap(cube) and "Bare" in shells.problem(cube)
    assert bpy.ops.mesoshell.unwrap(object=cube.name) == {'FINISHED'}
    assert visible()[0].shell.prism_count == 12 and not shells.needs_unwrap(cube)


def test_uvs_that_are_there_are_replaced_in_their_layer(part, fresh):
    plane = scenes.make_plane("Flat", uv_scale=0.0)
    bpy.context.view_layer.update()
    assert bpy.ops.mesoshell.unwrap(object="Flat") == {'FINISHED'}
    assert len(plane.data.uv_layers) == 1 and area(uvs_of(part, plane))[0] > 0.1


@pytest.mark.parametrize("make, words", [
    (lambda: scenes.make_object("Wire", [[0, 0, 0], [1, 0, 0]], []), '"Wire" has no faces'),
    (lambda: bpy.data.objects.new("Void", None), '"Void"'),
])
def test_what_has_no_faces_is_a_sentence(fresh, make, words):
    obj = make()
    if obj.name not in fresh.objects:
        fresh.collection.objects.link(obj)
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.mesoshell.unwrap(object=obj.name)


@pytest.mark.window
def test_undo_takes_the_uvs_back(fresh):
    name = bare().name
    bpy.ops.ed.undo_push(message="cube")
    bpy.ops.mesoshell.unwrap(object=name)
    bpy.ops.ed.undo_push(message="unwrapped")
    assert len(bpy.data.objects[name].data.uv_layers) == 1
    bpy.ops.ed.undo()
    assert len(bpy.data.objects[name].data.uv_layers) == 0
