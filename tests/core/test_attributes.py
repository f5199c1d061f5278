"""Laws of attribute volumes: what is constant stays so, images lie where UVs put them, normals point out, nothing bleeds."""

from dataclasses import replace

import numpy as np
import pytest
from core import attributes
from core.tile_surface import TileSurface

RESOLUTION = (16, 12, 9)
CENTER = np.array([0.45, 0.5, 0.26])


def ball(radius=0.2, rings=24, segments=32):
    """A ball within the tile 1 x 1 x 0.5, with smooth normals."""
    polar = np.arange(1, rings) / rings * np.pi
    around = np.arange(segments) / segments * 2 * np.pi
    across = np.stack([np.outer(np.sin(polar), np.cos(around)), np.outer(np.sin(polar), np.sin(around)),
                       np.outer(np.cos(polar), np.ones(segments))], axis=-1).reshape(-1, 3)
    out = np.concatenate([across, [[0, 0, 1], [0, 0, -1]]])
    ring, segment = np.arange(rings - 1)[:, None] * segments, np.arange(segments)[None]
    beside = (segment + 1) % segments
    a, b, c, d = ring[:-1] + segment, ring[1:] + segment, ring[1:] + beside, ring[:-1] + beside
    top, bottom = np.full_like(segment, len(out) - 2), np.full_like(segment, len(out) - 1)
    triangles = np.concatenate([np.stack(np.broadcast_arrays(*corners), -1).reshape(-1, 3) for corners in (
        (a, b, c), (a, c, d), (top, segment, beside), (bottom, ring[-1] + beside, ring[-1] + segment))]).astype(np.int32)
    return TileSurface("Ball", CENTER + radius * out, triangles, 0.5, normals=out[triangles].astype(np.float32))


def floor():
    """The solid below z = 0.25, in 8 x 8 quads with UVs (x, y) and normals up."""
    x, y = np.meshgrid(np.arange(9) / 8, np.arange(9) / 8)
    positions = np.column_stack([x.ravel(), y.ravel(), np.full(81, 0.25)])
    corner = (np.arange(8)[:, None] * 9 + np.arange(8)).ravel()
    triangles = np.concatenate([np.column_stack([corner, corner + 1, corner + 10]),
                                np.column_stack([corner, corner + 10, corner + 9])]).astype(np.int32)
    return TileSurface("Floor", positions, triangles, 0.5, uvs=positions[triangles][..., :2].astype(np.float32))


def material(color=(1.0, 1.0, 1.0), roughness=0.5, metallic=0.0, image=None):
    return {"color": color, "roughness": roughness, "metallic": metallic, "image": image}


def with_materials(surface, *materials, indices=None):
    indices = np.zeros(len(surface.triangles), np.int32) if indices is None else indices
    return replace(surface, materials=materials, material_indices=indices)


@pytest.fixture
def volumes(native):
    def volumes(surface, resolution=RESOLUTION):
        sample = native.Sample(surface.positions, surface.triangles, height=surface.height, aspect=surface.aspect)
        made = attributes.volumes(surface, native.closest_points(sample, resolution=resolution))
        shape = tuple(reversed(resolution))
        assert {name: (values.shape, values.dtype) for name, values in made.items()} == {
            "color": ((*shape, 3), np.float32), "surface": ((*shape, 2), np.float32), "normal": ((*shape, 3), np.float32)}
        return made
    return volumes


def interpolated(volume, places):
    """Trilinear [n, k] of a volume [nz, ny, nx, k] at places [n, 3] in [0, 1], as a texture's filtering does it."""
    shape = np.array(volume.shape[:3])[::-1]
    node = places * (shape - [0, 0, 1])
    low = np.minimum(np.floor(node).astype(int), shape - [1, 1, 2])
    share = node - low
    total = 0.0
    for corner in np.ndindex(2, 2, 2):
        x, y, z = ((low + corner) % [shape[0], shape[1], shape[2] + 1]).T
        total = total + volume[z, y, x] * np.where(corner, share, 1.0 - share).prod(axis=1)[:, None]
    return total


def test_constants_stay_constant(volumes):
    made = volumes(with_materials(ball(), material((0.25, 0.5, 0.75), 0.3, 1.0)))
    np.testing.assert_array_equal(made["color"], np.broadcast_to(np.float32([0.25, 0.5, 0.75]), made["color"].shape))
    np.testing.assert_array_equal(made["surface"], np.broadcast_to(np.float32([0.3, 1.0]), made["surface"].shape))


