"""mesoshell_native.render_scene: what its dicts mean and how they are refused. Laws of the pictures are in tests/native."""

import numpy as np
import pytest

CUBE = dict(positions=np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], np.float32) - 0.5,
            triangles=[(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6),
                       (0, 6, 2), (1, 3, 7), (1, 7, 5)])
# Straight down from z = 5, 2 units wide.
VIEW = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -0.2, 0], [0, 0, 0, 1]], float)


def picture(native, **arguments):
    return native.render_scene(**{"clip_from_world": VIEW, "size": (40, 40), "threads": 1, **arguments})


@pytest.fixture(scope="session")
def shell(native):
    return native.build_shell([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [4], [0, 1, 2, 3],
                              [[0, 0], [1, 0], [1, 1], [0, 1]], thickness=0.5)


@pytest.fixture(scope="session")
def slab(native):
    """A tile that is solid up to half its height, as a Map."""
    sample = native.Sample([[0, 0, 0.25], [1, 0, 0.25], [1, 1, 0.25], [0, 1, 0.25]], [[0, 1, 2], [0, 2, 3]], height=0.5)
    gdm = native.bake_gdm(sample, resolution=(4, 4, 4), directions=(4, 4))
    return native.compress(gdm, sdf=native.bake_sdf(sample, resolution=(16, 16, 9)), terms=4)


def test_a_mesh_a_sun_and_a_sky(native):
    cube = dict(CUBE, base_color=(0.5, 0.25, 1.0), object_index=3)
    result = picture(native, meshes=[cube], world=dict(color=(0.1, 0.2, 0.3)),
                     lights=[dict(type="SUN", direction=(0, 0, -2), color=(np.pi, np.pi, np.pi))])
    assert {name: (array.dtype, array.shape) for name, array in result.items()} == {
        "color": (np.float32, (40, 40, 4)), "depth": (np.float32, (40, 40)), "normal": (np.float32, (40, 40, 3)),
        "index": (np.int32, (40, 40)), "fetches": (np.int32, (40, 40))}
    inside = result["index"] == 3
    assert inside.sum() == 400 and inside[10:30, 10:30].all() and (result["index"][~inside] == -1).all()
    np.testing.assert_allclose(result["color"][inside], [[0.55, 0.3, 1.3, 1.0]] * 400, rtol=1e-5)
    np.testing.assert_allclose(result["color"][~inside], [[0.1, 0.2, 0.3, 1.0]] * 1200, rtol=1e-6)
    np.testing.assert_allclose(result["depth"][inside], 4.5, rtol=1e-6)
    np.testing.assert_allclose(result["normal"][inside], [[0, 0, 1]] * 400, atol=1e-6)


def test_a_shell_lies_where_its_matrix_puts_it(native, shell, slab):
    matrix = np.diag([0.5, -1.0, 2.0, 1.0])
    matrix[:3, 3] = 0.2, 0.4, -1.0
    result = picture(native, shells=[dict(shell=shell, map=slab, world_from_object=matrix, base_color=(1, 0, 0))],
                     world=dict(color=(0.5, 0.5, 0.5)), transparent=True)
    seen = result["color"][..., 3] == 1
    # x from 0.2 to 0.7, y from -0.6 to 0.4, of pixels 1/20 wide.
    assert np.array_equal(np.nonzero(seen.any(0))[0], np.arange(24, 34))
    assert np.array_equal(np.nonzero(seen.any(1))[0], np.arange(8, 28))
    np.testing.assert_allclose(result["depth"][seen], 5 + 1 - 2 * 0.25, atol=2e-3)
    np.testing.assert_allclose(result["color"][seen], [[0.5, 0, 0, 1]] * seen.sum(), atol=1e-6)
    assert (result["color"][~seen] == 0).all()
    settings = native.shell_params(None, slab, VIEW)
    for more in (dict(settings=settings), dict(traversal="gdm"), dict(object_index=-5)):
        assert (picture(native, shells=[dict(shell=shell, map=slab, world_from_object=matrix, **more)])["index"] != -1).any()
    hidden = picture(native, shells=[dict(shell=shell, map=slab, world_from_object=matrix, visible_camera=False)])
    assert (hidden["index"] == -1).all()


def test_colors_and_normals_of_triangles(native):
    colors = np.zeros((12, 3), np.float32)
    colors[2:4] = (1, 0, 0), (0, 1, 0)
    lit = picture(native, meshes=[dict(CUBE, colors=colors)], world=dict(color=(1, 1, 1)))["color"]
    assert {tuple(c) for c in lit[10:30, 10:30].reshape(-1, 4)} == {(1, 0, 0, 1), (0, 1, 0, 1)}
    smooth = picture(native, meshes=[dict(CUBE, normals=CUBE["positions"])])["normal"]
    across = (np.arange(10, 30) - 19.5) / 20
    np.testing.assert_allclose(smooth[15, 10:30, 0] / smooth[15, 10:30, 2], across / 0.5, atol=1e-5)
    corners = np.tile(np.array([[0, 0.6, 0.8]], np.float32), (36, 1))
    leaning = picture(native, meshes=[dict(CUBE, normals=corners)])["normal"]
    np.testing.assert_allclose(leaning[15, 20], [0, 0.6, 0.8], atol=1e-6)


def test_the_sky_as_an_image(native):
    image = np.zeros((2, 4, 3), np.float32)
    image[0] = (0.25, 0.5, 1.0)  # below
    np.testing.assert_allclose(picture(native, world=dict(image=image))["color"][0, 0], [0.25, 0.5, 1.0, 1.0], atol=1e-6)


@pytest.mark.parametrize("light", [
    dict(type="POINT", position=(0, 0, 2), radius=0.1),
    dict(type="SPOT", position=(0, 0, 2), direction=(0, 0, -1), spot_size=0.6, spot_blend=0.5, spot_cosine=True),
    dict(type="AREA", position=(0, 0, 2), direction=(0, 0, -1), shape="ELLIPSE", size=(1, 2), axes=np.eye(3)[:2]),
    dict(type="SUN", direction=(0, 0, -1), angle=0.1, cast_shadow=False),
])
def test_every_lamp_lights(native, light):
    assert picture(native, meshes=[CUBE], lights=[light], samples=4)["color"][15, 20, 0] > 0.001


def test_tiles_arrive_and_make_the_picture(native):
    whole = np.full((70, 90, 4), -1, np.float32)

    def on_tile(x, y, w, h, color):
        assert color.shape == (h, w, 4)
        whole[y:y + h, x:x + w] = color

    result = picture(native, size=(90, 70), meshes=[CUBE], world=dict(color=(1, 1, 1)), samples=3, on_tile=on_tile)
    np.testing.assert_array_equal(whole, result["color"])

    def broken(*tile):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        picture(native, on_tile=broken)


def test_progress_cancels(native):
    with pytest.raises(native.Cancelled):
        picture(native, size=(2000, 2000), meshes=[CUBE], samples=64, progress=lambda fraction: fraction <= 0)


@pytest.mark.parametrize("arguments, words", [
    (dict(meshes=[CUBE, dict(CUBE, color=(1, 1, 1))]), r"meshes\[1\] has no field 'color'; its fields are positions, "),
    (dict(meshes=[CUBE, dict(positions=CUBE["positions"])]), r"meshes\[1\] lacks 'triangles'"),
    (dict(meshes=[dict(CUBE, positions=[[0, 0]])]), r"meshes\[0\]: positions has shape"),
    (dict(meshes=[dict(CUBE, triangles=[[0, 1, -1]])]), r"meshes\[0\]: triangles name vertex"),
    (dict(meshes=[dict(CUBE, base_color=(1, 1))]), r"meshes\[0\]: base_color has 2 numbers; give 3"),
    (dict(meshes=[dict(CUBE, object_index=2**31)]), r"meshes\[0\]: object_index is no integer of 32 bits"),
    (dict(meshes=[3]), r"meshes\[0\] is no dict"),
    (dict(meshes=3), "meshes is no sequence"),
    (dict(shells=[dict(shell=1, map=2, world_from_object=np.eye(4))]), r"shells\[0\]: shell is none"),
    (dict(lights=[dict(type="LAMP")]), r"lights\[0\]: type 'LAMP' does not exist; choose SUN, POINT, SPOT or AREA"),
    (dict(lights=[dict(type=1)]), r"lights\[0\]: type is no text"),
    (dict(lights=[dict(type="SUN")]), r"lights\[0\] lacks 'direction'"),
    (dict(lights=[dict(type="POINT", position=(0, 0, 0), radius="wide")]), r"lights\[0\]: radius is no number"),
    (dict(lights=[dict(type="AREA", position=(0, 0, 0), direction=(0, 0, 1), axes=np.eye(3))]),
     r"lights\[0\]: axes has 3 rows"),
    (dict(world=dict(image=np.zeros((2, 2, 4)))), "world: image is no image"),
    (dict(world=dict(image=np.zeros((0, 2, 3)))), "world: image is no image"),
    (dict(clip_from_world=np.zeros((4, 4))), "clip_from_world cannot be inverted"),
    (dict(samples=0), "samples is 0"),
])
def test_what_is_wrong_is_named(native, arguments, words):
    with pytest.raises(ValueError, match=words):
        picture(native, **arguments)


def test_a_bad_shell_is_named(native, shell, slab):
    for wrong, words in ((dict(traversal="best"), "traversal 'best'"), (dict(settings=b"12"), "settings has 2 bytes"),
                         (dict(world_from_object=np.zeros((4, 4))), "world_from_object")):
        with pytest.raises(ValueError, match=rf"shells\[1\]: {words}"):
            good = dict(shell=shell, map=slab, world_from_object=np.eye(4))
            picture(native, shells=[good, {**good, **wrong}])


def test_keywords_are_needed(native):
    with pytest.raises(TypeError, match="clip_from_world"):
        native.render_scene(size=(4, 4))
    with pytest.raises(TypeError, match="size"):
        native.render_scene(clip_from_world=VIEW)
