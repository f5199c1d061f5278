"""Loaded maps, one for each file as it stands: shared by all shells that use it."""

import itertools
import os
import weakref
from typing import NamedTuple

from ..core import native, packing

_versions = itertools.count(1)
_loaded = weakref.WeakValueDictionary()  # (path, mtime, size) -> LoadedMap; lives as long as a shell holds it


class LoadedMap:
    """A map and the number by which the GPU side knows it; a new number means new contents."""

    def __init__(self, native_map):
        self.map = native_map
        self.version = next(_versions)


class FileState(NamedTuple):
    path: str
    mtime_ns: int
    size: int


def file_state(path):
    """What tells one content of a file from the next; raises OSError in a sentence."""
    try:
        state = os.stat(path)
    except OSError as error:
        raise OSError(f"The map {path} can not be read ({error.strerror}): "
                      "bake it, or choose another file") from error
    return FileState(path, state.st_mtime_ns, state.st_size)


def load(state):
    """The LoadedMap of a FileState; raises OSError, ValueError, Error or NativeMissing."""
    loaded = _loaded.get(state)
    if loaded is None:
        loaded = LoadedMap(native.module().load(state.path))
        try:
            packing.check_map(loaded.map)
        except ValueError as error:
            raise ValueError(f"{state.path}: {error}") from error
        _loaded[state] = loaded
    return loaded
