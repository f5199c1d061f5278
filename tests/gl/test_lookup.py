"""The shader text's lookups give on the GPU the numbers they give in C++."""

import numpy
import pytest
import mail_scenes
from core import shader_source
from OpenGL import GL

COUNT = 2000

VERTEX = """#version 450 core
void main()
{
    // One triangle over the whole target.
    gl_Position = vec4(float(gl_VertexID & 1) * 4.0 - 1.0, float(gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}
"""


@pytest.mark.parametrize("layout, precision", [("paper", "half"), ("paper", "byte"), ("share", "byte"), ("nodes", "byte"),
                                               ("nodes", "half")])
def test_lookup_matches_cpp(gl, native, layout, precision):
    tile_map = mail_scenes.chain_map(native, layout, precision)
    positions, directions = mail_scenes.probe_points(COUNT)
    table = shader_source.shell_interface()
    preamble = table.glsl_preamble("frag").replace("out vec4 frag_color;", "out vec4 probe_result;")
    preamble += "layout(binding = 6) uniform sampler2D probe_points;\n"
    program = gl.compile_program(vert=VERTEX, frag=preamble + mail_scenes.probe_source(shader_source))

    inputs = gl.Inputs(mail_scenes.torus_shell(native), tile_map)
    points = numpy.zeros((2, COUNT, 4), numpy.float32)
    points[0, :, :3], points[1, :, :3] = positions, directions
    inputs.textures.append((GL.GL_TEXTURE_2D, gl.texture(GL.GL_TEXTURE_2D, GL.GL_RGBA32F, points)))

    target = int(GL.glGenFramebuffers(1))
    result = gl.texture(GL.GL_TEXTURE_2D, GL.GL_RGBA32F, numpy.zeros((1, COUNT, 4), numpy.float32))
    inputs.bind(native.shell_params(table.defaults().tobytes(), tile_map, mail_scenes.VIEWS["above"]))
    GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, target)
    GL.glFramebufferTexture2D(GL.GL_FRAMEBUFFER, GL.GL_COLOR_ATTACHMENT0, GL.GL_TEXTURE_2D, result, 0)
    GL.glViewport(0, 0, COUNT, 1)
    GL.glDisable(GL.GL_DEPTH_TEST)
    GL.glDisable(GL.GL_CULL_FACE)
    GL.glUseProgram(program)
    GL.glBindVertexArray(int(GL.glGenVertexArrays(1)))
    GL.glDrawArrays(GL.GL_TRIANGLES, 0, 3)
    pixels = numpy.frombuffer(GL.glReadPixels(0, 0, COUNT, 1, GL.GL_RGBA, GL.GL_FLOAT), numpy.float32).reshape(COUNT, 4)
    GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)

    mail_scenes.check_probe(native, pixels, positions, directions, layout, precision)
