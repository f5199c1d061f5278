"""Laws of grids as tiles: the surface is where the values say, whichever side is solid; a file is read or refused."""

import pickle

import numpy as np
import pytest
from core import grid_file, grid_tile
from core.tile_options import TileOptions
from surfaces import area_and_volume, sdf

HEIGHT, ASPECT, CENTER, RADIUS = 0.75, 1.25, np.array([0.9, 0.6, 0.4]), 0.25


def distance(nz, ny, nx):
    """To a ball that crosses the border u = 1, float64 [nz, ny, nx]."""
    z, y, x = np.meshgrid(np.arange(nz) / (nz - 1) * HEIGHT, np.arange(ny) / ny * ASPECT, np.arange(nx) / nx, indexing="ij")
    away = np.stack([x, y, z], axis=-1) - CENTER
    away[..., 0] -= np.round(away[..., 0])
    away[..., 1] -= ASPECT * np.round(away[..., 1] / ASPECT)
    return np.linalg.norm(away, axis=-1) - RADIUS


def test_a_level_set_of_a_ball_is_the_ball():
    surface = grid_tile.surface_of(distance(49, 80, 64), 0.0, HEIGHT, ASPECT, inside='below')
    away = surface.positions - CENTER
    away[:, 0] -= np.round(away[:, 0])
    np.testing.assert_allclose(np.linalg.norm(away, axis=1), RADIUS, atol=5e-4)
    area, volume = area_and_volume(surface)
    assert area == pytest.approx(4 * np.pi * RADIUS**2, rel=0.01)
    assert volume == pytest.approx(4 / 3 * np.pi * RADIUS**3, rel=0.01)


def test_its_distance_field_is_the_balls():
    values = sdf(grid_tile.surface_of(distance(49, 80, 64), 0.0, HEIGHT, ASPECT, inside='below'), (16, 20, 13))
    truth = distance(13, 20, 16)
    near = np.abs(truth) < 0.2
    np.testing.assert_allclose(values[near], truth[near], atol=2e-3)


def test_density_above_is_distance_below():
    below = grid_tile.surface_of(distance(13, 20, 16), 0.03, HEIGHT, ASPECT, inside='below')
    above = grid_tile.surface_of(-distance(13, 20, 16), -0.03, HEIGHT, ASPECT)
    np.testing.assert_array_equal(below.positions, above.positions)
    np.testing.assert_array_equal(below.triangles, above.triangles)


def test_voxels_are_cubes_unless_told():
    surface = grid_tile.surface_of(distance(13, 20, 16), 0.0, inside='below')
    assert (surface.height, surface.aspect) == (12 / 16, 20 / 16)


@pytest.mark.parametrize("kind", ["u1", "i2", "f2", "f8", "?"])
def test_numbers_of_any_kind(kind):
    values = (distance(13, 20, 16) < 0.0).astype(kind)
    surface = grid_tile.surface_of(values, 0.5, HEIGHT, ASPECT)
    expected = grid_tile.surface_of(values.astype(np.float32), 0.5, HEIGHT, ASPECT)
    np.testing.assert_array_equal(surface.positions, expected.positions)


def sponge():
    """A level set, float64 [17, 32, 32], whose waves do not fit the tile: its borders do not match."""
    z, y, x = np.meshgrid(np.arange(17) / 32, np.arange(32) / 32, np.arange(32) / 32, indexing="ij")
    p, q, r = 8.3 * x + 0.4, 7.9 * y + 1.1, 9.0 * z
    return (np.sin(p) * np.cos(q) + np.sin(q) * np.cos(r) + np.sin(r) * np.cos(p)) / 20


