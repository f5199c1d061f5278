"""A bake writes a map with facets and attributes, and reports and ends as it should while it makes them."""

import numpy as np
import pytest
from core.bake_tile import BakeRequest, bake_tile
from core.tile_surface import TileSurface
from tiles import chain

CELLS, NODES = 10, (12, 10, 7)


@pytest.fixture
def request_to(tmp_path):
    positions, triangles = chain.chain_links(16)
    surface = TileSurface("Mail", positions, triangles, 0.5,
                          material_indices=np.zeros(len(triangles), np.int32),
                          materials=({"color": (0.25, 0.5, 1.0), "roughness": 0.25, "metallic": 1.0, "image": None},))
    return BakeRequest(surface, str(tmp_path / "mail.exr"), resolution=(8, 8, 4), directions=(4, 4),
                       sdf_resolution=(12, 12, 7), facet_cells=CELLS, attribute_resolution=NODES,
                       terms=2)


def test_the_map_has_them(native, request_to):
    seen = []
    result = bake_tile(request_to, lambda fraction: seen.append(fraction) or True)
    assert {"facets", "attributes"} < result.seconds.keys()
    assert seen == sorted(seen) and seen[-1] == 1.0
    tile_map = native.load(request_to.path)
    surface = request_to.surface
    sample = native.Sample(surface.positions, surface.triangles, height=surface.height)
    facets = native.bake_facets(sample, cells=CELLS)
    np.testing.assert_array_equal(tile_map.facets.view(np.uint32), facets.texels.view(np.uint32))
    shape = tuple(reversed(NODES))
    attributes = tile_map.attributes
    np.testing.assert_array_equal(attributes["color"], np.broadcast_to(np.float32([0.25, 0.5, 1.0]), (*shape, 3)))
    np.testing.assert_array_equal(attributes["surface"], np.broadcast_to(np.float32([0.25, 1.0]), (*shape, 2)))
    np.testing.assert_allclose(np.linalg.norm(attributes["normal"], axis=-1), 1.0, atol=2e-3)


def test_a_cancel_at_any_fraction_leaves_no_file(native, request_to, tmp_path):
    seen = []
    bake_tile(request_to, lambda fraction: seen.append(fraction) or True)
    (tmp_path / "mail.exr").unlink()
    for limit in sorted(set(seen[:-1])):
        with pytest.raises(native.Cancelled):
            bake_tile(request_to, lambda fraction: fraction < limit)
        assert not list(tmp_path.iterdir())
