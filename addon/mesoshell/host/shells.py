"""What is to be drawn: the built shell and the loaded map of each visible object, kept while nothing changes.

A shell is built when it is first asked for, and again when its settings, its file or (as the depsgraph tells) its
geometry changed. What goes wrong becomes a sentence for the panel, and that object is left out.
"""

import hashlib
import itertools
import traceback
from typing import NamedTuple

import bpy
import numpy as np
from bpy.app.handlers import persistent

from ..core import native
from . import handlers, map_cache, meshes, paths, versions


class ShellSettings(NamedTuple):
    """What the draw code takes from the object besides shell and map."""

    traversal: str  # "gdm" or "sdf"
    base_color: tuple  # linear RGBA


class ShellInstance(NamedTuple):
    object_name: str
    shell: object  # native Shell, in object space
    map: object  # native Map
    world_from_object: np.ndarray  # float64 [4, 4]
    settings: ShellSettings
    shell_version: int  # changes when `shell` does; never used twice in a session
    map_version: int


class BuildKey(NamedTuple):
    """All that a shell is built from, except for the geometry."""

    file: map_cache.FileState
    thickness: float
    levels: int
    scheme: str
    tiles: tuple


class _Entry:
    """A built shell and its map, or the sentence of why there is none."""

    def __init__(self, key, digest=None, shell=None, loaded_map=None, problem=None):
        self.key, self.digest, self.shell, self.loaded_map, self.problem = key, digest, shell, loaded_map, problem
        self.version = next(_versions)
        self.stale = False
        self.last_asked = _asked


_versions = itertools.count(1)
_entries = {}  # (object key, depsgraph mode) -> _Entry
_asked = 0  # how often visible() was called

# What so many calls did not ask for is dropped: another viewport may show it in turn.
_IDLE_CALLS = 240


def visible(depsgraph, space=None):
    """A list of ShellInstance, one for each object with a shell that is visible in the depsgraph's view layer.

    `space` is a SpaceView3D whose local view and local collections count too (None: the context's, if it has one). Never raises for what a user can do;
    problem() then has the sentence.
    """
    global _asked
    _asked += 1
    instances = []
    for obj in depsgraph.view_layer.objects:
        if obj.mesoshell.enabled and _is_visible(obj, depsgraph, space):
            entry = _up_to_date(obj, depsgraph)
            entry.last_asked = _asked
            if entry.problem is None:
                instances.append(_instance(obj, depsgraph, entry))
    for place in [place for place, entry in _entries.items() if _asked - entry.last_asked > _IDLE_CALLS]:
        del _entries[place]
    return instances


def problem(obj):
    """The sentence of what keeps an object's shell from being drawn, or None."""
    for mode in ('VIEWPORT', 'RENDER'):
        entry = _entries.get((versions.object_key(obj), mode))
        if entry is not None and entry.problem is not None:
            return entry.problem
    return None


def prism_count(obj):
    """The prisms of an object's shell as last drawn in the viewport, or None."""
    entry = _entries.get((versions.object_key(obj), 'VIEWPORT'))
    return entry.shell.prism_count if entry is not None and entry.shell is not None else None


def build_key(obj, *, map_path, thickness, levels, scheme, tiles):
    """The BuildKey of these settings; raises ValueError or OSError."""
    if not thickness > 0.0:
        raise ValueError(f'The shell of "{obj.name}" has a thickness of {thickness:g}: set it to more than zero')
    return BuildKey(map_cache.file_state(paths.absolute(map_path, obj)), thickness, levels, scheme, tuple(tiles))


def surface_for(obj, depsgraph, key):
    """The SurfaceArrays that `key` asks for; raises ValueError."""
    return meshes.read_surface(obj, depsgraph, tiles=key.tiles, triangulate=key.scheme == "loop",
                               polygons=key.levels > 0)


