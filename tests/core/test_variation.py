"""Laws of variation: no seam, no tear, no fold, nothing moved up or down; and none at all is plain repetition."""

import numpy as np
import pytest
from core import refining, variation
from surfaces import area_and_volume, ball, face_normals, sample, sample_tile, sdf

NAMES = ("weave", "grid", "chain", "squama", "bark", "fur")
CASES = [(2, 1.0, 0), (3, 0.7, 1), (5, 1.3, 2), (8, 0.4, 3), (16, 1.0, 4)]


@pytest.fixture(params=CASES, ids=lambda case: f"{case[0]} copies, aspect {case[1]}")
def shape(request):
    copies, aspect, seed = request.param
    return variation.displacement(copies, aspect, 1.0, seed)


def places(rng, shape, count=4000):
    return rng.random((count, 2)) * shape.copies * np.array([1.0, shape.aspect])


def test_it_never_folds(shape, rng):
    """Any two places, near or far, stay apart: the displacement is a contraction, which with the identity is a bijection."""
    p, q = places(rng, shape), places(rng, shape)
    q[::2] = p[::2] + rng.normal(size=(2000, 2)) * np.exp(rng.uniform(-9, 0, (2000, 1)))
    moved = np.linalg.norm(shape.at(p)[0] - shape.at(q)[0], axis=1) / np.linalg.norm(p - q, axis=1)
    assert moved.max() <= variation.MOST_STRETCH
    assert moved.max() > 0.3 * variation.MOST_STRETCH, "and it is not timid either"


def test_slopes_are_the_derivatives(shape, rng):
    p, step = places(rng, shape, 100), 1e-6
    slopes = shape.at(p)[1]
    for j in range(2):
        offset = step * np.eye(2)[j]
        numeric = (shape.at(p + offset)[0] - shape.at(p - offset)[0]) / (2 * step)
        np.testing.assert_allclose(slopes[:, :, j], numeric, atol=1e-6)


def test_every_place_is_met(shape, rng):
    """The contraction's own iteration finds whence each place comes."""
    target = places(rng, shape, 200)
    p = target.copy()
    for _ in range(60):
        p = target - shape.at(p)[0]
    np.testing.assert_allclose(p + shape.at(p)[0], target, atol=1e-9)


def test_it_is_periodic_over_all_copies_and_not_over_one(shape, rng):
    p = places(rng, shape, 100)
    width = np.array([shape.copies, shape.copies * shape.aspect])
    np.testing.assert_allclose(shape.at(p)[0], shape.at(p + width * [1, -2])[0], atol=1e-9)
    for step in ([1.0, 0.0], [0.0, shape.aspect], [1.0, shape.aspect]):
        apart = np.linalg.norm(shape.at(p)[0] - shape.at(p + step)[0], axis=1)
        assert apart.max() > 0.05, "of a tile's width"


def test_borders_move_alike_to_the_bit(shape):
    v = np.arange(64) / 64 * shape.copies * shape.aspect
    left, right = (np.column_stack([np.full(64, x), v]) for x in (0.0, float(shape.copies)))
    np.testing.assert_array_equal(shape.at(left)[0], shape.at(right)[0])


def test_seeds_differ_and_repeat(rng):
    first, again, other = (variation.displacement(4, 1.0, 0.5, seed) for seed in (1, 1, 2))
    p = places(rng, first, 50)
    np.testing.assert_array_equal(first.at(p)[0], again.at(p)[0])
    assert np.abs(first.at(p)[0] - other.at(p)[0]).max() > 0.02


@pytest.mark.parametrize("name", ["chain", "bark"])
def test_none_is_plain_repetition(name):
    tile = sample_tile(name)
    made = variation.varied(tile, 2, 0.0, 0)
    assert (made.height, made.aspect) == (tile.height / 2, tile.aspect)
    one = sdf(tile, (16, 16, 9))
    np.testing.assert_allclose(sdf(made, (32, 32, 9)), np.tile(one, (1, 2, 2)) / 2, atol=1e-5)


def test_one_copy_is_the_tile_itself():
    tile = ball()
    assert variation.varied(tile, 1, 1.0, 5) is tile


@pytest.mark.parametrize("name", NAMES)
def test_varied_tiles_are_closed_and_face_outward(name):
    made = sample(variation.varied(sample_tile(name), 3, 1.0, 7))
    assert made.notices == () and made.clipped_triangles == 0
    plain = sample(variation.varied(sample_tile(name), 3, 0.0, 7))
    assert [n.split(" ", 1)[1] for n in made.notices] == [n.split(" ", 1)[1] for n in plain.notices]


