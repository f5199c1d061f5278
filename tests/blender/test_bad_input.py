"""Whatever is wrong comes back as one sentence that names the thing; nothing is left behind, and Blender lives on."""

import bpy
import numpy as np
import pytest
import scenes

TINY = dict(resolution=(4, 4, 2), directions=(2, 4), sdf_resolution=(4, 4, 3), terms=2)


def bake_error(tile, path):
    """The sentence that a failed bake reports."""
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.mesoshell.bake(tile=tile if isinstance(tile, str) else tile.name, filepath=str(path), **TINY)
    return sentence(caught)


def shell_error(obj, path, **settings):
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.mesoshell.add_shell(object=obj if isinstance(obj, str) else obj.name, filepath=str(path), **settings)
    return sentence(caught)


def sentence(caught):
    text = str(caught.value).strip()
    assert text.startswith("Error: ")
    text = text[len("Error: "):]
    assert "\n" not in text and "Traceback" not in text
    assert len(text.split()) > 5, "a sentence, not a word"
    return text


def update():
    bpy.context.view_layer.update()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_tile_with_bad_vertices(chain_scene, tmp_path, value):
    positions = np.empty(len(chain_scene.tile.data.vertices) * 3, np.float32)
    chain_scene.tile.data.vertices.foreach_get("co", positions)
    positions[3 * 7 + 1] = value
    chain_scene.tile.data.vertices.foreach_set("co", positions)
    chain_scene.tile.data.update()
    update()
    text = bake_error(chain_scene.tile, tmp_path / "x.gdm.exr")
    assert chain_scene.tile.name in text and "vertex 7" in text
    assert not list(tmp_path.iterdir())


def test_tile_without_faces(fresh, tmp_path):
    tile = scenes.make_object("Dust", [[0, 0, 0], [1, 0, 0]], [])
    tile.mesoshell_tile.is_tile = True
    update()
    text = bake_error(tile, tmp_path / "x.gdm.exr")
    assert "Dust" in text and "faces" in text
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name, label", [("height", "height"), ("period_u", "period U"), ("period_v", "period V")])
def test_tile_without_size(chain_scene, tmp_path, name, label):
    setattr(chain_scene.tile.mesoshell_tile, name, 0.0)
    text = bake_error(chain_scene.tile, tmp_path / "x.gdm.exr")
    assert chain_scene.tile.name in text and label in text
    assert not list(tmp_path.iterdir())


def test_tile_scaled_to_nothing(chain_scene, tmp_path):
    chain_scene.tile.scale.z = 0.0
    update()
    assert chain_scene.tile.name in bake_error(chain_scene.tile, tmp_path / "x.gdm.exr")


def test_open_tile(native, fresh, tmp_path):
    """One quad encloses nothing; the native module says so, and the report says of which object."""
    tile = scenes.make_plane("Sheet", 0.5)
    tile.mesoshell_tile.is_tile = True
    tile.data.transform(__import__("mathutils").Matrix.Translation((0.2, 0.2, 0.2)))
    update()
    with pytest.raises((ValueError, native.Error)) as caught:
        native.Sample(np.array([[.2, .2, .2], [.7, .2, .2], [.7, .7, .2], [.2, .7, .2]], np.float32),
                      np.array([[0, 1, 2], [0, 2, 3]], np.int32), height=0.5)
    text = bake_error(tile, tmp_path / "x.gdm.exr")
    assert "Sheet" in text and str(caught.value)[-40:] in text
    assert not list(tmp_path.iterdir())


def test_object_that_is_no_tile(chain_scene, tmp_path):
    text = bake_error(chain_scene.torus, tmp_path / "x.gdm.exr")
    assert chain_scene.torus.name in text and "tile" in text


def test_object_that_is_not_there(fresh, tmp_path):
    assert '"Nobody"' in bake_error("Nobody", tmp_path / "x.gdm.exr")
    assert '"Nobody"' in shell_error("Nobody", tmp_path / "x.gdm.exr")


def empty_box(name="Box", scale=(1.0, 1.0, 1.0), location=(0.5, 0.5, 0.5)):
    box = bpy.data.objects.new(name, None)
    box.empty_display_type, box.empty_display_size = 'CUBE', 0.5
    box.location, box.scale = location, scale
    bpy.context.scene.collection.objects.link(box)
    update()
    return box


def test_several_objects_without_a_box(chain_scene, tmp_path):
    chain_scene.scene.mesoshell.source = 'SELECTION'
    for obj in (chain_scene.tile, chain_scene.torus):
        obj.select_set(True)
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.mesoshell.bake(filepath=str(tmp_path / "x.gdm.exr"), **TINY)
    assert "Add Tile Box" in sentence(caught)


def test_nothing_selected(chain_scene, tmp_path):
    chain_scene.scene.mesoshell.source = 'SELECTION'
    for obj in bpy.context.view_layer.objects:
        obj.select_set(False)
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.mesoshell.bake(filepath=str(tmp_path / "x.gdm.exr"), **TINY)
    assert "select" in sentence(caught)


