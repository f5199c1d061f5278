"""The shader text finds the places of positions and texture positions on the GPU to 1e-5, as it does in C++."""

import numpy
from core import shader_source
from OpenGL import GL

COUNT = 16384
PROMISED = 1e-5  # prism coordinates, tile units

MAIN = """
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Points { vec4 rows[]; };  // the eight texels of a prism, a position, a texture position

void main()
{
    uint first = gl_GlobalInvocationID.x * 10u;
    Prism prism = make_prism(rows[first], rows[first + 1u], rows[first + 2u], rows[first + 3u], rows[first + 4u],
                             rows[first + 5u], rows[first + 6u], rows[first + 7u]);
    PrismPlace of_position = place_of_position(prism, rows[first + 8u].xyz);
    PrismPlace of_texture = place_of_texture(prism, rows[first + 9u].xyz);
    PrismPoint texture_position = prism_texture_of_position(prism, rows[first + 8u].xyz);
    PrismPoint position = prism_position_of_texture(prism, rows[first + 9u].xyz);
    rows[first] = vec4(of_position.q, of_position.found ? 1.0 : 0.0);
    rows[first + 1u] = vec4(of_texture.q, of_texture.found ? 1.0 : 0.0);
    rows[first + 2u] = vec4(texture_position.point, 0.0);
    rows[first + 3u] = vec4(position.point, 0.0);
}
"""


def columns(prisms, w):
    """Positions [n, 3, 3] and UVs [n, 3, 2] of the corner columns at height w [n], float64."""
    texels = prisms.astype(float)
    uv = numpy.concatenate([texels[:, 6], texels[:, 7, :2]], 1)
    uv = numpy.stack([texels[:, :6, 3], uv], -1)
    w = w[:, None, None]
    return texels[:, :3, :3] * (1 - w) + texels[:, 3:6, :3] * w, uv[:, :3] * (1 - w) + uv[:, 3:] * w


def at(corners, q):
    """The point with weights q [n, 2] of columns 1 and 2."""
    weights = numpy.stack([1 - q[:, 0] - q[:, 1], q[:, 0], q[:, 1]], 1)
    return (corners * weights[:, :, None]).sum(1)


def place_of(prisms, points, q):
    """Newton's iteration in double precision from q near the place of each point."""
    q = q.copy()
    for _ in range(12):
        corners = columns(prisms, q[:, 2])[0]
        rise = columns(prisms, numpy.ones(len(q)))[0] - columns(prisms, numpy.zeros(len(q)))[0]
        jacobian = numpy.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], at(rise, q[:, :2])], -1)
        q -= numpy.linalg.solve(jacobian, (at(corners, q[:, :2]) - points)[..., None])[..., 0]
    return q


def random_prisms(random, thickness, away):
    """Prisms [n, 8, 4] with edges of 1 and columns of that height that lean, turned anywhere, `away` from the origin."""
    count = len(thickness)
    turn = numpy.linalg.qr(random.normal(size=(count, 3, 3)))[0]
    center = random.normal(size=(count, 3))
    center *= (away * numpy.maximum(thickness, 1) / numpy.linalg.norm(center, axis=1))[:, None]
    base = numpy.array([(0, 0, 0), (1, 0, 0), (0.3, 0.9, 0)]) + random.uniform(-0.2, 0.2, (count, 3, 3)) * (1, 1, 0)
    lean = (0.15 * numpy.minimum(thickness, 1))[:, None, None]
    director = random.uniform(-1, 1, (count, 3, 3)) * lean
    director[:, :, 2] = random.uniform(0.6, 1.4, (count, 3)) * thickness[:, None]
    uv = base[:, :, :2] * 3 + random.uniform(-0.2, 0.2, (count, 3, 2)) + 2
    uv_top = uv + random.uniform(-0.2, 0.2, (count, 3, 2))
    prisms = numpy.zeros((count, 8, 4))
    prisms[:, :3, :3] = center[:, None] + base @ turn.transpose(0, 2, 1)
    prisms[:, 3:6, :3] = prisms[:, :3, :3] + director @ turn.transpose(0, 2, 1)
    prisms[:, :3, 3], prisms[:, 3:6, 3] = uv[..., 0], uv_top[..., 0]
    prisms[:, 6, :3], prisms[:, 6, 3], prisms[:, 7, :2] = uv[..., 1], uv_top[:, 0, 1], uv_top[:, 1:, 1]
    return prisms.astype(numpy.float32)


