"""What the tests in Python draw and render: the chain-mail tile, a torus, and views of it. Knows no Blender and no GPU."""

import sys
from functools import cache
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "blend_samples"))
from tiles import chain

TILE_HEIGHT = 0.5

# Every traversal that the draw program has, by its number in the uniform block: all are held to the reference renderer.
TRAVERSALS = {"gdm": 0, "sdf": 1, "march": 3, "slices": 4, "refined": 2}


@cache
def chain_sample(native, detail=32):
    """The chain-mail tile as a native Sample."""
    positions, triangles = chain.chain_links(detail)
    return native.Sample(positions, triangles, height=TILE_HEIGHT)


@cache
def chain_map(native, layout="nodes", precision="byte"):
    """A small Map of the chain-mail tile; a number of terms that leaves the last group of four not full."""
    sample = chain_sample(native)
    gdm = native.bake_gdm(sample, resolution=(32, 24, 16), directions=(10, 14))
    return native.compress(gdm, sdf=native.bake_sdf(sample, resolution=(48, 40, 25)),
                           facets=native.bake_facets(sample, cells=24), layout=layout,
                           precision=precision, terms=41 if layout == "nodes" else 15)


def torus_mesh(columns=24, rows=12, tiles=(10, 5), major=1.0, minor=0.42):
    """A torus of quads: positions [n, 3], face_sizes, corners, uvs in tiles [c, 2]."""
    u, v = numpy.meshgrid(numpy.arange(columns), numpy.arange(rows), indexing="ij")
    around, across = u / columns * 2 * numpy.pi, v / rows * 2 * numpy.pi
    ring = major + minor * numpy.cos(across)
    positions = numpy.stack([ring * numpy.cos(around), ring * numpy.sin(around), minor * numpy.sin(across)], -1)
    steps = numpy.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    corner_u = u[..., None] + steps[:, 0]
    corner_v = v[..., None] + steps[:, 1]
    corners = (corner_u % columns) * rows + corner_v % rows
    uvs = numpy.stack([corner_u / columns * tiles[0], corner_v / rows * tiles[1]], -1)
    return (
        positions.reshape(-1, 3).astype(numpy.float32),
        numpy.full(columns * rows, 4, numpy.int32),
        corners.reshape(-1).astype(numpy.int32),
        uvs.reshape(-1, 2).astype(numpy.float32),
    )


@cache
def torus_shell(native, thickness=0.31, levels=1):
    """A closed shell of 1152 prisms."""
    return native.build_shell(*torus_mesh(), thickness=thickness, levels=levels)


def view_from(eye, target=(0.0, 0.0, 0.0)):
    """view_from_world of a camera at `eye` that looks at `target`, float64 [4, 4]."""
    eye, target = numpy.asarray(eye, float), numpy.asarray(target, float)
    back = (eye - target) / numpy.linalg.norm(eye - target)
    right = numpy.cross([0.0, 0.0, 1.0], back)
    right /= numpy.linalg.norm(right)
    matrix = numpy.eye(4)
    matrix[:3, :3] = right, numpy.cross(back, right), back
    matrix[:3, 3] = -matrix[:3, :3] @ eye
    return matrix


def perspective(field_of_view_degrees, near=0.1, far=100.0):
    """clip_from_view of a square picture, OpenGL clip space."""
    scale = 1.0 / numpy.tan(numpy.radians(field_of_view_degrees) / 2)
    matrix = numpy.diag([scale, scale, -(far + near) / (far - near), 0.0])
    matrix[2, 3] = -2.0 * far * near / (far - near)
    matrix[3, 2] = -1.0
    return matrix


def orthographic(half_width, near=0.1, far=100.0):
    """clip_from_view of a square picture, OpenGL clip space."""
    matrix = numpy.diag([1.0 / half_width, 1.0 / half_width, -2.0 / (far - near), 1.0])
    matrix[2, 3] = -(far + near) / (far - near)
    return matrix


VIEWS = {
    "above": perspective(40) @ view_from((2.5, -2.6, 2.4)),
    "grazing": perspective(30) @ view_from((0.3, -4.0, 0.5)),
    "close": perspective(60) @ view_from((1.2, -1.5, 0.9), (0.9, -0.6, 0.2)),
    "orthographic": orthographic(1.7) @ view_from((1.5, -2.0, 2.5)),
    # The far plane cuts through the shell.
    "far": perspective(40, far=4.3) @ view_from((2.5, -2.6, 2.4)),
    # Within the torus's hole, nearer to prisms than the near plane of the others.
    "inside": perspective(80, near=0.01) @ view_from((0.3, 0.0, 0.1), (1.0, 0.1, 0.1)),
}


