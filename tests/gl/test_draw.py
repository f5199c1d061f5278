"""The draw program on EGL against the reference renderer: one shader text, two compilers, two ways to the prisms."""

import numpy
import pytest
import mail_scenes
from core import shader_source

SIZE = (160, 160)


@pytest.fixture(scope="module")
def program(gl):
    return gl.shell_program()


@pytest.fixture(scope="module")
def inputs(gl, native):
    return gl.Inputs(mail_scenes.torus_shell(native), mail_scenes.chain_map(native))


def draw(gl, native, program, inputs, view, traversal, output):
    record = shader_source.shell_interface().defaults()
    record["mode"][:2] = mail_scenes.TRAVERSALS[traversal], output
    clip_from_object = mail_scenes.VIEWS[view]
    block = native.shell_params(record.tobytes(), mail_scenes.chain_map(native), clip_from_object)
    return gl.draw_shell(program, mail_scenes.torus_shell(native), inputs, block, clip_from_object, SIZE)


def test_draw_of_the_papers_layout_matches_render(gl, native, program):
    shell, tile_map = mail_scenes.torus_shell(native), mail_scenes.chain_map(native, "paper")
    record = shader_source.shell_interface().defaults()
    record["mode"][:2] = 0, 1
    clip_from_object = mail_scenes.VIEWS["above"]
    block = native.shell_params(record.tobytes(), tile_map, clip_from_object)
    texels, depth = gl.draw_shell(program, shell, gl.Inputs(shell, tile_map), block, clip_from_object, SIZE)
    picture = native.render(shell, tile_map, clip_from_object=clip_from_object, size=SIZE, traversal="gdm")
    mail_scenes.check_parity(depth, texels[..., 3], picture, clip_from_object, "gdm")


@pytest.mark.parametrize("traversal", mail_scenes.TRAVERSALS)
@pytest.mark.parametrize("view", mail_scenes.VIEWS)
def test_draw_matches_render(gl, native, program, inputs, view, traversal):
    texels, depth = draw(gl, native, program, inputs, view, traversal, output=1)
    picture = native.render(
        mail_scenes.torus_shell(native), mail_scenes.chain_map(native), clip_from_object=mail_scenes.VIEWS[view], size=SIZE, traversal=traversal
    )
    mail_scenes.check_parity(depth, texels[..., 3], picture, mail_scenes.VIEWS[view], traversal)


def test_draw_of_the_papers_fins_matches_render(gl, native, program, inputs):
    record = shader_source.shell_interface().defaults()
    record["mode"][:3] = 1, 1, 1
    clip_from_object = mail_scenes.VIEWS["above"]
    shell, tile_map = mail_scenes.torus_shell(native), mail_scenes.chain_map(native)
    block = native.shell_params(record.tobytes(), tile_map, clip_from_object)
    texels, depth = gl.draw_shell(program, shell, inputs, block, clip_from_object, SIZE)
    picture = native.render(shell, tile_map, clip_from_object=clip_from_object, size=SIZE, traversal="sdf", settings=record.tobytes())
    exact = native.render(shell, tile_map, clip_from_object=clip_from_object, size=SIZE, traversal="sdf")
    mail_scenes.check_parity(depth, texels[..., 3], picture, clip_from_object, "gdm")
    assert (picture["distance"] != exact["distance"]).mean() > 0.1, "the fins of this shell are flat"


def test_depth_is_the_hit_s_own(gl, native, program, inputs):
    view = "above"
    texels, depth = draw(gl, native, program, inputs, view, "sdf", output=1)
    hit = depth < 1.0
    # Unproject every pixel with its depth: its distance from the eye is the one the shader says it found.
    ys, xs = numpy.nonzero(hit)
    ndc = numpy.stack([(xs + 0.5) / SIZE[0] * 2 - 1, (ys + 0.5) / SIZE[1] * 2 - 1, depth[hit] * 2.0 - 1.0, numpy.ones(len(xs))])
    points = numpy.linalg.inv(mail_scenes.VIEWS[view]) @ ndc
    eye = native.eye(mail_scenes.VIEWS[view])[:3]
    distance = numpy.linalg.norm((points[:3] / points[3]).T - eye, axis=1)
    # Depth is a 32-bit float; at the distance 5 of a view with near = 0.1, one rounding of it is 5 * 5 / 0.1 * 2^-24.
    numpy.testing.assert_allclose(distance, texels[hit][:, 3], atol=8 * 250 * 2.0**-24)


def test_normals_match_render(gl, native, program, inputs):
    texels, depth = draw(gl, native, program, inputs, "above", "sdf", output=2)
    picture = native.render(mail_scenes.torus_shell(native), mail_scenes.chain_map(native), clip_from_object=mail_scenes.VIEWS["above"], size=SIZE,
                            traversal="sdf")
    both = (depth < 1.0) & (picture["hit"] == 1)
    cosine = numpy.sum(texels[..., :3] * picture["normal"], axis=-1)[both]
    assert (cosine > numpy.cos(numpy.radians(0.5))).mean() >= 0.999


def test_color_matches_render(gl, native, program, inputs):
    texels, depth = draw(gl, native, program, inputs, "close", "sdf", output=0)
    picture = native.render(mail_scenes.torus_shell(native), mail_scenes.chain_map(native), clip_from_object=mail_scenes.VIEWS["close"], size=SIZE,
                            traversal="sdf")
    both = (depth < 1.0) & (picture["hit"] == 1)
    assert (numpy.abs(texels - picture["color"])[both].max(axis=-1) < 0.01).mean() >= 0.999
