"""The draw handler in the real window: what the screen shows of a shell, among ordinary objects, from several sides."""

import sys
from pathlib import Path

import bpy
import gpu
import numpy as np
import pytest
from mathutils import Matrix, Vector

sys.path.append(str(Path(__file__).resolve().parents[1]))
import mail_scenes  # noqa: E402  (shared with the tests outside Blender)
import scenes  # noqa: E402
import x11_screen  # noqa: E402

pytestmark = pytest.mark.window


@pytest.fixture
def view():
    """The 3D View of the window, plain: its region and space; as it was afterwards."""
    window = bpy.context.window_manager.windows[0]
    area = next(a for a in window.screen.areas if a.type == 'VIEW_3D')
    space = area.spaces.active
    overlay = space.overlay
    names = ("show_overlays", "show_floor", "show_axis_x", "show_axis_y", "show_cursor", "show_text", "show_extras",
             "show_outline_selected", "show_object_origins")
    before = {name: getattr(overlay, name) for name in names}
    for name in names[1:]:
        setattr(overlay, name, False)
    space.show_gizmo = space.show_region_ui = space.show_region_toolbar = space.show_region_tool_header = False
    # Ordinary objects in flat colors that no shell has, so that equal color means the shell is what is seen.
    plain = dict(type='SOLID', light='FLAT', color_type='OBJECT', show_xray=False)
    shading = {name: getattr(space.shading, name) for name in plain}
    for name, value in plain.items():
        setattr(space.shading, name, value)
    yield space, next(r for r in area.regions if r.type == 'WINDOW')
    for name, value in shading.items():
        setattr(space.shading, name, value)
    space.show_gizmo = True
    for name, value in before.items():
        setattr(overlay, name, value)