def test_places_are_exact(gl):
    random = numpy.random.default_rng(9)
    thickness = 10.0 ** random.uniform(-3, 1, COUNT)
    prisms = random_prisms(random, thickness, numpy.where(numpy.arange(COUNT) % 2, 1e3, 0.0))
    q = random.dirichlet((1, 1, 1), COUNT)
    q[:, 2] = random.uniform(0, 1, COUNT)
    corners, uvs = columns(prisms, q[:, 2])
    rows = numpy.zeros((COUNT, 10, 4), numpy.float32)
    rows[:, :8] = prisms
    rows[:, 8, :3] = at(corners, q[:, :2])
    rows[:, 9, :2], rows[:, 9, 2] = at(uvs, q[:, :2]), q[:, 2]

    library = shader_source.resolve(shader_source.FOLDER / "lib/prism_inverse.glsl")
    program = gl.compile_program(comp="#version 450 core\n" + library + MAIN)
    buffer = int(GL.glGenBuffers(1))
    GL.glBindBufferBase(GL.GL_SHADER_STORAGE_BUFFER, 0, buffer)
    GL.glBufferData(GL.GL_SHADER_STORAGE_BUFFER, rows.nbytes, rows, GL.GL_DYNAMIC_READ)
    GL.glUseProgram(program)
    GL.glDispatchCompute(COUNT // 64, 1, 1)
    GL.glMemoryBarrier(GL.GL_BUFFER_UPDATE_BARRIER_BIT)
    found = numpy.frombuffer(GL.glGetBufferSubData(GL.GL_SHADER_STORAGE_BUFFER, 0, rows.nbytes), numpy.float32)
    of_position, of_texture, texture, position = found.reshape(COUNT, 10, 4)[:, :4].astype(float).transpose(1, 0, 2)

    points = rows[:, 8, :3].astype(float)
    truth = place_of(prisms, points, q)
    # Rounding a point far away may take it out of a thin prism.
    inside = (truth >= 0).all(1) & (truth[:, 0] + truth[:, 1] <= 1) & (truth[:, 2] <= 1)
    assert inside.sum() > 0.8 * COUNT
    assert (of_position[inside, 3] == 1).all()
    error = numpy.abs(of_position[:, :3] - truth)[inside].max()
    print(f"places of {inside.sum()} positions: worst {error:.2g}")
    assert error <= PROMISED
    expected = at(columns(prisms, truth[:, 2])[1], truth[:, :2])
    numpy.testing.assert_allclose(texture[inside, :2], expected[inside], atol=PROMISED)
    numpy.testing.assert_allclose(texture[inside, 2], truth[inside, 2], atol=PROMISED)

    assert (of_texture[:, 3] == 1).all()
    uv_found = at(columns(prisms, of_texture[:, 2])[1], of_texture[:, :2])
    numpy.testing.assert_allclose(uv_found, rows[:, 9, :2], atol=PROMISED)
    at_place = at(columns(prisms, of_texture[:, 2])[0], of_texture[:, :2])
    size = numpy.maximum(thickness, 1)[:, None]
    # The position itself is rounded, far away by more than the inverse promises.
    assert (numpy.abs(position[:, :3] - at_place) <= PROMISED * size + 4 * 2.0**-24 * numpy.abs(prisms[:, :1, :3]).max((1, 2))[:, None]).all()
