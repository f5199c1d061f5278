"""Laws of cutting and mirroring meshes: nothing is lost or added, what was closed stays so, halves are images."""

import numpy as np
import pytest
from core import clipping, mirrored_tile
from surfaces import area_and_volume, ball, face_normals, sample, sample_tile, sdf

NAMES = ("weave", "grid", "chain", "squama", "bark", "fur")


def soup(rng, count=400):
    return rng.random((count * 3, 3)) * 2 - 0.5, np.arange(count * 3).reshape(-1, 3)


def areas(positions, triangles):
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def test_both_sides_of_a_cut_are_the_whole(rng):
    """Triangle by triangle, the areas of its parts add up to its own."""
    positions, triangles = soup(rng)
    parts = [clipping.cut(clipping.whole(positions, triangles), 0, 0.4, side) for side in (1, -1)]
    assert (parts[0].positions[parts[0].triangles][..., 0] >= 0.4).all()
    assert (parts[1].positions[parts[1].triangles][..., 0] <= 0.4).all()
    total = sum(np.bincount(p.source, areas(p.positions, p.triangles), len(triangles)) for p in parts)
    np.testing.assert_allclose(total, areas(positions, triangles), atol=1e-5)


def test_weights_say_where_corners_came_from(rng):
    """After two cuts a corner is still the mean, by its weights, of the corners of the triangle it is part of."""
    positions, triangles = soup(rng)
    parts = clipping.cut(clipping.cut(clipping.whole(positions, triangles), 0, 0.4, 1), 1, 0.6, -1)
    assert len(parts.triangles) > 200
    np.testing.assert_allclose(parts.weights.sum(axis=2), 1.0)
    expected = np.einsum("mij,mjk->mik", parts.weights, positions[triangles[parts.source]])
    np.testing.assert_allclose(parts.positions[parts.triangles], expected, atol=3 * clipping.SNAP)


def test_normals_of_parts_stay(rng):
    positions, triangles = soup(rng)
    parts = clipping.cut(clipping.whole(positions, triangles), 2, 0.3, 1)

    def unit(points, faces):
        a, b, c = np.moveaxis(points[faces], 1, 0)
        cross = np.cross(b - a, c - a)
        return cross / np.linalg.norm(cross, axis=1, keepdims=True)
    large = areas(parts.positions, parts.triangles) > 1e-4
    turned = (unit(parts.positions, parts.triangles) * unit(positions, triangles)[parts.source]).sum(axis=1)
    assert large.sum() > 200 and turned[large].min() > 0.99


def test_corners_in_the_plane_make_no_slivers():
    """A square whose diagonal and one side lie in planes: cut there it is one of its halves, or itself, or nothing."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    turned = square @ np.array([[1, 1, 0], [-1, 1, 0], [0, 0, 1]])  # its diagonal from corner 0 to 2 on x = 0
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    for axis, points, limit, count in ((0, square, 0.0, 2), (0, square, 1.0, 0), (0, turned, 0.0, 1)):
        assert len(clipping.cut(clipping.whole(points, triangles), axis, limit, 1).triangles) == count


def test_a_wall_in_the_plane_is_dropped():
    wall = np.array([[0.4, 0, 0], [0.4, 1, 0], [0.4, 0, 1]])
    for side in (1, -1):
        assert len(clipping.cut(clipping.whole(wall, np.array([[0, 1, 2]])), 0, 0.4, side).triangles) == 0


@pytest.mark.parametrize("name", NAMES)
def test_mirrored_tiles_are_closed(name):
    tile = sample_tile(name)
    made = sample(mirrored_tile.mirrored(tile))
    assert not any("closed" in notice for notice in made.notices)
    assert not any("turned over" in notice for notice in made.notices), made.notices


@pytest.mark.parametrize("center", [(0.5, 0.6, 0.25), (0.9, 0.6, 0.25), (0.05, 1.15, 0.25), (1.0, 0.0, 0.25)])
def test_a_balls_mirror_images_are_whole(center):
    """A ball in the middle, over a side, over an edge of the box, and on one: what is in the box is solid, in images too."""
    tile = ball(center, aspect=1.2)
    made = mirrored_tile.mirrored(tile)
    assert made.height == tile.height / 2 and made.aspect == tile.aspect
    parts = sdf(made, (32, 40, 9))
    x, y, z = (np.arange(32) / 16, 1.2 * np.arange(40) / 20, np.arange(9) / 16)
    x, y = np.minimum(x, 2 - x), np.minimum(y, 2.4 - y)
    truth = np.sqrt((x - center[0])[None, None, :] ** 2 + (y - center[1])[None, :, None] ** 2
                    + (z - center[2])[:, None, None] ** 2) - 0.2
    clear = np.abs(truth) > 0.005
    np.testing.assert_array_equal(parts[clear] < 0, truth[clear] < 0)


def test_the_mirrored_field_is_its_own_image():
    values = sdf(mirrored_tile.mirrored(sample_tile("chain")), (32, 32, 9))
    for axis in (1, 2):
        # Node 0 is a mirror, so that node i is the image of node -i.
        np.testing.assert_allclose(values, np.roll(np.flip(values, axis), 1, axis), atol=2e-5)


def test_mirroring_makes_any_border_match():
    """Chain mail cut through at a third of its period: a period that its solid does not have."""
    tile = sample_tile("chain")
    third = tile.__class__(**{**vars(tile), "positions": tile.positions * [3.0, 3.0, 3.0], "height": tile.height * 3.0})
    made = sample(mirrored_tile.mirrored(third))
    assert made.notices == ()


def test_solids_are_four_times_as_many_and_an_eighth_as_large():
    tile = ball((0.5, 0.6, 0.25), aspect=1.2)
    area, volume = area_and_volume(tile)
    assert area_and_volume(mirrored_tile.mirrored(tile)) == pytest.approx((area, volume / 2))


def test_attributes_are_mirrored_too():
    """Colors were places: they still are, of the copy that is looked at in the mirror; materials and normals too."""
    made = mirrored_tile.mirrored(ball((0.9, 0.6, 0.25), aspect=1.2))
    corners = 2 * made.positions[made.triangles]
    corners[..., 0] = np.minimum(corners[..., 0], 2.0 - corners[..., 0])
    corners[..., 1] = np.minimum(corners[..., 1], 2.4 - corners[..., 1])
    np.testing.assert_allclose(made.colors, corners, atol=3e-5)
    assert ((corners[..., 2].mean(axis=1) > 0.25) == (made.material_indices == 1)).all()
    facing = np.einsum("mck,mk->mc", made.normals, face_normals(made))
    assert facing.min() > 0.9 and np.abs(np.linalg.norm(made.normals, axis=2) - 1.0).max() < 1e-5


def test_a_sheet_over_the_tile_stays_one():
    """Terrain that ends beside the box: solid below, everywhere."""
    from core import height_field
    from core.tile_options import TileOptions
    field = height_field.surface_of(np.linspace(0.2, 0.8, 80, dtype=np.float32).reshape(8, 10), TileOptions())
    grown = field.__class__(**{**vars(field), "positions": field.positions * [1.3, 1.3, 1.0] - [0.1, 0.1, 0.0]})
    made = mirrored_tile.mirrored(grown)
    assert (sdf(made, (16, 16, 5))[1] < 0).all()


def test_what_lies_wholly_beside_the_box_is_refused():
    with pytest.raises(ValueError, match='"Ball"'):
        mirrored_tile.mirrored(ball((1.5, 0.5, 0.25)))
