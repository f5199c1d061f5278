"""The draw code in Blender against the reference renderer: offscreen, wherever there is a GPU."""

import sys
from pathlib import Path

import gpu
import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[1]))
import mail_scenes  # noqa: E402  (shared with the tests outside Blender)
import scenes  # noqa: E402

pytestmark = pytest.mark.gpu

SIZE = (160, 160)
MIRRORED = np.array([[-1.3, 0.2, 0.0, 0.4], [0.1, 0.8, 0.3, -0.2], [0.0, -0.2, 1.1, 0.1], [0.0, 0.0, 0.0, 1.0]])


@pytest.fixture
def instance(part, native):
    """instance(world_from_object, traversal): the chain-mail torus, as the handler would draw it."""
    shells = part("host.shells")

    def make(world_from_object=np.eye(4), traversal="sdf", fins="exact"):
        settings = shells.ShellSettings(traversal, (0.6, 0.5, 0.4, 1.0), fins)
        # Versions that no shell of another test has.
        return shells.ShellInstance("Torus", mail_scenes.torus_shell(native), mail_scenes.chain_map(native), world_from_object,
                                    settings, -1, -1, ("torus",), {})

    return make


def test_the_list_of_traversals_is_whole(part):
    """What is compared below is all that can be drawn and chosen."""
    assert part("gpu.draw").TRAVERSALS == mail_scenes.TRAVERSALS
    assert {name for name, *_ in part("host.shell_options").TRAVERSALS} == set(mail_scenes.TRAVERSALS)


@pytest.mark.parametrize("traversal", mail_scenes.TRAVERSALS)
@pytest.mark.parametrize("view", mail_scenes.VIEWS)
def test_draw_matches_render(part, native, instance, view, traversal):
    clip_from_world = mail_scenes.VIEWS[view]
    texels, depth = part("gpu.offscreen").picture([instance(traversal=traversal)], clip_from_world, SIZE, output="texture")
    compare(native, texels, depth, clip_from_world, traversal)


def test_the_papers_fins_are_drawn_as_they_are_rendered(part, native, instance):
    """Two planes a fin: another picture than that of bilinear ones, and the reference renderer's."""
    clip_from_world = mail_scenes.VIEWS["above"]
    drawn = {fins: part("gpu.offscreen").picture([instance(fins=fins)], clip_from_world, SIZE, output="texture")
             for fins in ("exact", "paper")}
    assert (drawn["exact"][0] != drawn["paper"][0]).any()
    record = part("gpu.draw").settings_record(traversal="sdf", base_color=(1, 1, 1, 1), lights=None,
                                              world_from_object=np.eye(4), fins="paper")
    compare(native, *drawn["paper"], clip_from_world, "sdf", settings=record.tobytes())


def test_mirrored_and_sheared_object_matches_render(part, native, instance):
    clip_from_world = mail_scenes.VIEWS["above"]
    texels, depth = part("gpu.offscreen").picture([instance(MIRRORED)], clip_from_world, SIZE, output="texture")
    compare(native, texels, depth, clip_from_world @ MIRRORED, "sdf")


def test_shells_occlude_each_other_by_depth(part, native, instance):
    """Two interlocked rings drawn in either order give one picture: the nearer of the two at every pixel."""
    turned = np.array([[1.0, 0, 0, 1.0], [0, 0, -1.0, 0], [0, 1.0, 0, 0], [0, 0, 0, 1.0]])
    offscreen = part("gpu.offscreen")
    view = mail_scenes.VIEWS["orthographic"]
    pair = [instance(), instance(turned)]
    depths = [offscreen.picture(drawn, view, SIZE)[1] for drawn in (pair, pair[::-1], pair[:1], pair[1:])]
    np.testing.assert_array_equal(depths[0], depths[1])
    np.testing.assert_array_equal(depths[0], np.minimum(depths[2], depths[3]))
    assert (depths[2] < depths[3]).any() and (depths[3] < depths[2]).any()


def test_state_is_as_before_a_draw(part, instance):
    gpu.state.depth_test_set('ALWAYS')
    gpu.state.depth_mask_set(False)
    gpu.state.blend_set('ALPHA')
    try:
        part("gpu.offscreen").picture([instance()], mail_scenes.VIEWS["above"], (8, 8))
        assert (gpu.state.depth_test_get(), gpu.state.depth_mask_get(), gpu.state.blend_get()) == ('ALWAYS', False, 'ALPHA')
    finally:
        gpu.state.depth_test_set('NONE')
        gpu.state.depth_mask_set(False)
        gpu.state.blend_set('NONE')