@pytest.fixture
def mail(part, native, fresh, tmp_path):
    """The chain-mail torus with an enabled shell, and a cube half sunk in it; nothing else in sight."""
    hidden = [obj for obj in bpy.context.view_layer.objects if not obj.hide_get()]
    for obj in hidden:
        obj.hide_set(True)
    path = tmp_path / "mail.gdm.exr"
    mail_scenes.chain_map(native).save(path)
    torus = scenes.make_torus("Mail", minor=0.42, around=24, across=12)
    cube = scenes.make_object("Block", np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 0.3,
                              [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    cube.location = (0.9, -0.7, 0.5)
    cube.color, torus.color = (0.05, 0.3, 0.9, 1.0), (0.8, 0.1, 0.05, 1.0)
    bpy.context.view_layer.update()
    assert bpy.ops.mesoshell.add_shell(object=torus.name, filepath=str(path), thickness=0.31, levels=1, tiles_u=10,
                                       tiles_v=5) == {'FINISHED'}
    yield torus, cube
    for obj in hidden:
        if obj.name in bpy.data.objects:
            obj.hide_set(False)


def look(space, region, eye, target=(0.0, 0.0, 0.0)):
    """Turn the view; redraw; returns clip_from_world."""
    space.region_3d.view_perspective = 'PERSP'
    space.region_3d.view_matrix = Matrix(mail_scenes.view_from(eye, target).tolist())
    redraw()
    return np.array(space.region_3d.perspective_matrix, np.float64)


def redraw():
    # On Vulkan what is presented is a frame behind what was drawn.
    frames = 2 if gpu.platform.backend_type_get() == 'VULKAN' else 1
    bpy.ops.wm.redraw_timer(type='DRAW_WIN_SWAP', iterations=frames)


def expected(part, native, instance, objects, clip_from_world, region):
    """By the reference renderer and Embree: (linear color of the shell, where it is in front, where it is behind)."""
    size = (region.width, region.height)
    lit = part("host.lights").read(bpy.context.evaluated_depsgraph_get())
    record = part("gpu.draw").settings_record(traversal="sdf", base_color=instance.settings.base_color, lights=lit,
                                              world_from_object=instance.world_from_object)
    shell = native.render(instance.shell, instance.map, clip_from_object=clip_from_world @ instance.world_from_object,
                          size=size, settings=record.tobytes())
    solid = np.full(size[::-1], np.inf)
    for obj in objects:
        mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        mesh.calc_loop_triangles()
        points = np.array([obj.matrix_world @ v.co for v in mesh.vertices], np.float32)
        triangles = np.array([t.vertices[:] for t in mesh.loop_triangles])
        solid = np.minimum(solid, native.trace(points, triangles, clip_from_object=clip_from_world, size=size)["distance"])
    hit = shell["hit"] == 1
    hit[:16], hit[-16:], hit[:, :16], hit[:, -16:] = False, False, False, False  # there Blender draws the area's border
    # Within half a percent of each other, the depth buffer decides.
    return shell["color"][..., :3], hit & (shell["distance"] < 0.995 * solid), hit & (shell["distance"] > 1.005 * solid)


@pytest.mark.parametrize("eye", [(2.6, -2.7, 2.4), (-3.0, 1.5, 1.0), (0.4, -3.6, -1.2), (1.6, -1.4, 1.2)],
                         ids=["above", "behind", "below", "close"])
def test_shell_is_drawn_before_and_behind_ordinary_objects(part, native, view, mail, eye):
    space, region = view
    torus, cube = mail
    clip_from_world = look(space, region, eye)
    instance, = part("host.shells").visible(bpy.context.evaluated_depsgraph_get(), space)
    shown = x11_screen.region(region)
    color, before, behind = expected(part, native, instance, [torus, cube], clip_from_world, region)
    assert before.sum() > 5000 and behind.sum() > 500, "the view shows too little to tell"
    alike = x11_screen.looks_like(shown, color)
    print(f"in front: {alike[before].mean():.3%} of {before.sum()}, behind: {alike[behind].mean():.3%} of {behind.sum()}")
    assert alike[before].mean() >= 0.999
    assert alike[behind].mean() <= 0.001


EEVEE = 'BLENDER_EEVEE_NEXT' if (4, 2, 0) <= bpy.app.version < (5, 0, 0) else 'BLENDER_EEVEE'


@pytest.mark.parametrize("shading, engine, overlays", [
    (dict(type='SOLID', show_xray=True), EEVEE, True), (dict(type='WIREFRAME', show_xray_wireframe=True), EEVEE, True),
    (dict(type='RENDERED'), EEVEE, False), (dict(type='RENDERED'), 'CYCLES', False), (dict(type='MATERIAL'), EEVEE, False),
    (dict(type='RENDERED'), 'MESOSHELL', False),
], ids=["x-ray", "x-ray wireframe", "eevee without overlays", "cycles without overlays", "material without overlays",
        "our engine without overlays"])
def test_modes_that_leave_no_depth(part, native, view, mail, shading, engine, overlays):
    """Where Blender's own depth is not to be had, ours is: the same picture, before and behind."""
    space, region = view
    torus, cube = mail
    torus.mesoshell.base_color = (0.05, 0.9, 0.1)  # a color that no other object has in any mode
    render, before_engine = bpy.context.scene.render, bpy.context.scene.render.engine
    render.engine = engine
    for name, value in shading.items():
        setattr(space.shading, name, value)
    space.overlay.show_overlays = overlays
    try:
        clip_from_world = look(space, region, (2.6, -2.7, 2.4))
        instance, = part("host.shells").visible(bpy.context.evaluated_depsgraph_get(), space)
        shown = x11_screen.region(region)
        color, before, behind = expected(part, native, instance, [torus, cube], clip_from_world, region)
    finally:
        render.engine = before_engine
        for name in shading:
            space.shading.property_unset(name)
    alike = x11_screen.looks_like(shown, color)
    print(f"in front: {alike[before].mean():.3%} of {before.sum()}, behind: {alike[behind].mean():.3%} of {behind.sum()}")
    assert alike[before].mean() >= 0.999
    assert alike[behind].mean() <= 0.001


def test_moved_object_is_drawn_where_it_is(part, native, view, mail):
    space, region = view
    torus, cube = mail
    torus.location, torus.rotation_euler, torus.scale = Vector((0.3, 0.2, 0.1)), (0.4, 0.1, 1.0), (-0.9, 1.1, 0.8)
    bpy.context.view_layer.update()
    clip_from_world = look(space, region, (2.6, -2.7, 2.4))
    instance, = part("host.shells").visible(bpy.context.evaluated_depsgraph_get(), space)
    shown = x11_screen.region(region)
    color, before, _behind = expected(part, native, instance, [torus, cube], clip_from_world, region)
    assert before.sum() > 5000
    assert x11_screen.looks_like(shown, color)[before].mean() >= 0.995


def test_disabled_shell_and_hidden_object_are_not_drawn(part, native, view, mail):
    space, region = view
    torus, cube = mail
    clip_from_world = look(space, region, (2.6, -2.7, 2.4))
    instance, = part("host.shells").visible(bpy.context.evaluated_depsgraph_get(), space)
    color, before, _behind = expected(part, native, instance, [torus, cube], clip_from_world, region)
    torus.mesoshell.enabled = False
    redraw()
    bare = x11_screen.region(region)
    torus.mesoshell.enabled = True
    torus.hide_set(True)
    redraw()
    hidden = x11_screen.region(region)
    torus.hide_set(False)
    redraw()
    back = x11_screen.region(region)
    alike = [x11_screen.looks_like(shown, color)[before].mean() for shown in (bare, hidden, back)]
    assert alike[0] <= 0.05 and alike[1] <= 0.05 and alike[2] >= 0.995


def test_a_shader_that_does_not_compile_is_one_sentence(part, view, mail, monkeypatch):
    space, region = view
    handler, program, source = part("gpu.handler"), part("gpu.program"), part("core.shader_source")
    program.forget()
    monkeypatch.setattr(source, "stage", lambda name: "this is no GLSL")
    look(space, region, (2.6, -2.7, 2.4))
    assert handler.problem().startswith('"Mail": The graphics driver refused Mesoshell')
    monkeypatch.undo()
    program.forget()
    redraw()
    assert handler.problem() is None


def test_playback_draws_the_moved_shell(part, native, view, mail):
    """An armature turns the torus and lifts it: each frame shows the shell where it is, and holds one shell."""
    space, region = view
    torus, cube = mail
    rig = scenes.make_bone("Rig", torus)
    scenes.animate_bone(rig, 4, location=(0.2, 0.1, 0.3), rotation=(0.5, 0.2, 0.4))
    rig.hide_set(True)
    torus.mesoshell.surface = 'CAGE'
    resources = part("gpu.resources")
    held = []
    try:
        for frame in (1, 3, 4):
            bpy.context.scene.frame_set(frame)
            clip_from_world = look(space, region, (2.6, -2.7, 2.4))
            instance, = part("host.shells").visible(bpy.context.evaluated_depsgraph_get(), space)
            shown = x11_screen.region(region)
            color, before, _behind = expected(part, native, instance, [torus, cube], clip_from_world, region)
            assert before.sum() > 5000
            lift = scenes.bone_motion(rig)[2, 3]
            assert np.asarray(instance.shell.bounds)[1, 2] > 0.6 + lift
            assert x11_screen.looks_like(shown, color)[before].mean() >= 0.995
            held.append(len(resources._shells))
    finally:
        bpy.context.scene.frame_set(1)
    assert held[0] == held[-1]