def build(obj, surface, key):
    """The native Shell of an object's surface; raises ValueError, MemoryError, Error or NativeMissing."""
    module = native.module()
    try:
        return module.build_shell(surface.positions, surface.face_sizes, surface.corners, surface.uvs,
                                  thickness=key.thickness, levels=key.levels, scheme=key.scheme)
    except ValueError as error:
        raise ValueError(f'"{obj.name}": {error}') from error
    except module.Error as error:
        raise module.Error(f'"{obj.name}": {error}') from error


def adopt(obj, depsgraph, key, surface, shell, loaded_map):
    """Keeps a shell that was just built, so that the first drawing need not build it again."""
    _entries[versions.object_key(obj), depsgraph.mode] = _Entry(key, _digest(surface), shell, loaded_map)


def forget():
    """Drops everything; what is asked for next is built anew."""
    _entries.clear()


def _is_visible(obj, depsgraph, space):
    if depsgraph.mode == 'RENDER':
        return not obj.hide_render
    if space is None:
        return obj.visible_get(view_layer=depsgraph.view_layer)
    return obj.visible_get(view_layer=depsgraph.view_layer, viewport=space)


def _up_to_date(obj, depsgraph):
    settings = obj.mesoshell
    place = (versions.object_key(obj), depsgraph.mode)
    entry = _entries.get(place)
    key = None
    try:
        key = build_key(obj, map_path=settings.map_path, thickness=settings.thickness, levels=settings.levels,
                        scheme=settings.scheme, tiles=(settings.tiles_u, settings.tiles_v))
        if entry is not None and entry.key == key and not entry.stale:
            return entry
        surface = surface_for(obj, depsgraph, key)
        digest = _digest(surface)
        if entry is not None and entry.key == key and entry.digest == digest:
            # The depsgraph names an object whose color changed as well; only what it is made of counts.
            entry.stale = False
            return entry
        loaded_map = map_cache.load(key.file)
        entry = _Entry(key, digest, build(obj, surface, key), loaded_map)
    except Exception as error:  # whatever it is, drawing goes on
        entry = _Entry(key, problem=str(error) or type(error).__name__)
        if not _is_foreseen(error):
            traceback.print_exc()
    _entries[place] = entry
    return entry


def _digest(surface):
    digest = hashlib.blake2b(digest_size=16)
    for array in surface:
        digest.update(array)
        digest.update(repr(array.shape).encode())
    return digest.digest()


def _is_foreseen(error):
    if isinstance(error, (ValueError, OSError, MemoryError, native.NativeMissing)):
        return True
    try:
        return isinstance(error, native.module().Error)
    except native.NativeMissing:
        return False


def _instance(obj, depsgraph, entry):
    settings = obj.mesoshell
    return ShellInstance(
        obj.name, entry.shell, entry.loaded_map.map,
        np.array(obj.evaluated_get(depsgraph).matrix_world, np.float64),
        ShellSettings(settings.traversal, (*settings.base_color, 1.0)), entry.version, entry.loaded_map.version)


@persistent
def _on_depsgraph_update(_scene, depsgraph):
    if not _entries:
        return
    changed = {versions.object_key(update.id.original) for update in depsgraph.updates
               if update.is_updated_geometry and isinstance(update.id, bpy.types.Object)}
    for (object_key, _mode), entry in _entries.items():
        if object_key in changed:
            entry.stale = True


@persistent
def _on_frame_change(*_arguments):
    # The depsgraph's list of updates is empty then; a digest tells what really moved.
    for entry in _entries.values():
        entry.stale = True


@persistent
def _on_undo(*_arguments):
    # Undo replaces data without naming all of it; building once more is cheap beside drawing what is gone.
    alive = {versions.object_key(obj) for obj in bpy.data.objects}
    for place in [place for place in _entries if place[0] not in alive]:
        del _entries[place]
    for entry in _entries.values():
        entry.stale = True


@persistent
def _on_load(*_arguments):
    forget()


_HANDLERS = (("depsgraph_update_post", _on_depsgraph_update), ("frame_change_post", _on_frame_change), ("undo_post", _on_undo), ("redo_post", _on_undo),
             ("load_post", _on_load))


def register():
    handlers.add(_HANDLERS)


def unregister():
    handlers.remove(_HANDLERS)
    forget()