def test_lookup_matches_cpp(part, native):
    """The probe of tests/gl, compiled by Blender."""
    count = 1000
    source, resources = part("core.shader_source"), part("gpu.resources")
    table = source.shell_interface()
    info = gpu.types.GPUShaderCreateInfo()
    info.typedef_source(table.glsl_struct())
    info.uniform_buf(0, table.struct, table.instance)
    for slot, name in enumerate([*table.samplers, "probe_points"]):
        info.sampler(slot, 'FLOAT_3D' if table.samplers.get(name) == "sampler3D" else 'FLOAT_2D', name)
    info.vertex_in(0, 'VEC2', "pos")
    info.fragment_out(0, 'VEC4', "probe_result")
    info.vertex_source("void main() { gl_Position = vec4(pos, 0.0, 1.0); }")
    info.fragment_source(mail_scenes.probe_source(source))
    program = gpu.shader.create_from_info(info)

    tile_map = mail_scenes.chain_map(native)
    shell = resources.shell_resources(mail_scenes.torus_shell(native), ("torus",), -1)
    textures = resources.map_resources(tile_map, -1)
    positions, directions = mail_scenes.probe_points(count)
    points = np.zeros((2, count, 4), np.float32)
    points[0, :, :3], points[1, :, :3] = positions, directions
    probe_points = gpu.types.GPUTexture((count, 2), format='RGBA32F', data=gpu.types.Buffer('FLOAT', points.size, points.ravel()))
    result = gpu.types.GPUTexture((count, 1), format='RGBA32F')
    target = gpu.types.GPUFrameBuffer(color_slots=result)
    form = gpu.types.GPUVertFormat()
    form.attr_add(id="pos", comp_type='F32', len=2, fetch_mode='FLOAT')
    corners = gpu.types.GPUVertBuf(form, 3)
    corners.attr_fill("pos", [(-1.0, -1.0), (3.0, -1.0), (-1.0, 3.0)])
    block = gpu.types.GPUUniformBuf(native.shell_params(table.defaults().tobytes(), tile_map, mail_scenes.VIEWS["above"]))
    with target.bind():
        program.bind()
        program.uniform_block(table.instance, block)
        for name in table.samplers:
            program.uniform_sampler(name, shell.prism_table if name == "prism_table" else getattr(textures, name))
        program.uniform_sampler("probe_points", probe_points)
        gpu.types.GPUBatch(type='TRIS', buf=corners).draw(program)
        pixels = target.read_color(0, 0, count, 1, 4, 0, 'FLOAT')
    pixels.dimensions = count * 4
    mail_scenes.check_probe(native, np.array(pixels, np.float32).reshape(count, 4), positions, directions)


def test_another_version_of_a_shell_replaces_the_one_before(part, native, instance):
    """Four hundred versions of one shell hold what one holds, and what is drawn is the last."""
    resources, offscreen = part("gpu.resources"), part("gpu.offscreen")
    view = mail_scenes.VIEWS["above"]
    drawn = instance()._replace(place=("animated",))
    larger = mail_scenes.torus_shell(native, thickness=0.6)
    expected = offscreen.picture([drawn._replace(shell=larger, place=("still",))], view, SIZE)[1]
    offscreen.picture([drawn], view, SIZE)
    count = len(resources._shells)
    for version in range(2, 402):
        if version == 50:  # drivers have what they need
            before = scenes.resident()
        frame = drawn._replace(shell=larger if version % 2 else drawn.shell, shell_version=-version)
        depth = offscreen.picture([frame], view, SIZE if version == 401 else (8, 8))[1]
    assert len(resources._shells) <= count
    # 270 kB each; of a software driver all of it is in this process.
    assert scenes.resident() - before < 20e6
    np.testing.assert_array_equal(depth, expected)


def compare(native, texels, depth, clip_from_object, traversal, **settings):
    picture = native.render(mail_scenes.torus_shell(native), mail_scenes.chain_map(native), clip_from_object=clip_from_object,
                            size=SIZE, traversal=traversal, **settings)
    mail_scenes.check_parity(depth, texels[..., 3], picture, clip_from_object, traversal)
