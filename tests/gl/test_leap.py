"""The shader text finds on the GPU the cell, the bin and the leap that it finds in C++."""

import mail_scenes
import numpy
from core import shader_source
from OpenGL import GL

COUNT, CELLS, SIDE = 4096, (30, 26, 14), 6

MAIN = """
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Rays { vec4 rays[]; };  // position and direction, then what is found
uniform vec3 cells;
uniform vec3 scale;
uniform int side;

void main()
{
    uint ray = gl_GlobalInvocationID.x;
    vec3 pos_texture = rays[2u * ray].xyz;
    vec3 dir_metric = rays[2u * ray + 1u].xyz;
    vec3 cell = leap_cell(pos_texture, cells);
    float index = (cell.z * cells.y + cell.y) * cells.x + cell.x;
    rays[2u * ray] = vec4(index, float(octahedral_bin(dir_metric, side)),
                          leap_length(pos_texture, dir_metric, cells, scale, 0.5),
                          leap_length(pos_texture, dir_metric, cells, scale, 0.0));
}
"""


def test_leaps_match_cpp(gl, native):
    leaps = native.bake_leaps(mail_scenes.chain_sample(native), cells=CELLS, directions=SIDE)
    rng = numpy.random.default_rng(4)
    positions = rng.uniform((-1, -1, 0), (2, 2, 1), (COUNT, 3)).astype(numpy.float32)
    directions = rng.normal(size=(COUNT, 3))
    directions = (directions / numpy.linalg.norm(directions, axis=1, keepdims=True)).astype(numpy.float32)

    library = shader_source.resolve(shader_source.FOLDER / "lib/leap.glsl")
    program = gl.compile_program(comp="#version 450 core\n" + library + MAIN)
    rays = numpy.zeros((COUNT, 2, 4), numpy.float32)
    rays[:, 0, :3], rays[:, 1, :3] = positions, directions
    buffer = int(GL.glGenBuffers(1))
    GL.glBindBufferBase(GL.GL_SHADER_STORAGE_BUFFER, 0, buffer)
    GL.glBufferData(GL.GL_SHADER_STORAGE_BUFFER, rays.nbytes, rays, GL.GL_DYNAMIC_READ)
    GL.glUseProgram(program)
    GL.glUniform3f(GL.glGetUniformLocation(program, "cells"), *CELLS)
    GL.glUniform3f(GL.glGetUniformLocation(program, "scale"), 1.0, leaps.aspect, leaps.height)
    GL.glUniform1i(GL.glGetUniformLocation(program, "side"), SIDE)
    GL.glDispatchCompute(COUNT // 64, 1, 1)
    GL.glMemoryBarrier(GL.GL_BUFFER_UPDATE_BARRIER_BIT)
    found = numpy.frombuffer(GL.glGetBufferSubData(GL.GL_SHADER_STORAGE_BUFFER, 0, rays.nbytes), numpy.float32)
    cell, bins, leap_of_half, leap_of_nothing = found.reshape(COUNT, 2, 4)[:, 0].T

    assert (leap_of_nothing == 0.0).all()
    assert numpy.unique(cell).size > 3000 and numpy.unique(bins).size == SIDE * SIDE
    bound = leaps.values.reshape(SIDE * SIDE, -1)[bins.astype(int), cell.astype(int)] * leaps.unit
    expected = numpy.where(bound > 0.0, leap_of_half - 0.5 + bound, 0.0)
    truth = leaps.lookup(positions, directions)
    # A ray within a rounding of a border may be on its other side.
    apart = numpy.abs(expected - truth) > 1e-4
    assert apart.sum() <= 2
    assert (truth > 0.0).mean() > 0.2
