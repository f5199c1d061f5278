"""Shell and map as the textures of the draw program: which texel holds what. Knows no GPU; C-contiguous float32 throughout.

Each function returns an array [depth, height, width, channels] or [height, width, channels]; a periodic axis ends with one
repeated node, so that filtering that clamps to the edge is periodic filtering.
"""

import numpy

PRISMS_PER_ROW = 256  # shaders/host/prism_table.glsl counts on it


MOST_LAYERS = 2048  # of a 3D texture, on any graphics card that Blender runs on


def check_map(tile_map):
    """Raise ValueError for a map that cannot be drawn: no distance field, or a texture larger than GPUs take."""
    if tile_map.sdf is None:
        raise ValueError("the map has no distance field, which every traversal asks: bake it again with one")
    check_size(tile_map.terms, tile_map.resolution, tile_map.directions, tile_map.sdf.shape)


def check_size(terms, resolution, directions, sdf_shape):
    """Raise ValueError where a map of this size would need a texture larger than GPUs take, whatever its layout."""
    layers = -(-terms // 4) * (directions[1] + 1)
    if max(layers, resolution[0] + 1, resolution[1] + 1, *sdf_shape) > MOST_LAYERS:
        raise ValueError(f"the map needs textures of more than {MOST_LAYERS} layers: "
                         "bake it with fewer terms, directions or nodes")


def prism_table(prisms):
    """RGBA32F [rows, 2048, 4] from a shell's prism table [p, 8, 4]; the rest of the last row is zero."""
    rows = -(-len(prisms) // PRISMS_PER_ROW)
    table = numpy.zeros((rows * PRISMS_PER_ROW, 8, 4), numpy.float32)
    table[: len(prisms)] = prisms
    return table.reshape(rows, PRISMS_PER_ROW * 8, 4)


def gdm_weights(weights):
    """RGBA16F [groups * layers, ny + 1, nx + 1, 4] from weights [terms, azimuths, ny, nx]; four terms a texel.

    A layer is an azimuth; where there is more than one, the first is repeated behind the last.
    """
    grouped = _groups_of_four(weights)  # [groups, azimuths, ny, nx, 4]
    padded = numpy.pad(grouped, ((0, 0), _repeated(weights), (0, 1), (0, 1), (0, 0)), mode="wrap")
    return numpy.ascontiguousarray(padded.reshape(-1, *padded.shape[2:]))


def gdm_eigenmaps(eigenmaps):
    """RGBA16F [groups * layers, ntheta, nz, 4] from eigenmaps [terms, azimuths, ntheta, nz]; likewise."""
    grouped = numpy.pad(_groups_of_four(eigenmaps), ((0, 0), _repeated(eigenmaps), (0, 0), (0, 0), (0, 0)), mode="wrap")
    return numpy.ascontiguousarray(grouped.reshape(-1, *grouped.shape[2:]))


def sdf_volume(sdf):
    """R16F [mz, my + 1, mx + 1, 1] from a distance field [mz, my, mx]."""
    return numpy.ascontiguousarray(numpy.pad(sdf, ((0, 0), (0, 1), (0, 1)), mode="wrap")[..., None])


def density_volume(sdf):
    """R16F [mz, my + 1, mx + 1, 1]: the solid's share of the voxel around each node, in steps of 1/256, which a half holds.

    Not R8: llvmpipe interpolates 8-bit textures in 8-bit numbers, and rays then slip past edges that other drivers hit.
    """
    density = numpy.clip(0.5 - sdf_volume(sdf) * numpy.float32(sdf.shape[2]), 0.0, 1.0)
    return numpy.rint(density * numpy.float32(256.0)) / numpy.float32(256.0)


def facet_volume(tile_map):
    """RGBA32F [depth, cy, cx, 4]: the facets of a map, bit for bit; one texel of 0 where it has none."""
    return numpy.zeros((1, 1, 1, 4), numpy.float32) if tile_map.facets is None else numpy.ascontiguousarray(tile_map.facets)


def hull_corners(prism_count):
    """uint32 [6 * prism_count]: the vertex attribute `corner`."""
    return numpy.arange(6 * prism_count, dtype=numpy.uint32)


def _repeated(terms):
    return (0, 1 if terms.shape[1] > 1 else 0)


def _groups_of_four(terms):
    missing = -len(terms) % 4
    padded = numpy.concatenate([terms, numpy.zeros((missing, *terms.shape[1:]), numpy.float32)])
    return numpy.moveaxis(padded.reshape(-1, 4, *terms.shape[1:]), 1, -1)
