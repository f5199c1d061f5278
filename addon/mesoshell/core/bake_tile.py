"""The order of the stages from a tile's arrays to a map file: sample, GDM, SDF, facets, attributes, compress, save."""

import os
import tempfile
import time
from contextlib import contextmanager
from dataclasses import dataclass

from . import attributes, native, packing
from .tile_surface import TileSurface


@dataclass(frozen=True)
class BakeRequest:
    """All that a bake needs; arrays are private copies, so that a thread may read them."""

    surface: TileSurface
    path: str
    resolution: tuple = (64, 64, 32)
    directions: tuple = (16, 32)
    sdf_resolution: tuple = (64, 64, 33)
    facet_cells: int = 64  # along u
    attribute_resolution: tuple = (64, 64, 33)
    terms: int = 0  # as many as the paper's 16 terms have bytes
    layout: str = "auto"
    precision: str = "byte"
    memory: float = 0.0  # bytes; 0: a quarter of the machine's
    threads: int = 0


@dataclass(frozen=True)
class BakeResult:
    """`rmse` is the truncation's, in tile widths; `seconds` maps each stage to its wall time; `notices` are sentences."""

    path: str
    layout: str
    terms: int
    rmse: float
    seconds: dict
    notices: tuple


# Shares of the whole, as measured on the chain tile; only the progress bar depends on them.
_SHARES = (("sdf", 0.05), ("facets", 0.40), ("attributes", 0.10), ("gdm", 0.41), ("save", 0.04))


def check_folder(path):
    """Raises OSError, in a sentence, if no file can be made beside `path`: better now than after the bake."""
    folder = os.path.dirname(path) or "."
    if os.path.isdir(path):
        raise IsADirectoryError(f"{path} is a folder: give the name of a file in it, such as chain.gdm.exr")
    if not os.path.isdir(folder):
        raise NotADirectoryError(f"There is no folder {folder} to save the map in: create it or choose another path")
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise OSError(f"The folder {folder} can not be written ({error.strerror}): "
                      "choose another path for the map") from error


@contextmanager
def _naming(name, module):
    """The native module does not know what the tile is called; its sentences reach a user who has several."""
    try:
        yield
    except module.Cancelled:
        raise
    except ValueError as error:
        raise ValueError(f'Tile "{name}": {error}') from error
    except module.Error as error:
        raise module.Error(f'Tile "{name}": {error}') from error


def bake_tile(request, progress=None):
    """Bakes `request` and saves the map; returns a BakeResult.

    `progress(fraction) -> bool` sees one rising fraction over all stages; a False answer raises Cancelled.
    Raises what the native module raises: ValueError, OSError, MemoryError, Error.
    """
    module = native.module()
    surface = request.surface
    seconds = {}
    done = 0.0
    shares = dict(_SHARES)

    def stage(name, call):
        nonlocal done
        start, share = done, shares[name]

        def inner(fraction):
            return True if progress is None else bool(progress(start + share * fraction))

        # The stages that are too quick to ask themselves still obey a cancel that came before them.
        if not inner(0.0):
            raise cancelled()
        before = time.perf_counter()
        if name == "save":  # its sentences name the file
            result = call(inner)
        else:
            with _naming(surface.name, module):
                result = call(inner)
        seconds[name] = time.perf_counter() - before
        done = start + share
        return result

    def cancelled():
        return module.Cancelled(f"The bake of {surface.name} was cancelled")

    def look_at_surface(inner):
        def check():
            if not inner(0.9):
                raise cancelled()

        points = module.closest_points(sample, resolution=request.attribute_resolution, threads=request.threads,
                                       progress=lambda fraction: inner(0.9 * fraction))
        return attributes.volumes(surface, points, check)

    with _naming(surface.name, module):
        plan = module.plan_bake(resolution=request.resolution, directions=request.directions, terms=request.terms or None,
                                layout=request.layout, precision=request.precision, memory=request.memory)
        packing.check_size(plan["terms"], request.resolution, request.directions, request.sdf_resolution)
        sample = module.Sample(surface.positions, surface.triangles, height=surface.height, aspect=surface.aspect,
                               thickness=surface.thickness)
    sdf = stage("sdf", lambda inner: module.bake_sdf(
        sample, resolution=request.sdf_resolution, threads=request.threads, progress=inner))
    facets = stage("facets", lambda inner: module.bake_facets(
        sample, cells=request.facet_cells, threads=request.threads, progress=inner))
    shown = stage("attributes", look_at_surface)
    baked = stage("gdm", lambda inner: module.bake_map(
        sample, resolution=request.resolution, directions=request.directions, sdf=sdf, facets=facets, attributes=shown,
        terms=request.terms or None, layout=request.layout, precision=request.precision, memory=request.memory,
        threads=request.threads, progress=inner))
    stage("save", lambda inner: baked.save(request.path))
    if progress is not None:
        progress(1.0)
    return BakeResult(request.path, baked.layout, baked.terms, baked.rmse, seconds, _notices(surface, sample))


def _notices(surface, sample):
    return (*surface.notices, *(f'Tile "{surface.name}": {notice.rstrip(".")}' for notice in sample.notices))