def test_a_surface_without_materials_is_gray(volumes):
    made = volumes(ball())
    np.testing.assert_array_equal(made["color"], np.full_like(made["color"], 0.8))
    np.testing.assert_array_equal(made["surface"], np.broadcast_to(np.float32([0.5, 0.0]), made["surface"].shape))


@pytest.mark.parametrize("outward", (True, False))
def test_smooth_normals_of_a_ball_are_radial(volumes, native, outward):
    """Whichever way its faces and its corners' normals point."""
    surface = ball()
    if not outward:
        triangles = np.ascontiguousarray(surface.triangles[:, ::-1])
        surface = replace(surface, triangles=triangles, normals=-surface.normals[:, ::-1])
    points = native.closest_points(native.Sample(surface.positions, surface.triangles, height=0.5), resolution=RESOLUTION)
    weights = np.concatenate([1.0 - points["weights"].sum(axis=-1, keepdims=True), points["weights"]], axis=-1)
    place = (surface.positions[surface.triangles[points["triangles"]]] * weights[..., None]).sum(axis=-2)
    radial = (place - CENTER) / np.linalg.norm(place - CENTER, axis=-1, keepdims=True)
    # Linear between the corners' normals as between the corners, and then of unit length.
    np.testing.assert_allclose(volumes(surface)["normal"], radial, atol=1e-5)


def test_without_normals_those_of_the_triangles(volumes):
    made = volumes(floor())
    np.testing.assert_allclose(made["normal"], np.broadcast_to([0, 0, 1], made["normal"].shape), atol=1e-6)
    flat, smooth = volumes(replace(ball(), normals=None))["normal"], volumes(ball())["normal"]
    cosine = (flat * smooth).sum(axis=-1)
    assert 0.98 < cosine.min() < 0.999


def test_each_triangle_has_its_material(volumes):
    surface = ball()
    upper = (surface.positions[surface.triangles].mean(axis=1)[:, 2] > CENTER[2]).astype(np.int32)
    made = volumes(with_materials(surface, material((1, 0, 0), 0.1, 0.0), material((0, 0, 1), 0.9, 1.0), indices=upper))
    z = np.arange(RESOLUTION[2]) / (RESOLUTION[2] - 1) * 0.5
    for layer in np.flatnonzero(np.abs(z - CENTER[2]) > 0.05):
        above = z[layer] > CENTER[2]
        np.testing.assert_array_equal(made["color"][layer], np.broadcast_to([0, 0, 1] if above else [1, 0, 0], (12, 16, 3)))
        expected = np.float32([0.9, 1.0] if above else [0.1, 0.0])
        np.testing.assert_array_equal(made["surface"][layer], np.broadcast_to(expected, (12, 16, 2)))


def test_a_checker_lies_where_uvs_put_it(volumes):
    """8 x 8 squares: nodes in their middles have their colors, whatever the number of pixels."""
    row, column = np.mgrid[:8, :8]
    squares = np.where(((row + column) % 2 == 0)[..., None], [0.9, 0.1, 0.2], [0.1, 0.8, 0.3]).astype(np.float32)
    for pixels in (2, 4, 8, 64):
        image = squares.repeat(pixels, axis=0).repeat(pixels, axis=1)
        color = volumes(with_materials(floor(), material(image=image)), (16, 16, 3))["color"]
        for layer in color:
            np.testing.assert_allclose(layer[1::2, 1::2], squares, atol=1e-6)


def test_images_repeat(volumes, rng):
    image = rng.random((4, 4, 3)).astype(np.float32)
    surface = with_materials(floor(), material(image=image))
    far = replace(surface, uvs=surface.uvs + np.float32([3.0, -2.0]))
    np.testing.assert_allclose(volumes(far)["color"], volumes(surface)["color"], atol=1e-5)


def test_pixels_finer_than_voxels_are_averaged(volumes, rng):
    """64 pixels a voxel: what is left of noise is a 64th, not what single pixels happen to be."""
    image = rng.random((1024, 1024, 3)).astype(np.float32)
    color = volumes(with_materials(floor(), material(image=image)), (16, 16, 3))["color"]
    np.testing.assert_allclose(color, 0.5, atol=5 / 64 * 0.29)


def test_an_image_takes_the_place_of_the_plain_color(volumes):
    image = np.full((2, 2, 3), 0.5, np.float32)
    surface = with_materials(floor(), material((0.1, 0.2, 0.3), image=image))
    assert (volumes(surface)["color"] == 0.5).all()
    painted = replace(surface, colors=np.full((len(surface.triangles), 3, 3), [0.5, 1.0, 0.25], np.float32))
    np.testing.assert_allclose(volumes(painted)["color"], np.broadcast_to([0.25, 0.5, 0.125], (9, 12, 16, 3)), atol=1e-6)