@pytest.mark.parametrize("content", ["nothing", "a lamp", "a hidden ball", "a wire", "an excluded ball"])
def test_collection_with_no_surface(chain_scene, tmp_path, content):
    collection = bpy.data.collections.new("Hollow")
    bpy.context.scene.collection.children.link(collection)
    if content == "a lamp":
        collection.objects.link(bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", 'POINT')))
    elif content == "a wire":
        wire = scenes.make_object("Wire", [[0, 0, 0], [1, 0, 0]], [])
        collection.objects.link(wire)
    elif content != "nothing":
        collection.objects.link(chain_scene.tile)
        bpy.context.scene.collection.objects.unlink(chain_scene.tile)
        chain_scene.tile.hide_set(content == "a hidden ball")
        if content == "an excluded ball":
            bpy.context.view_layer.layer_collection.children["Hollow"].exclude = True
    box = empty_box()
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.mesoshell.bake(collection="Hollow", box=box.name, filepath=str(tmp_path / "x.gdm.exr"), **TINY)
    assert "Hollow" in sentence(caught)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_box_without_size(chain_scene, tmp_path, axis):
    box = empty_box(scale=[0.0 if k == axis else 1.0 for k in range(3)])
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.mesoshell.bake(tile=chain_scene.torus.name, box=box.name, filepath=str(tmp_path / "x.gdm.exr"), **TINY)
    text = sentence(caught)
    assert '"Box"' in text and "XYZ"[axis] in text
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("axis, where", [(0, "beside"), (1, "beside"), (2, "below")])
def test_box_far_from_the_geometry(chain_scene, tmp_path, axis, where):
    box = empty_box(location=[50.0 if k == axis else 0.0 for k in range(3)])
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.mesoshell.bake(tile=chain_scene.torus.name, box=box.name, filepath=str(tmp_path / "x.gdm.exr"), **TINY)
    text = sentence(caught)
    assert '"Box"' in text and chain_scene.torus.name in text and where in text
    assert not list(tmp_path.iterdir())


def test_box_around_nothing(fresh):
    fresh.mesoshell.tile = scenes.make_object("Void", [], [])
    update()
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.mesoshell.add_tile_box()
    assert "Void" in sentence(caught)


def test_tile_whose_modifiers_are_not_evaluated(chain_scene, tmp_path):
    chain_scene.tile.modifiers.new("Bevel", 'BEVEL')
    chain_scene.tile.hide_viewport = True
    update()
    assert chain_scene.tile.name in bake_error(chain_scene.tile, tmp_path / "x.gdm.exr")


@pytest.mark.parametrize("place", ["/proc/x.gdm.exr", "{tmp}/a_file/x.gdm.exr", "{tmp}/no_such_folder/x.gdm.exr", "{tmp}"])
def test_folder_that_can_not_be_written(chain_scene, tmp_path, place):
    (tmp_path / "a_file").write_text("not a folder")
    path = place.format(tmp=tmp_path)
    assert path.rpartition("/x.")[0] in bake_error(chain_scene.tile, path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["a_file"]


def test_relative_path_without_a_blend_file(chain_scene):
    assert not bpy.data.filepath
    assert "save" in bake_error(chain_scene.tile, "//x.gdm.exr")


def test_map_that_is_not_there(chain_scene, tmp_path):
    text = shell_error(chain_scene.torus, tmp_path / "missing.gdm.exr")
    assert chain_scene.torus.name in text and "missing.gdm.exr" in text
    assert not chain_scene.torus.mesoshell.enabled


@pytest.mark.parametrize("keep", [0, 3, 100, 0.5, 0.95, -1])
def test_truncated_map(chain_scene, map_file, tmp_path, keep):
    data = map_file.read_bytes()
    length = int(len(data) * keep) if isinstance(keep, float) else keep % len(data)
    path = tmp_path / "cut.gdm.exr"
    path.write_bytes(data[:length])
    text = shell_error(chain_scene.torus, path)
    assert chain_scene.torus.name in text and "cut.gdm.exr" in text
    assert not chain_scene.torus.mesoshell.enabled


def test_foreign_exr(chain_scene, tmp_path):
    """An ordinary picture of Blender's own making."""
    path = tmp_path / "picture.exr"
    image = bpy.data.images.new("picture", 8, 8, float_buffer=True)
    image.file_format, image.filepath_raw = 'OPEN_EXR', str(path)
    image.save()
    text = shell_error(chain_scene.torus, path)
    assert chain_scene.torus.name in text and "picture.exr" in text


def test_folder_as_a_map(chain_scene, tmp_path):
    assert str(tmp_path) in shell_error(chain_scene.torus, tmp_path)


def test_surface_without_uvs(fresh, map_file):
    bare = scenes.make_object("Bare", [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    update()
    for thickness in (0.0, 0.1):
        text = shell_error(bare, map_file, thickness=thickness)
        assert "Bare" in text and "unwrap" in text
    assert not bare.mesoshell.enabled


def test_surface_without_faces(fresh, map_file):
    wire = scenes.make_object("Wire", [[0, 0, 0], [1, 0, 0]], [])
    update()
    assert "Wire" in shell_error(wire, map_file)


def test_surface_with_bad_vertices(chain_scene, map_file):
    chain_scene.torus.data.vertices[0].co.x = np.nan
    chain_scene.torus.data.update()
    update()
    text = shell_error(chain_scene.torus, map_file)
    assert chain_scene.torus.name in text and "vertex 0" in text


def test_surface_whose_uvs_cover_nothing(fresh, map_file):
    flat = scenes.make_plane("Flat", uv_scale=0.0)
    update()
    assert "Flat" in shell_error(flat, map_file)


def test_surface_that_is_no_mesh(fresh, map_file):
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", 'POINT'))
    bpy.context.scene.collection.objects.link(lamp)
    assert "Lamp" in shell_error(lamp, map_file)


def test_loop_scheme_takes_quads_as_triangles(chain_scene, map_file, part):
    assert bpy.ops.mesoshell.add_shell(object=chain_scene.torus.name, filepath=str(map_file), levels=1,
                                       scheme="loop") == {'FINISHED'}
    instance = part("host.shells").visible(bpy.context.evaluated_depsgraph_get())[0]
    assert instance.shell.prism_count == len(chain_scene.torus.data.polygons) * 2 * 4


def test_nothing_was_left_running(part):
    assert not part("host.bake_state").running()
