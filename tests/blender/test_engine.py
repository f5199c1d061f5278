"""The render engine: stills and animations, against the native module, other renderers and closed forms."""

import shutil
from types import SimpleNamespace

import bmesh
import bpy
import numpy as np
import pytest
import rendering
import scenes
from mathutils import Matrix

SIZE = (96, 72)
SUN = 3.0  # W/m2
SKY = (0.25, 0.125, 0.5)
CUBE_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


@pytest.fixture
def stage(part, fresh, tmp_path):
    """A scene for the engine: a camera that looks down along -z at 4 x 3 units, a sky, and nothing else yet."""
    part("host.shells").forget()
    hidden = [obj for obj in fresh.objects if not obj.hide_render]
    for obj in hidden:
        obj.hide_render = True
    data = bpy.data.cameras.new("Engine camera")
    data.type, data.ortho_scale, data.clip_end = 'ORTHO', 4.0, 50.0
    camera = bpy.data.objects.new("Engine camera", data)
    camera.location.z = 10.0
    fresh.collection.objects.link(camera)
    world = bpy.data.worlds.new("Engine sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (*SKY, 1.0)
    layer = fresh.view_layers[0]
    switches = ("use_pass_z", "use_pass_normal", "use_pass_object_index")
    with rendering.set_up(fresh, SIZE) as render, rendering.kept(layer, *switches):
        for name in switches:
            setattr(layer, name, True)
        fresh.camera, fresh.world = camera, world
        yield SimpleNamespace(scene=fresh, render=render, camera=camera, file=tmp_path / "picture.exr", layer=layer,
                              index=part("host.versions").OBJECT_INDEX_PASS)
    bpy.data.worlds.remove(world)
    for obj in hidden:
        obj.hide_render = False


@pytest.fixture
def mail(stage, map_file):
    """A torus with a shell of spheres, its base left out, seen askew in perspective."""
    stage.camera.data.type = 'PERSP'
    stage.camera.matrix_world = Matrix.LocRotScale((2.4, -2.6, 2.6), None, None)
    stage.camera.rotation_euler = (0.94, 0.0, 0.745)
    stage.torus = make_mail(map_file)
    return stage


def make_mail(map_file, name="Mail", **settings):
    torus = scenes.make_torus(name, around=24, across=12)
    scenes.add_shell(torus, map_file, **(dict(thickness=0.25, tiles_u=8, tiles_v=4) | settings))
    torus.display_type, torus.pass_index = 'BOUNDS', 3
    return torus


def make_cube(name, center, half=0.5, color=None, index=0):
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    cube = scenes.make_object(name, corners * half, CUBE_FACES)
    cube.location, cube.pass_index = center, index
    if color is not None:
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1.0)
        cube.data.materials.append(material)
    return cube


def make_sun(rotation=(0.0, 0.0, 0.0), angle=0.0):
    data = bpy.data.lights.new("Engine sun", 'SUN')
    data.energy, data.angle = SUN, angle
    sun = bpy.data.objects.new("Engine sun", data)
    sun.rotation_euler = rotation
    bpy.context.scene.collection.objects.link(sun)
    return sun


def ground(size=8.0, z=-1.0, index=1):
    """A white plane below everything."""
    plane = scenes.make_object("Ground", [(x * size, y * size, z) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))],
                               [[0, 1, 2, 3]])
    plane.pass_index = index
    return plane


def frame_of(part, size=SIZE):
    """What the engine would hand to the native module, by a render of its own."""
    return rendering.in_render(lambda depsgraph: part("engine.frame").read(depsgraph, size), size)


def test_a_still_is_the_native_modules_picture(part, native, mail):
    mail.scene.mesoshell_render.samples = 4
    make_sun((0.4, 0.3, 0.0), angle=0.1)
    ground()
    make_cube("Block", (0.6, -0.6, 0.5), 0.3, (0.5, 0.1, 0.1), 7)
    picture = rendering.render(mail.file)
    expected = native.render_scene(**frame_of(part).arguments)
    np.testing.assert_array_equal(picture["Combined"], expected["color"])
    np.testing.assert_array_equal(picture["Depth"], expected["depth"])
    np.testing.assert_array_equal(picture["Normal"], expected["normal"])
    np.testing.assert_array_equal(picture[mail.index], np.maximum(expected["index"], 0))
    assert set(np.unique(picture[mail.index])) >= {1.0, 3.0, 7.0}