@pytest.mark.parametrize("periodic, width", [('MIRROR', 2), ('BLEND', 1)])
def test_a_sponge_is_made_periodic(periodic, width):
    """No wall of the solid stands on a border any more: there are about as many borders of the solid there as anywhere."""
    def walls(surface):
        inside = sdf(surface, (32 * width, 32 * width, 9)) < 0
        changes = [(inside != np.roll(inside, 1, axis=axis)).sum(axis=(0, 3 - axis)) for axis in (1, 2)]
        return max(change[0] / change.mean() for change in changes)

    assert walls(grid_tile.surface_of(sponge(), 0.0, inside='below')) > 2.5
    surface = grid_tile.surface_of(sponge(), 0.0, inside='below', options=TileOptions(periodic=periodic))
    assert surface.height == pytest.approx(0.5 / width)
    assert walls(surface) < 1.5


@pytest.mark.parametrize("values, threshold, words", [
    (np.zeros((4, 4)), 0.5, "shape"), (np.zeros((1, 4, 4)), 0.5, "two nodes"),
    (np.zeros((4, 4, 4), complex), 0.5, "complex"), (np.zeros((4, 4, 4)), 0.5, "threshold"),
    (np.ones((4, 4, 4)), 0.5, "between 1 and 1"),
    (np.full((4, 4, 4), np.nan), 0.5, "not finite"), (np.arange(64.0).reshape(4, 4, 4), np.nan, "threshold")])
def test_what_is_no_grid_is_refused_by_name(values, threshold, words):
    with pytest.raises(ValueError, match=words) as caught:
        grid_tile.surface_of(values, threshold, name="Smoke")
    assert str(caught.value).startswith('"Smoke"')


def test_a_saved_grid_loads_to_the_bit(tmp_path, rng):
    values = rng.random((3, 4, 5)).astype(np.float32)
    np.save(tmp_path / "grid.npy", np.asfortranarray(values))
    loaded = grid_file.load(str(tmp_path / "grid.npy"))
    np.testing.assert_array_equal(loaded, values)
    assert loaded.dtype == np.float32 and loaded.flags.owndata


def bad_files():
    """Name and bytes of files that are no grid."""
    good = np.lib.format
    shape = b"{'descr': '<f4', 'fortran_order': False, 'shape': (4000, 4000, 4000), }"
    header = b"\x93NUMPY\x01\x00v\x00" + shape.ljust(117) + b"\n"
    return {
        "empty": b"", "text": b"not a grid at all\n" * 9, "magic": good.MAGIC_PREFIX + b"\x01\x00",
        "pickle": pickle.dumps(np.zeros((2, 2, 2))), "promises": header + b"\0" * 64,
        "nonsense": b"\x93NUMPY\x01\x00v\x00" + b"{'descr': __import__('os').abort()}".ljust(117) + b"\n",
        "version": good.MAGIC_PREFIX + b"\x09\x00" + b"\0" * 64,
    }


@pytest.mark.parametrize("name", bad_files())
def test_bytes_that_are_no_grid_are_refused(tmp_path, name):
    path = tmp_path / f"{name}.npy"
    path.write_bytes(bad_files()[name])
    with pytest.raises(ValueError, match="numpy.save") as caught:
        grid_file.load(str(path))
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


class Trap:
    """Would raise, were it ever unpickled."""

    def __reduce__(self):
        return (exec, ("raise SystemError('unpickled')",))


@pytest.mark.parametrize("values", [np.zeros((2, 2)), np.array(["a"]), np.zeros((2, 2, 2), complex),
                                    np.array([[[Trap(), 1]]], object)])
def test_arrays_that_are_no_grid_are_refused(tmp_path, values):
    np.save(tmp_path / "flat.npy", values)
    with pytest.raises(ValueError, match="save"):
        grid_file.load(str(tmp_path / "flat.npy"))


def test_several_arrays_are_refused(tmp_path):
    with open(tmp_path / "many.npy", "wb") as stream:
        np.savez(stream, a=np.zeros((2, 2, 2)))
    with pytest.raises(ValueError, match="several"):
        grid_file.load(str(tmp_path / "many.npy"))


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(OSError, match="nowhere.npy"):
        grid_file.load(str(tmp_path / "nowhere.npy"))
