"""Laws of arrays made periodic: nothing jumps at a border that does not jump inside, and nothing leaves its range."""

import numpy as np
import pytest
from core import periodic


def jumps(values, axis):
    """(the greatest step inside, the greatest step over the border)."""
    steps = np.abs(np.diff(values, axis=axis))
    over = np.abs(np.take(values, 0, axis=axis) - np.take(values, -1, axis=axis))
    return steps.max(), over.max()


def slope(ny=40, nx=56):
    """What jumps at both borders by all it has: a ramp with some relief on it."""
    y, x = np.meshgrid(np.arange(ny) / ny, np.arange(nx) / nx, indexing="ij")
    return (0.6 * x + 0.4 * y + 0.05 * np.sin(17 * x + 5 * y)).astype(np.float32)


def test_the_ramp_itself_is_not_periodic():
    inside, over = jumps(slope(), 1)
    assert over > 10 * inside


def test_mirrored_continues_into_itself():
    values = slope()
    made = periodic.mirrored(values)
    assert made.shape == (80, 112)
    np.testing.assert_array_equal(made[:40, :56], values)
    np.testing.assert_array_equal(made, made[::-1, ::-1])
    np.testing.assert_array_equal(made, made[:, ::-1])
    for axis in (0, 1):
        inside, over = jumps(made, axis)
        assert over == 0.0 < inside


@pytest.mark.parametrize("width", [0.05, 0.25, 0.45])
@pytest.mark.parametrize("shape", [(40, 56), (33, 47)])
def test_blended_jumps_nowhere(width, shape):
    values = slope(*shape)
    made = periodic.blended(values, width)
    assert made.shape == shape
    for axis in (0, 1):
        inside, over = jumps(made, axis)
        assert over <= inside
        # The greatest step of all that is added up, and the fade's own slope times what it fades between.
        assert inside <= jumps(values, axis)[0] + 1.5 / (width * shape[axis] - 1) * np.ptp(values)
    assert values.min() <= made.min() and made.max() <= values.max()


def test_blended_leaves_the_middle_alone():
    values = slope()
    np.testing.assert_array_equal(periodic.blended(values, 0.25)[10:30, 14:42], values[10:30, 14:42])


@pytest.mark.parametrize("shape", [(1, 1), (2, 3), (4, 4), (5, 2, 7)])
def test_constants_stay(shape):
    for made in (periodic.mirrored(np.full(shape, 0.7, np.float32)), periodic.blended(np.full(shape, 0.7, np.float32), 0.3)):
        np.testing.assert_allclose(made, 0.7, rtol=1e-6)


def test_slices_of_a_grid_are_blended_alike(rng):
    values = rng.random((3, 12, 16)).astype(np.float32)
    for name, width in (("mirrored", ()), ("blended", (0.3,))):
        made = getattr(periodic, name)(values, *width)
        for k in range(3):
            np.testing.assert_array_equal(made[k], getattr(periodic, name)(values[k], *width))


@pytest.mark.parametrize("width", [0.0, -0.1, 0.5, float("nan")])
def test_a_blend_that_leaves_no_middle_is_refused(width):
    with pytest.raises(ValueError, match="width"):
        periodic.blended(slope(), width)