def window_depth(clip_from_object, distance):
    """Depth in [0, 1] of the points that a picture [h, w] of distances sees, by a formula of its own."""
    height, width = distance.shape
    x, y = numpy.meshgrid((numpy.arange(width) + 0.5) / width * 2 - 1, (numpy.arange(height) + 0.5) / height * 2 - 1)
    object_from_clip = numpy.linalg.inv(clip_from_object)
    near, far = (numpy.stack([x, y, numpy.full_like(x, z), numpy.ones_like(x)], -1) @ object_from_clip.T for z in (-1, 1))
    near, far = near[..., :3] / near[..., 3:], far[..., :3] / far[..., 3:]
    along = (far - near) / numpy.linalg.norm(far - near, axis=-1, keepdims=True)
    eye = object_from_clip @ [0.0, 0.0, 1.0, 0.0]
    start = near if abs(eye[3]) < 1e-9 * numpy.linalg.norm(eye) else eye[:3] / eye[3]
    points = start + along * distance[..., None]
    clip = numpy.concatenate([points, numpy.ones_like(points[..., :1])], -1) @ numpy.asarray(clip_from_object).T
    return clip[..., 2] / clip[..., 3] * 0.5 + 0.5


def check_parity(depth, drawn, picture, clip_from_object, traversal):
    """Assert that a drawing is the rendering, and print the worst pixel.

    `depth` and `drawn` [h, w] are the drawing's depth buffer and its distances, `picture` the rendering. Of a thousand
    pixels one at most is hit by one of them only, and all but one agree to 1e-3 in object units: at a grazing hit, or at the
    edge of what a lookup or a layer takes for a surface, a rounding decides between two places along the ray. With traversals
    that find the surface itself, all but one in ten thousand agree to 1e-3 in the depth buffer's measure or, right before the
    eye where that has no end, in object units: there a rounding decides by how many chords a curve is followed.
    """
    hit, expected = depth < 1.0, picture["hit"] == 1
    both = hit & expected
    rendered = numpy.where(both, picture["distance"], 1.0)
    in_depth = numpy.where(both, numpy.abs(depth - window_depth(clip_from_object, rendered)), 0.0)
    in_distance = numpy.where(both, numpy.abs(drawn - rendered), 0.0)
    y, x = numpy.unravel_index(numpy.argmax(in_distance), both.shape)
    print(f"{traversal}: {(hit != expected).sum()} of {hit.size} pixels are hit by one only, {(in_distance > 1e-3).sum()} of "
          f"{both.sum()} differ by more than 1e-3; the worst is ({x}, {y}): {drawn[y, x]:.6g} drawn, {rendered[y, x]:.6g} "
          f"rendered, {in_depth[y, x]:.2g} in depth")
    assert expected.mean() > 0.1, "the view shows too little to compare"
    assert (hit == expected).mean() >= 0.999
    assert traversal in ("gdm", "slices") or ((in_depth <= 1e-3) | (in_distance <= 1e-3))[both].mean() >= 0.9999
    assert (in_distance[both] <= 1e-3).mean() >= 0.999


def probe_source(shader_source):
    """The fragment stage of probe.glsl with the library of the add-on whose core/shader_source this is."""
    library = [shader_source.resolve(shader_source.FOLDER / name) for name in ("lib/pixel.glsl", "host/textures.glsl")]
    return "".join([*library, (Path(__file__).parent / "probe.glsl").read_text()])


def check_probe(native, results, positions, directions, layout="nodes", precision="byte"):
    """Assert that `results` [n, 4] of probe.glsl are the lookups in C++ of chain_map."""
    tile_map = chain_map(native, layout, precision)
    gdm = tile_map.lookup(positions, directions)
    sdf = tile_map.sample_sdf(positions)
    assert gdm.max() > 0.3 and sdf.min() < 0.0, "the points see too little of the tile to tell"
    # Trilinear weights come from coordinates of up to 64 nodes, so they differ by 64 roundings, on node values of up to a
    # few tile widths; three of them make a node, and a GDM lookup adds up one product a term.
    tolerance = 3 * 64 * 2.0**-23 * 3
    numpy.testing.assert_allclose(results[:, 1], sdf, atol=tolerance)
    numpy.testing.assert_allclose(results[:, 0], gdm, atol=tolerance * tile_map.terms)


def probe_points(count, seed=1):
    """Random positions in and around texture space and directions, float32 [n, 3] each: on no grid, poles included."""
    random = numpy.random.default_rng(seed)
    positions = random.uniform((-2, -2, 0), (3, 3, 1), (count, 3))
    directions = random.normal(size=(count, 3))
    directions /= numpy.linalg.norm(directions, axis=1, keepdims=True)
    directions[:2] = (0, 0, 1), (0, 0, -1)
    positions[2:6] = (0, 0, 0), (1, 1, 1), (-1, 0.5, 0), (0.25, 0, 1)
    return positions.astype(numpy.float32), directions.astype(numpy.float32)
