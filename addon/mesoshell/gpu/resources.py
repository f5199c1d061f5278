"""What a shell and a map hold on the GPU, kept while they are drawn.

A place in the scene (shells.ShellInstance.place) holds one shell: another version of it takes the place of the one before at
once, so that an animation that is played holds no more than its last frame.
"""

import gpu
import numpy

from ..core import packing

# What none of this many draws showed is dropped: another viewport may show it in turn.
_IDLE_DRAWS = 240

_shells = {}  # place -> ShellResources
_maps = {}  # version -> MapResources
_draws = 0


class ShellResources:
    """The prism table and the hulls of a native Shell."""

    def __init__(self, shell, version, before=None):
        """`before` is the ShellResources that this replaces; its corners serve again where there are as many."""
        self.version = version
        self.prism_count = shell.prism_count
        self.prism_table = _texture(packing.prism_table(shell.prisms), "RGBA32F")
        if before is not None and before.prism_count == shell.prism_count:
            self._corners = before._corners
        else:
            form = gpu.types.GPUVertFormat()
            form.attr_add(id="corner", comp_type="U32", len=1, fetch_mode="INT")
            self._corners = gpu.types.GPUVertBuf(form, 6 * shell.prism_count)
            self._corners.attr_fill("corner", packing.hull_corners(shell.prism_count))
        indices = gpu.types.GPUIndexBuf(type="TRIS", seq=shell.indices.reshape(-1, 3))
        self.hulls = gpu.types.GPUBatch(type="TRIS", buf=self._corners, elem=indices)
        self.last_draw = _draws


class MapResources:
    """The textures of a native Map."""

    def __init__(self, tile_map):
        self.gdm_weights = _texture(packing.gdm_weights(tile_map.weights), "RGBA16F")
        self.gdm_eigenmaps = _texture(packing.gdm_eigenmaps(tile_map.eigenmaps), "RGBA16F")
        self.sdf_volume = _texture(packing.sdf_volume(tile_map.sdf), "R16F")
        self.density_volume = _texture(packing.density_volume(tile_map.sdf), "R16F")
        self.facet_volume = _texture(packing.facet_volume(tile_map), "RGBA32F")
        self.last_draw = _draws


def shell_resources(shell, place, version):
    """The ShellResources of a shell; `version` is an integer that no other shell has, `place` what it is a version of."""
    held = _shells.get(place)
    if held is None or held.version != version:
        held = _shells[place] = ShellResources(shell, version, held)
    held.last_draw = _draws
    return held


def map_resources(tile_map, version):
    """The MapResources of a map; `version` is an integer that no other map has."""
    if version not in _maps:
        _maps[version] = MapResources(tile_map)
    _maps[version].last_draw = _draws
    return _maps[version]


def end_draw():
    """Count a draw, and drop what has not been drawn for long."""
    global _draws
    _draws += 1
    for kept in (_shells, _maps):
        for key in [key for key, held in kept.items() if _draws - held.last_draw > _IDLE_DRAWS]:
            del kept[key]


def forget():
    """Drop everything."""
    _shells.clear()
    _maps.clear()


def _texture(texels, form):
    size = texels.shape[-2::-1]  # width first
    buffer = gpu.types.Buffer("FLOAT", texels.size, numpy.ascontiguousarray(texels).reshape(-1))
    return gpu.types.GPUTexture(size, format=form, data=buffer)