def test_a_shell_covers_what_the_reference_renderer_hits(part, native, mail):
    """By every traversal that an object may choose."""
    for traversal, *_ in part("host.shell_options").TRAVERSALS:
        mail.torus.mesoshell.traversal = traversal
        picture, frame = rendering.render(mail.file), frame_of(part)
        shell, = frame.arguments["shells"]
        seen = native.render(shell["shell"], shell["map"], size=SIZE, traversal=traversal,
                             clip_from_object=frame.arguments["clip_from_world"] @ shell["world_from_object"])
        hit = seen["hit"] == 1
        assert 500 < hit.sum() < hit.size - 500
        assert ((picture[mail.index] == 3) == hit).mean() >= 0.999, traversal


def test_the_sky_is_seen_or_transparent(mail):
    opaque = rendering.render(mail.file)
    mail.render.film_transparent = True
    clear = rendering.render(mail.file)
    nothing = opaque[mail.index] == 0
    assert 500 < nothing.sum() < nothing.size - 500
    np.testing.assert_allclose(opaque["Combined"][nothing], np.broadcast_to([*SKY, 1.0], (nothing.sum(), 4)), rtol=1e-6)
    np.testing.assert_array_equal(clear["Combined"][nothing], 0.0)
    np.testing.assert_array_equal(clear["Combined"][~nothing], opaque["Combined"][~nothing])
    assert (opaque["Combined"][..., 3] == 1.0).all() and (opaque["Depth"][nothing] >= 1e10).all()


def test_an_orthographic_picture_in_closed_form(stage):
    """A white ground, and on it a cube of half a unit with its shadow, which a sun at 45 degrees moves by its height."""
    ground(z=0.0)
    make_cube("Block", (0.0, 0.0, 0.5), 0.5, (0.5, 0.25, 0.125), 7)
    make_sun((0.0, np.pi / 4, 0.0))  # shines toward -x and down
    picture = rendering.render(stage.file)
    x = (np.arange(SIZE[0]) + 0.5) / SIZE[0] * 4.0 - 2.0
    y = ((np.arange(SIZE[1]) + 0.5) / SIZE[1] * 3.0 - 1.5)[:, None]
    cube = (abs(x) < 0.5) & (abs(y) < 0.5)
    shadow = (x > -1.5) & (x <= -0.5) & (abs(y) < 0.5)
    np.testing.assert_array_equal(picture[stage.index], np.where(cube, 7, 1))
    np.testing.assert_allclose(picture["Depth"], np.where(cube, 9.0, 10.0), atol=1e-5)
    np.testing.assert_allclose(picture["Normal"], np.broadcast_to([0.0, 0.0, 1.0], (*cube.shape, 3)), atol=1e-6)
    light = np.array(SKY) + np.where(shadow, 0.0, SUN / np.pi * np.sqrt(0.5))[..., None]
    albedo = np.where(cube[..., None], (0.5, 0.25, 0.125), 0.8)
    np.testing.assert_allclose(picture["Combined"][..., :3], albedo * light, rtol=1e-5)


@pytest.fixture
def cycles(stage):
    """What Cycles makes of the same scene, direct light alone."""
    settings, names = stage.scene.cycles, ("samples", "use_denoising", "use_adaptive_sampling", "max_bounces")

    def render():
        with rendering.kept(stage.render, "engine"), rendering.kept(settings, *names):
            stage.render.engine = 'CYCLES'
            settings.samples, settings.max_bounces = 64, 0
            settings.use_denoising = settings.use_adaptive_sampling = False
            return rendering.render(stage.file)
    return render


def look_askew(camera):
    camera.data.type = 'PERSP'
    camera.location, camera.rotation_euler = (4.0, -4.5, 4.0), (0.98, 0.1, 0.727)