def test_an_image_without_uvs_is_its_mean(volumes):
    image = np.linspace(0.0, 1.0, 12, dtype=np.float32).reshape(2, 2, 3)
    color = volumes(with_materials(ball(), material(image=image)))["color"]
    np.testing.assert_allclose(color, np.broadcast_to(image.mean(axis=(0, 1)), color.shape), atol=1e-6)


def test_corner_colors_are_interpolated(volumes):
    """Colors (x, y, 1 - x) of the floor's corners are so at its nodes, but for the border, where x falls back to 0."""
    surface = floor()
    x, y = surface.positions[surface.triangles][..., 0], surface.positions[surface.triangles][..., 1]
    made = volumes(replace(with_materials(surface, material()), colors=np.stack([x, y, 1.0 - x], -1).astype(np.float32)))
    node_x, node_y = np.meshgrid(np.arange(16) / 16, np.arange(12) / 12)
    expected = np.stack([node_x, node_y, 1.0 - node_x], axis=-1)
    for layer in made["color"]:
        np.testing.assert_allclose(layer[1:, 1:], expected[1:, 1:], atol=1e-6)


def test_nothing_bleeds_in_between_nodes(volumes, rng):
    """Interpolated anywhere, a ball of two colors has colors between those two and no others, inside it and far away."""
    surface = ball()
    side = (surface.positions[surface.triangles].mean(axis=1)[:, 0] > CENTER[0]).astype(np.int32)
    one, other = np.array([0.9, 0.2, 0.4]), np.array([0.3, 0.6, 0.8])
    made = volumes(with_materials(surface, material(tuple(one)), material(tuple(other)), indices=side))
    color = interpolated(made["color"], rng.random((20000, 3)))
    share = (color - one) @ (other - one) / ((other - one) @ (other - one))
    assert share.min() > -1e-6 and share.max() < 1 + 1e-6
    np.testing.assert_allclose(color, one + share[:, None] * (other - one), atol=1e-6)
    assert share.min() < 0.01 and share.max() > 0.99


def test_work_ends_where_the_check_raises(native):
    surface = ball()
    sample = native.Sample(surface.positions, surface.triangles, height=0.5)
    points = native.closest_points(sample, resolution=(64, 64, 33))
    calls = []

    def check():
        calls.append(None)
        if len(calls) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        attributes.volumes(surface, points, check)


def test_a_map_keeps_them(volumes, native, tmp_path):
    surface = with_materials(ball(), material((0.25, 0.5, 0.75), 0.25, 1.0))
    made = volumes(surface)
    sample = native.Sample(surface.positions, surface.triangles, height=0.5)
    gdm = native.bake_gdm(sample, resolution=(4, 4, 3), directions=(4, 4))
    facets = native.bake_facets(sample, cells=6)
    path = str(tmp_path / "ball.exr")
    native.compress(gdm, terms=2, facets=facets, attributes=made).save(path)
    loaded = native.load(path)
    assert loaded.facet_cells == facets.cells
    np.testing.assert_array_equal(loaded.facets.view(np.uint32), facets.texels.view(np.uint32))
    for name, values in made.items():
        np.testing.assert_array_equal(loaded.attributes[name], values.astype(np.float16))


def test_what_compress_can_not_take_is_refused(volumes, native):
    surface = ball()
    sample = native.Sample(surface.positions, surface.triangles, height=0.5)
    gdm = native.bake_gdm(sample, resolution=(4, 4, 3), directions=(4, 4))
    made = volumes(surface)
    low = native.bake_facets(native.Sample(surface.positions, surface.triangles, height=0.49), cells=4)
    for bad, words in (
            ({"facets": low}, "one sample"), ({"facets": made}, "bake_facets"), ({"attributes": []}, "dict"),
            ({"attributes": {**made, "normal": made["color"][:3]}}, "normal"),
            ({"attributes": {**made, "color": made["surface"]}}, "color"),
            ({"attributes": {**made, "color": made["color"] * np.nan}}, "not finite"),
            ({"attributes": {"color": made["color"]}}, "surface")):
        with pytest.raises(ValueError, match=words):
            native.compress(gdm, terms=2, **bad)
    assert native.compress(gdm, terms=2).facets is None and native.compress(gdm, terms=2).attributes is None
