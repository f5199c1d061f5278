"""Measures of accuracy: what is known of pictures made by hand comes out, and lengths turn as the prism map turns them."""

import accuracy_measures as measures
import numpy as np
import pytest


def picture(hit, distance=2.0, normal=(0.0, 0.0, 1.0), **more):
    hit = np.asarray(hit, np.uint8)
    return {"hit": hit, "distance": np.where(hit == 1, np.float32(distance), np.inf).astype(np.float32),
            "normal": np.broadcast_to(np.float32(normal), (*hit.shape, 3)), **more}


def everywhere(shape, pace=1.0, cut=False):
    return measures.Places(np.full(shape, pace), np.full(shape, cut))


def errors_of(seen, truth, pace=1.0, meets=None):
    shape = truth["hit"].shape
    return measures.compare(seen, truth, everywhere(shape, pace), np.ones(shape, bool) if meets is None else meets)


def test_silhouettes_of_known_masks():
    """Two bands of 6 rows, one of them moved by 2, in a shell of 9 rows."""
    truth, seen, meets = (np.zeros((12, 10), bool) for _ in range(3))
    truth[1:7], seen[3:9], meets[:9] = True, True, True
    figures = errors_of(picture(seen), picture(truth), meets=meets).figures()
    assert figures["iou"] == pytest.approx(4 / 8)
    assert figures["false_hits"] == figures["false_misses"] == pytest.approx(2 / 9)
    assert figures["misclassified"] == pytest.approx(4 / 9)


def test_depth_error_of_a_known_shift():
    """A tile width is half an object unit; hits lie 1/128 of an object unit behind the truth: one voxel of 1/64."""
    mask = np.ones((8, 8))
    errors = errors_of(picture(mask, 2.0 + 1 / 128), picture(mask, 2.0), pace=2.0)
    np.testing.assert_allclose(errors.depth, 1.0, rtol=1e-5)
    figures = errors_of(picture(mask, 2.0 - 1 / 128), picture(mask, 2.0), pace=2.0).figures()
    assert figures["depth_mean"] == pytest.approx(1.0, rel=1e-5) and figures["depth_bias"] == pytest.approx(-1.0, rel=1e-5)


def test_percentile_and_share_within_a_voxel():
    """Of 1000 pixels 15 are 3 voxels off, the others a quarter."""
    mask = np.ones((10, 100))
    distance = np.full((10, 100), 4.0 + 0.25 / 64, np.float32)
    distance.flat[:15] = 4.0 + 3 / 64
    figures = errors_of(picture(mask, distance), picture(mask, 4.0)).figures()
    assert figures["within_voxel"] == pytest.approx(0.985)
    assert figures["depth_p99"] == pytest.approx(3.0, rel=1e-4)
    assert figures["depth_mean"] == pytest.approx(0.25 * 0.985 + 3 * 0.015, rel=1e-4)


@pytest.mark.parametrize("degrees", [0.0, 1e-4, 2.0, 90.0, 180.0])
def test_angle_of_known_normals(degrees):
    turned = (np.sin(np.radians(degrees)), 0.0, np.cos(np.radians(degrees)))
    mask = np.ones((2, 3))
    figures = errors_of(picture(mask, normal=turned), picture(mask)).figures()
    assert figures["normal_mean"] == pytest.approx(degrees, abs=1e-5, rel=1e-5)


def test_cut_faces_are_apart():
    mask = np.ones((1, 4))
    normals = np.float32([[(0, 0, 1), (0, 0, 1), (1, 0, 0), (0, 0, -1)]])
    seen = picture(mask) | {"normal": normals}
    where = measures.Places(np.ones((1, 4)), np.array([[False, False, True, True]]))
    figures = measures.compare(seen, picture(mask), where, mask == 1).figures()
    assert figures["normal_surface"] == 0.0 and figures["normal_cut"] == pytest.approx(135.0)
    assert figures["normal_mean"] == pytest.approx(67.5) and figures["cut"] == 0.5