def test_heights_stay_and_copies_differ():
    tile = sample_tile("squama")
    made = variation.varied(tile, 3, 1.0, 7)
    low, high = tile.positions[:, 2].min(), tile.positions[:, 2].max()
    assert (made.positions[:, 2].min() * 3, made.positions[:, 2].max() * 3) == pytest.approx((low, high))
    copies = 3 * made.positions.reshape(9, -1, 3)
    offsets = copies - copies[:1]
    shape_of_each = offsets - offsets.mean(axis=1, keepdims=True)
    assert (np.abs(shape_of_each[1:]).max(axis=(1, 2)) > 0.02).all()


def test_what_lies_over_what_stays(rng):
    """Where the bent mail is solid is where the plain mail is, once the way back is found for each node."""
    tile, copies = sample_tile("chain", 1.0), 2
    made = variation.varied(tile, copies, 1.0, 3)
    nodes = 48
    bent = sdf(made, (nodes, nodes, 9)) * copies
    shape = variation.displacement(copies, tile.aspect, 1.0, 3)
    x, y = np.meshgrid(np.arange(nodes) / nodes * copies, np.arange(nodes) / nodes * copies * tile.aspect)
    target = np.column_stack([x.ravel(), y.ravel()])
    p = target.copy()
    for _ in range(60):
        p = target - shape.at(p)[0]
    fine = sdf(tile, (64, 64, 9))
    i, j = np.floor(p / [1.0, tile.aspect] % 1.0 * 64 + 0.5).astype(int).T % 64
    plain = fine[:, j, i].reshape(9, nodes, nodes)
    clear = np.abs(plain) > 0.02  # a node of the fine grid lies up to 0.012 beside
    assert (plain[clear] < 0).sum() > 500
    np.testing.assert_array_equal(bent[clear] < 0, plain[clear] < 0)


def test_attributes_come_along():
    tile = ball()
    made = variation.varied(tile, 2, 1.0, 0)
    refined = refining.refined(tile, 1 / 16)
    np.testing.assert_array_equal(made.colors, np.tile(refined.colors, (4, 1, 1)))
    np.testing.assert_array_equal(made.material_indices, np.tile(refined.material_indices, 4))
    # The analytic normals are those of the bent faces, up to their own size.
    assert np.einsum("mck,mk->mc", made.normals, face_normals(made)).min() > 0.9


@pytest.mark.parametrize("copies, amount", [(0, 0.5), (17, 0.5), (2, -0.1), (2, 1.1), (2, float("nan"))])
def test_what_is_out_of_range_is_refused(copies, amount):
    with pytest.raises(ValueError, match="copies"):
        variation.varied(ball(), copies, amount, 0)


def test_more_copies_than_memory_are_refused(monkeypatch):
    monkeypatch.setattr(variation, "_MOST_TRIANGLES", 5000)
    with pytest.raises(ValueError, match="fewer copies"):
        variation.varied(ball(), 4, 0.0, 0)


# --- long edges


def block(low=(0.2, 0.3, 0.1), high=(0.9, 0.8, 0.3)):
    """A box of 12 triangles, colored by place."""
    corner = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.int32)
    positions = np.asarray(low) + corner * (np.asarray(high) - low)
    return ball().__class__("Block", positions, triangles, 0.5, colors=positions[triangles].astype(np.float32))


def test_refined_is_the_same_solid_of_short_edges():
    tile = block()
    made = refining.refined(tile, 1 / 16)
    assert area_and_volume(made) == pytest.approx(area_and_volume(tile))
    corners = made.positions[made.triangles]
    edges = corners - np.roll(corners, 1, axis=1)
    assert np.linalg.norm(edges[..., :2], axis=2).max() <= 1 / 16
    np.testing.assert_allclose(made.colors, corners, atol=1e-6)
    assert sample(made).notices == ()
    np.testing.assert_allclose(face_normals(made), np.round(face_normals(made)), atol=1e-9)


def test_refined_tiles_are_closed_over_their_borders():
    """A slab over the whole tile, of two triangles a side, that hang together across the borders alone."""
    corner = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    positions = np.vstack([np.column_stack([corner, np.full(4, z)]) for z in (0.1, 0.3)])
    triangles = np.array([[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]], np.int32)
    slab = ball().__class__("Slab", positions, triangles, 0.5)
    assert sample(refining.refined(slab, 0.07)).notices == ()
    assert sample(variation.varied(slab, 2, 1.0, 0)).notices == ()


def test_short_edges_are_left_alone():
    tile = sample_tile("chain", 1.0)
    assert refining.refined(tile, 0.5) is tile