def test_lamps_shadows_and_passes_are_as_in_cycles(stage, cycles):
    """Of surfaces that are diffuse alone; Cycles averages normals and indices within pixels, at edges."""
    look_askew(stage.camera)
    stage.scene.world = None
    ground(z=0.0, size=20.0)
    make_cube("Block", (0.0, 0.0, 0.5), 0.5, None, 7)
    make_cube("Second", (1.0, 1.0, 1.0), 0.3, None, 8).rotation_euler = (0.5, 0.3, 0.2)
    make_sun((0.3, 0.9, 0.0), 0.5)
    lamps = {'POINT': dict(shadow_soft_size=0.2), 'SPOT': dict(shadow_soft_size=0.0, spot_size=1.2, spot_blend=0.5),
             'AREA': dict(shape='RECTANGLE', size=1.5, size_y=0.3)}
    for place, (kind, settings) in enumerate(lamps.items()):
        data = bpy.data.lights.new(kind, kind)
        data.energy, data.color = 150.0, np.roll((0.2, 1.0, 0.5), place)
        for name, value in settings.items():
            setattr(data, name, value)
        lamp = bpy.data.objects.new(kind, data)
        lamp.location, lamp.rotation_euler = (-2.0, 2.0 * place - 2.0, 3.0), (0.5 - 0.5 * place, -0.5, 0.3)
        lamp.visible_camera = False
        stage.scene.collection.objects.link(lamp)
    white = bpy.data.materials.new("Diffuse white")
    white.use_nodes = True
    nodes = white.node_tree.nodes
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    white.node_tree.links.new(diffuse.outputs[0], nodes["Material Output"].inputs["Surface"])
    for obj in stage.scene.objects:
        if obj.type == 'MESH':
            obj.data.materials.append(white)
    stage.scene.mesoshell_render.samples = 64
    ours, theirs = rendering.render(stage.file), cycles()
    blocks = [picture["Combined"][..., :3].reshape(SIZE[1] // 8, 8, SIZE[0] // 8, 8, 3).mean(axis=(1, 3))
              for picture in (ours, theirs)]
    assert blocks[1].max() > 3.0 * blocks[1].min()
    np.testing.assert_allclose(*blocks, rtol=0.04)
    same = ours[stage.index] == theirs[stage.index]
    assert same.mean() > 0.9 and set(np.unique(ours[stage.index])) == {1.0, 7.0, 8.0}
    assert (abs(ours["Depth"] - theirs["Depth"]) < 0.01 * theirs["Depth"])[same].mean() > 0.99
    assert (abs(ours["Normal"] - theirs["Normal"]).max(axis=-1) < 0.01)[same].mean() > 0.9


def test_an_environment_image_is_seen_as_in_cycles(stage, cycles, rng):
    look_askew(stage.camera)
    stage.camera.rotation_euler = (1.7, 0.2, 2.5)
    stage.camera.data.lens = 12.0
    image = bpy.data.images.new("Sky", 16, 8, float_buffer=True)
    pixels = rng.uniform(0.0, 1.0, (16 * 8, 4)).astype(np.float32)
    pixels[:, 3] = 1.0
    image.pixels.foreach_set(pixels.ravel())
    tree = stage.scene.world.node_tree
    node = tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = image
    tree.links.new(node.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    stage.scene.mesoshell_render.samples = 16
    ours, theirs = (picture["Combined"][..., :3] for picture in (rendering.render(stage.file), cycles()))
    assert theirs.std() > 0.1
    np.testing.assert_allclose(ours, theirs, atol=0.02)


def test_shells_and_meshes_occlude_and_shade_each_other(stage, map_file):
    """Over a plane with a shell a cube hides a square and darkens another; the shell's own shadow lies on the ground."""
    sheet = scenes.make_plane("Sheet", size=2.0)
    sheet.location = (-1.0, -1.0, 0.0)
    scenes.add_shell(sheet, map_file, thickness=0.3, tiles_u=4, tiles_v=4)
    sheet.display_type, sheet.pass_index = 'BOUNDS', 3
    ground(z=-0.2)
    make_sun((0.0, np.pi / 4, 0.0))
    alone = rendering.render(stage.file)
    make_cube("Block", (0.5, 0.0, 1.0), 0.25, None, 7)
    both = rendering.render(stage.file)
    x = (np.arange(SIZE[0]) + 0.5) / SIZE[0] * 4.0 - 2.0
    y = ((np.arange(SIZE[1]) + 0.5) / SIZE[1] * 3.0 - 1.5)[:, None]
    cube = (abs(x - 0.5) < 0.25) & (abs(y) < 0.25)
    np.testing.assert_array_equal(both[stage.index] == 7, cube)
    shell = alone[stage.index] == 3
    np.testing.assert_array_equal((both[stage.index] == 3), shell & ~cube)
    # At a height h the cube's shadow covers x from h - 1 to h, and the shell is from 0 to 0.3.
    shaded = shell & (x > -0.68) & (x < -0.02) & (abs(y) < 0.24) & (alone["Combined"][..., 0] > 0.3)
    assert shaded.sum() > 20
    assert (both["Combined"][..., 0] < 0.6 * alone["Combined"][..., 0])[shaded].all()
    away = (abs(y) > 0.27) | (x < -1.22)
    np.testing.assert_array_equal(both["Combined"][away & ~cube], alone["Combined"][away & ~cube])
    # The ground beside the sheet is under its shadow: spheres, so that some of it is lit and some is not.
    beside = (x < -1.02) & (x > -1.2) & (abs(y) > 0.3) & (abs(y) < 0.9)
    full = 0.8 * (SKY[0] + SUN / np.pi * np.sqrt(0.5))
    light = both["Combined"][beside][:, 0] / full
    assert light.min() < 0.5 and light.max() == pytest.approx(1.0, rel=1e-4)
    sheet.visible_shadow = False
    np.testing.assert_allclose(rendering.render(stage.file)["Combined"][beside][:, 0], full, rtol=1e-4)


def test_what_is_hidden_from_renders_is_not_in_the_picture(mail, map_file):
    collection = bpy.data.collections.new("Hidden from renders")
    mail.scene.collection.children.link(collection)
    mail.scene.collection.objects.unlink(mail.torus)
    collection.objects.link(mail.torus)
    assert (rendering.render(mail.file)[mail.index] == 3).any()
    collection.hide_render = True
    assert (rendering.render(mail.file)[mail.index] == 0).all()
    collection.hide_render, mail.torus.hide_viewport = False, True
    assert (rendering.render(mail.file)[mail.index] == 3).any()
    mail.torus.hide_viewport, mail.torus.visible_camera = False, False
    assert (rendering.render(mail.file)[mail.index] == 0).all()


def test_the_base_of_a_shell_is_an_object_like_others(mail):
    """It is seen below the shell unless it is displayed as bounds or wires, as in the viewport."""
    without = rendering.render(mail.file)
    mail.torus.display_type = 'TEXTURED'
    with_base = rendering.render(mail.file)
    assert (with_base[mail.index] == 3).sum() > 1.1 * (without[mail.index] == 3).sum()
    seen = without[mail.index] == 3
    assert (with_base["Depth"][seen] <= without["Depth"][seen] + 1e-5).all()


@pytest.mark.parametrize("crop", [False, True])
def test_a_border_renders_that_part_of_the_picture(mail, crop):
    ground()
    whole = rendering.render(mail.file)
    render = mail.render
    render.use_border, render.use_crop_to_border = True, crop
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.25, 0.5
    part = rendering.render(mail.file)
    inside = (slice(18, 36), slice(24, 72))
    if not crop:
        assert part["Combined"].shape == whole["Combined"].shape
        outside = np.full(part[mail.index].shape, True)
        outside[inside] = False
        assert (part["Combined"][outside] == 0.0).all()
        part = {name: array[inside] for name, array in part.items()}
    alike = abs(part["Depth"] - whole["Depth"][inside]) <= 1e-3
    assert part["Depth"].shape == (18, 48) and alike.mean() >= 0.998, "but for a rounding at a silhouette"
    assert len(np.unique(part[mail.index])) > 1


def test_resolution_percentage_and_view_layers(mail, map_file):
    """Each view layer has the picture of its own collections."""
    other = bpy.data.collections.new("Other layer")
    mail.scene.collection.children.link(other)
    cube = make_cube("Block", (0.0, 0.0, 0.0), 0.4, None, 7)
    mail.scene.collection.objects.unlink(cube)
    other.objects.link(cube)
    second = mail.scene.view_layers.new("Second")
    try:
        second.use_pass_object_index = True
        second.layer_collection.children["Other layer"].exclude = True
        mail.render.resolution_percentage = 50
        layers = rendering.render(mail.file)
    finally:
        mail.scene.view_layers.remove(second)
    first, second = layers[mail.layer.name], layers["Second"]
    assert first[mail.index].shape == (SIZE[1] // 2, SIZE[0] // 2)
    assert set(np.unique(first[mail.index])) == {0.0, 3.0, 7.0} and set(np.unique(second[mail.index])) == {0.0, 3.0}
    assert "Depth" in first and "Depth" not in second


def test_a_lost_map_is_reported_and_the_rest_rendered(mail, map_file, tmp_path, capfd):
    lost = tmp_path / "lost.gdm.exr"
    shutil.copy(map_file, lost)
    second = make_mail(lost, "Lost mail")
    second.location.x, second.pass_index = 0.2, 4
    assert (rendering.render(mail.file)[mail.index] == 4).any()
    lost.unlink()
    capfd.readouterr()
    picture = rendering.render(mail.file)
    assert set(np.unique(picture[mail.index])) == {0.0, 3.0}
    said = capfd.readouterr().out
    assert '"Lost mail" is not rendered' in said and str(lost) in said


def test_a_scene_that_can_not_be_rendered_is_an_error_in_a_sentence(mail):
    mail.camera.data.type = 'PANO'
    with pytest.raises(RuntimeError, match='"Engine camera" is neither perspective nor orthographic'):
        bpy.ops.render.render()


def test_cancelling_leaves_no_error(part, mail, monkeypatch, capfd):
    monkeypatch.setattr(part("engine.engine").MesoshellRenderEngine, "_progress", lambda self, fraction: False)
    mail.scene.mesoshell_render.samples = 4096
    mail.render.filepath = str(mail.file)
    assert bpy.ops.render.render() == {'FINISHED'}
    said = capfd.readouterr()
    assert "Error" not in said.out + said.err and "Traceback" not in said.out + said.err


def test_an_animation_renders_each_frame_as_a_still(part, mail, tmp_path):
    """A bone turns the torus: frames differ from one another, and each is what a fresh start renders of it."""
    rig = scenes.make_bone("Rig", mail.torus)
    scenes.animate_bone(rig, 3, location=(0.2, 0.1, 0.0))
    mail.scene.frame_start, mail.scene.frame_end = 1, 3
    mail.render.filepath = str(tmp_path / "frame_####")
    assert bpy.ops.render.render(animation=True) == {'FINISHED'}
    frames = [rendering.passes_of(tmp_path / f"frame_{frame:04d}.exr", mail.scene) for frame in (1, 2, 3)]
    assert all((a["Depth"] != b["Depth"]).mean() > 0.1 for a, b in zip(frames, frames[1:]))
    for frame, moving in zip((1, 2, 3), frames):
        part("host.shells").forget()
        mail.scene.frame_set(frame)
        still = rendering.render(mail.file)
        np.testing.assert_array_equal(moving["Depth"], still["Depth"])
        np.testing.assert_array_equal(moving["Combined"], still["Combined"])


@pytest.mark.parametrize("surface", ['EVALUATED', 'CAGE'])
def test_what_is_being_edited_is_rendered(mail, surface):
    """In Edit mode as afterwards, of the mesh as it is edited; modifiers count that are shown there."""
    before = rendering.render(mail.file)
    mail.torus.mesoshell.surface, mail.torus.mesoshell.levels = surface, 1
    cast = mail.torus.modifiers.new("Cast", 'CAST')
    cast.factor, cast.show_in_editmode = 0.2, True
    bpy.context.view_layer.objects.active = mail.torus
    bpy.ops.object.mode_set(mode='EDIT')
    try:
        mesh = bmesh.from_edit_mesh(mail.torus.data)
        for vertex in mesh.verts:
            vertex.co.z *= 1.5
        bmesh.update_edit_mesh(mail.torus.data)
        during = rendering.render(mail.file)
    finally:
        bpy.ops.object.mode_set(mode='OBJECT')
    after = rendering.render(mail.file)
    np.testing.assert_array_equal(during["Combined"], after["Combined"])
    assert (after[mail.index] != before[mail.index]).mean() > 0.01


def test_a_long_animation_keeps_its_memory(mail, tmp_path):
    scenes.animate_bone(scenes.make_bone("Rig", mail.torus), 40)
    mail.render.resolution_percentage = 50
    mail.render.filepath = str(tmp_path / "frame_####")

    def animate(first, last):
        mail.scene.frame_start, mail.scene.frame_end = first, last
        assert bpy.ops.render.render(animation=True) == {'FINISHED'}
    animate(1, 8)
    before = scenes.resident()
    animate(9, 40)
    grown = (scenes.resident() - before) / 32
    print(f"{grown / 1e3:.1f} kB a frame")
    # The shell and its surface, kept once more each frame, would be 150 kB, the picture's passes 60.
    assert grown < 40e3


def test_disabled_the_engine_is_gone_and_enabled_it_is_back(addon, mail):
    """Without the add-on a file that asks for the engine harms nothing; panels of others are as they were."""
    def engines():
        return {name: frozenset(cls.COMPAT_ENGINES - {'MESOSHELL'}) for name in dir(bpy.types)
                if isinstance(getattr(cls := getattr(bpy.types, name), "COMPAT_ENGINES", None), set)
                and not name.startswith("MESOSHELL")}

    def shown():
        return {name for name in dir(bpy.types) if 'MESOSHELL' in getattr(getattr(bpy.types, name), "COMPAT_ENGINES", ())}
    enabled, others = shown(), engines()
    assert {"RENDER_PT_color_management", "DATA_PT_lens", "DATA_PT_EEVEE_light", "EEVEE_MATERIAL_PT_surface",
            "EEVEE_WORLD_PT_surface", "OBJECT_PT_visibility", "MESOSHELL_RENDER_PT_sampling"} <= enabled
    assert not enabled & {"CYCLES_RENDER_PT_sampling", "RENDER_PT_eevee_sampling", "DATA_PT_light"}
    picture = rendering.render(mail.file)
    addon.unregister()
    try:
        assert shown() == set() and engines() == others
        assert mail.render.engine != 'MESOSHELL'
        bpy.context.view_layer.update()
    finally:
        addon.register()
    assert shown() == enabled and mail.render.engine == 'MESOSHELL'
    np.testing.assert_array_equal(rendering.render(mail.file)["Combined"], picture["Combined"])


@pytest.mark.window
def test_the_engines_panels_draw_in_the_properties_editor(part, stage, monkeypatch, capfd):
    lamp = make_sun()
    cube = make_cube("Block", (0.0, 0.0, 0.0))
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == 'PROPERTIES')
    drawn, errors = set(), []

    def watched(cls, draw):
        def watch(self, context):
            drawn.add(cls.__name__)
            try:
                draw(self, context)
            except BaseException as error:
                errors.append((cls.__name__, error))
        return watch
    classes = part("ui.engine_panels").CLASSES
    for cls in classes:
        monkeypatch.setattr(cls, "draw", watched(cls, cls.draw))
    before = area.spaces.active.context
    try:
        for active, tabs in ((cube, ('RENDER', 'VIEW_LAYER', 'OBJECT', 'MATERIAL', 'WORLD')), (lamp, ('DATA',))):
            bpy.context.view_layer.objects.active = active
            for tab in tabs:
                area.spaces.active.context = tab
                bpy.ops.wm.redraw_timer(type='DRAW_WIN_SWAP', iterations=2)
    finally:
        area.spaces.active.context = before
    said = capfd.readouterr()
    assert not errors and "rna_uiItem" not in said.out + said.err
    assert {"MESOSHELL_RENDER_PT_sampling", "MESOSHELL_RENDER_PT_film", "MESOSHELL_VIEWLAYER_PT_passes",
            "MESOSHELL_LIGHT_PT_shadow"} <= drawn
