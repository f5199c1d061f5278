"""What a shell and a map hold on the GPU, kept while they are drawn."""

import gpu
import numpy

from ..core import packing

# A shell or map that none of this many draws showed is dropped: another viewport may show it in turn.
_IDLE_DRAWS = 240

_shells = {}
_maps = {}
_draws = 0


class ShellResources:
    """The prism table and the hulls of a native Shell."""

    def __init__(self, shell):
        self.prism_table = _texture(packing.prism_table(shell.prisms), "RGBA32F")
        form = gpu.types.GPUVertFormat()
        form.attr_add(id="corner", comp_type="U32", len=1, fetch_mode="INT")
        vertices = gpu.types.GPUVertBuf(form, 6 * shell.prism_count)
        vertices.attr_fill("corner", packing.hull_corners(shell.prism_count))
        indices = gpu.types.GPUIndexBuf(type="TRIS", seq=shell.indices.reshape(-1, 3))
        self.hulls = gpu.types.GPUBatch(type="TRIS", buf=vertices, elem=indices)
        self.last_draw = _draws


class MapResources:
    """The textures of a native Map."""

    def __init__(self, tile_map):
        self.gdm_weights = _texture(packing.gdm_weights(tile_map.weights), "RGBA16F")
        self.gdm_eigenmaps = _texture(packing.gdm_eigenmaps(tile_map.eigenmaps), "RGBA16F")
        self.sdf_volume = _texture(packing.sdf_volume(tile_map.sdf), "R16F")
        self.last_draw = _draws


def shell_resources(shell, version):
    """The ShellResources of a shell; `version` is an integer that no other shell has."""
    return _kept(_shells, version, ShellResources, shell)


def map_resources(tile_map, version):
    """The MapResources of a map; `version` is an integer that no other map has."""
    return _kept(_maps, version, MapResources, tile_map)


def end_draw():
    """Count a draw, and drop what has not been drawn for long."""
    global _draws
    _draws += 1
    for kept in (_shells, _maps):
        for version in [v for v, resources in kept.items() if _draws - resources.last_draw > _IDLE_DRAWS]:
            del kept[version]


def forget():
    """Drop everything."""
    _shells.clear()
    _maps.clear()


def _kept(kept, version, make, source):
    if version not in kept:
        kept[version] = make(source)
    kept[version].last_draw = _draws
    return kept[version]


def _texture(texels, form):
    size = texels.shape[-2::-1]  # width first
    buffer = gpu.types.Buffer("FLOAT", texels.size, numpy.ascontiguousarray(texels).reshape(-1))
    return gpu.types.GPUTexture(size, format=form, data=buffer)