def test_fetches_are_of_the_rays_that_meet_the_shell():
    hit = np.zeros((4, 4))
    meets = np.zeros((4, 4), bool)
    meets[:2] = True
    fetches = np.where(meets, 7, 0)
    fetches[0, 0] = 15
    assert errors_of(picture(hit, fetches=fetches), picture(hit), meets=meets).figures()["fetches"] == 8.0


def test_pictures_together_are_one_picture():
    random = np.random.default_rng(4)
    seen, truth = (picture(random.random((6, 20)) < 0.7, random.uniform(1, 2, (6, 20)), fetches=np.full((6, 20), 3))
                   for _ in range(2))
    halves = [errors_of({k: v[part] for k, v in seen.items()}, {k: v[part] for k, v in truth.items()})
              for part in (slice(0, 2), slice(2, 6))]
    whole = errors_of(seen, truth).figures()
    for key, value in measures.pooled(halves).figures().items():
        assert value == pytest.approx(whole[key]), key


def random_prism(random):
    """A prism's table row [8, 4] that is bent, sheared and has other UVs at its top."""
    base = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)]) + random.uniform(-0.15, 0.15, (3, 3))
    points = np.concatenate([base, base * 1.3 + (0.1, 0.2, 0.6) + random.uniform(-0.1, 0.1, (3, 3))])
    uvs = np.tile([(0.3, 0.1), (1.4, 0.3), (0.2, 0.9)], (2, 1)) + random.uniform(-0.1, 0.1, (6, 2)) - 2.0
    rows = np.zeros((8, 4))
    rows[:6, :3], rows[:6, 3], rows[6:].flat[:6] = points, uvs[:, 0], uvs[:, 1]
    return rows


def mapped(row, q):
    """Object position and texture coordinates [3] each of prism coordinates (weights of corners 1 and 2, height)."""
    shares = np.array([1 - q[0] - q[1], q[0], q[1]])
    shares = np.concatenate([shares * (1 - q[2]), shares * q[2]])
    uvs = np.stack([row[:6, 3], row[6:].flat[:6]], -1)
    return shares @ row[:6, :3], np.append(shares @ uvs, q[2])


def test_pace_is_that_of_the_prism_map():
    """Against differences of the map itself, forward, so that nothing is inverted: 1e-6 apart in both coordinates."""
    random = np.random.default_rng(9)
    aspect, height, count = 1.25, 0.4, 40
    prisms = np.stack([random_prism(random) for _ in range(count)])
    located = {"hit": np.ones((1, count), np.uint8), "prism": np.arange(count)[None], "texture": np.zeros((1, count, 3))}
    directions, expected = np.zeros((1, count, 3)), np.zeros(count)
    for i, row in enumerate(prisms):
        q, step = np.array([*random.uniform(0.1, 0.4, 2), random.uniform(0.1, 0.9)]), 1e-6 * random.normal(size=3)
        (p0, t0), (p1, t1) = mapped(row, q - step), mapped(row, q + step)
        directions[0, i] = (p1 - p0) / np.linalg.norm(p1 - p0)
        located["texture"][0, i] = mapped(row, q)[1]
        expected[i] = np.linalg.norm((t1 - t0) * (1.0, aspect, height)) / np.linalg.norm(p1 - p0)
    where = measures.places(located, directions, prisms, height, aspect)
    np.testing.assert_allclose(where.pace[0], expected, rtol=1e-6)
    assert not where.cut.any()


def test_hits_on_the_sides_of_a_prism_are_cuts():
    row = random_prism(np.random.default_rng(2))
    inner, sides = (0.3, 0.2, 0.5), [(0.0, 0.4, 0.3), (0.3, 0.7, 0.5), (0.2, 0.2, 1.0), (0.2, 0.2, 0.0), (0.4, 0.0, 0.3)]
    texture = np.array([[mapped(row, np.array(q))[1] for q in (inner, *sides)]], np.float32)
    located = {"hit": np.ones((1, 6), np.uint8), "prism": np.zeros((1, 6), int), "texture": texture}
    where = measures.places(located, np.tile([0.0, 0.6, 0.8], (1, 6, 1)), row[None], 0.4, 1.0)
    assert where.cut.tolist() == [[False, True, True, True, True, True]]
