"""What the native module says of a shell: seams that cut the pattern, and stretch."""

import numpy as np
import pytest


def cylinder(native, tiles, **options):
    """A closed band of 12 x 2 quads of radius 1 and height 1, unwrapped to so many tiles around."""
    around = 12
    angle = np.arange(around) / around * 2 * np.pi
    rings = [np.column_stack([np.cos(angle), np.sin(angle), np.full(around, z)]) for z in (0.0, 0.5, 1.0)]
    row, column = np.divmod(np.arange(2 * around), around)
    across = np.stack([column, column + 1, column + 1, column], axis=-1)
    up = np.stack([row, row, row + 1, row + 1], axis=-1)
    corners = up * around + across % around
    uvs = np.stack([across * tiles / around, up / 2], axis=-1)
    return native.build_shell(np.concatenate(rings).astype(np.float32), np.full(2 * around, 4, np.int32),
                              corners.astype(np.int32).ravel(), uvs.reshape(-1, 2).astype(np.float32), thickness=0.25,
                              **options)


def test_seams_lie_on_the_surface_and_their_tops_above(native):
    assert native.seams(cylinder(native, 6.0))["count"] == 0
    found = native.seams(cylinder(native, 6.5))
    assert found["count"] == 2
    assert found["edges"].shape == found["tops"].shape == (2, 2, 3)
    assert found["edges"].dtype == found["tops"].dtype == np.float32
    np.testing.assert_allclose(found["tops"] - found["edges"], np.broadcast_to([0.25, 0.0, 0.0], (2, 2, 3)), atol=1e-6)


def test_stretch_has_a_number_a_prism(native):
    shell = cylinder(native, 6.0)
    found = native.stretch(shell)
    assert found["rms"].shape == found["angle"].shape == (shell.prism_count,)
    assert found["rms"].dtype == found["angle"].dtype == np.float32
    assert 1.0 < found["total"] < 1.1 and found["infinite"] == 0
    np.testing.assert_allclose(found["angle"], np.pi / 2, atol=1e-5)
    # With the proportions found, given, it is the same; with others more.
    again = native.stretch(shell, aspect=found["aspect"], height=found["height"])
    assert again["total"] == pytest.approx(found["total"], rel=1e-12)
    assert native.stretch(shell, aspect=2 * found["aspect"], height=found["height"])["total"] > found["total"]


def test_relaxing_lowers_stretch(native, rng):
    def bulging(**options):
        shell = cylinder(native, 6.0, levels=2, **options)
        return native.stretch(shell)["total"], shell

    # The bulge: a factor of thickness that differs from vertex to vertex.
    factors = rng.uniform(0.3, 1.0, 36).astype(np.float32)
    before, plain = bulging(thickness_factors=factors)
    after, relaxed = bulging(thickness_factors=factors, relax=20)
    assert np.array_equal(plain.top_uvs, plain.uvs)
    assert np.abs(relaxed.top_uvs - relaxed.uvs).max() > 1e-3
    assert after < before


def test_any_number_marks_a_covered_face(native):
    whole = cylinder(native, 6.0).prism_count
    for mark in (1, 256, -1):
        covered = np.where(np.arange(24) < 12, mark, 0).astype(np.int32)
        assert cylinder(native, 6.0, covered=covered).prism_count == whole // 2


def test_other_things_are_no_shells(native):
    for function in (native.seams, native.stretch):
        with pytest.raises(TypeError):
            function(None)
    with pytest.raises(ValueError, match="height"):
        native.stretch(cylinder(native, 6.0), height=-1.0)
