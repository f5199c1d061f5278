"""What is to be drawn: the built shell and the loaded map of each visible object, kept while nothing changes.

A shell is built when it is first asked for, and again when its settings, its file or (as the depsgraph tells) its
geometry changed; where only positions did, it is updated. What goes wrong becomes a sentence for the panel, and that object
is left out.
"""

import itertools
import traceback
from typing import NamedTuple

import bpy
import numpy as np
from bpy.app.handlers import persistent

from . import handlers, map_cache, meshes, parts, sentences, shell_building, shell_checks, shell_keys, versions


class ShellSettings(NamedTuple):
    """What the draw code takes from the object besides shell and map."""

    traversal: str  # a name of shell_options.TRAVERSALS
    base_color: tuple  # linear RGBA
    fins: str = "exact"  # or "paper"


class ShellInstance(NamedTuple):
    object_name: str
    shell: object  # native Shell, in object space
    map: object  # native Map
    world_from_object: np.ndarray  # float64 [4, 4]
    settings: ShellSettings
    shell_version: int  # changes when `shell` does; never used twice in a session
    map_version: int
    place: tuple  # hashable; stays while the shell of one object changes
    found: dict  # what host/shell_checks.py found of this version, kept with it


# How much of an entry can be wrong, from nothing to everything.
_FRESH, _MOVED, _EDITED = range(3)


class _Entry:
    """A built shell and its map, or the sentence of why there is none."""

    def __init__(self, key, built=None, loaded_map=None, problem=None):
        self.key, self.loaded_map, self.problem = key, loaded_map, problem
        self.problem_cause = None  # the exception
        self.stale = _FRESH
        self.last_asked = _asked
        self.weights = {}  # of vertex groups, as meshes.read_surface keeps them
        self.take(built)

    def take(self, built):
        """A shell_building.Built, as another version of what is drawn."""
        self.built = built
        self.version = next(_versions)
        self.found = {}

    @property
    def shell(self):
        return None if self.built is None else self.built.shell


_versions = itertools.count(1)
_entries = {}  # (object key, depsgraph mode) -> _Entry
_asked = 0  # how often visible() was called

# What so many calls did not ask for is dropped: another viewport may show it in turn.
_IDLE_CALLS = 240


def visible(depsgraph, space=None):
    """A list of ShellInstance, one for each object with a shell that is visible in the depsgraph's view layer.

    `space` is a SpaceView3D whose local view and local collections count too (None: the context's, if it has one). Never
    raises for what a user can do; problem() then has the sentence.
    """
    global _asked
    _asked += 1
    instances = []
    for obj in shown(depsgraph, space):
        instance = one(obj, depsgraph)
        if instance is not None:
            instances.append(instance)
    for place in [place for place, entry in list(_entries.items()) if _asked - entry.last_asked > _IDLE_CALLS]:
        _entries.pop(place, None)
    return instances


def shown(depsgraph, space=None):
    """The list of the objects with a shell that visible() asks for, whether their shells can be built or not."""
    having = [obj for obj in depsgraph.view_layer.objects if obj.mesoshell.enabled]
    if depsgraph.mode != 'RENDER':
        return [obj for obj in having if obj.visible_get(view_layer=depsgraph.view_layer,
                                                         **({} if space is None else {"viewport": space}))]
    if not having:
        return []
    # Whether a collection is hidden from renders, the depsgraph knows.
    rendered = {instance.object.original for instance in depsgraph.object_instances
                if not instance.is_instance and instance.show_self}
    return [obj for obj in having if obj in rendered]


def one(obj, depsgraph):
    """The ShellInstance of an object with a shell, whether it is visible or not; None where problem() has a sentence."""
    entry = _up_to_date(obj, depsgraph)
    entry.last_asked = _asked
    return _instance(obj, depsgraph, entry) if entry.problem is None else None


def read_again(depsgraph):
    """Says that geometry may have changed unannounced, as when a render makes a depsgraph of its own."""
    for (_object_key, mode), entry in list(_entries.items()):
        if mode == depsgraph.mode:
            entry.stale = _EDITED


def problem(obj, modes=('VIEWPORT', 'RENDER')):
    """The sentence of what keeps an object's shell from being drawn, or None; `modes` are those of depsgraphs."""
    for mode in modes:
        entry = _entries.get((versions.object_key(obj), mode))
        if entry is not None and entry.problem is not None:
            return entry.problem
    return None


def needs_unwrap(obj):
    """Whether that problem is one of UVs, which mesoshell.unwrap may mend."""
    return any(entry is not None and isinstance(entry.problem_cause, meshes.UvProblem)
               for entry in (_entries.get((versions.object_key(obj), mode)) for mode in ('VIEWPORT', 'RENDER')))


def drawn(obj):
    """(native Shell, its version) of an object as last drawn in the viewport, or None."""
    entry = _entries.get((versions.object_key(obj), 'VIEWPORT'))
    return None if entry is None or entry.built is None else (entry.shell, entry.version)


def prism_count(obj):
    """The prisms of an object's shell as last drawn in the viewport, or None."""
    last = drawn(obj)
    return None if last is None else last[0].prism_count


def thickness(obj):
    """The thickness of an object's shell as last drawn in the viewport, in object units, or None."""
    entry = _entries.get((versions.object_key(obj), 'VIEWPORT'))
    return None if entry is None or entry.built is None else entry.built.fit.thickness


def adopt(obj, depsgraph, key, built, loaded_map):
    """Keeps a shell that was just built, so that the first drawing need not build it again."""
    _entries[versions.object_key(obj), depsgraph.mode] = _Entry(key, built, loaded_map)


def forget():
    """Drops everything; what is asked for next is built anew."""
    _entries.clear()
    shell_checks.forget()


def _up_to_date(obj, depsgraph):
    place = (versions.object_key(obj), depsgraph.mode)
    entry = _entries.get(place)
    key = None
    try:
        key = shell_keys.of_object(obj, depsgraph)
        if entry is not None and entry.key == key:
            if entry.stale == _FRESH:
                return entry
            if entry.built is not None:
                _bring_up_to_date(obj, depsgraph, entry)
                return entry
        loaded_map = map_cache.load(key.file)
        entry = _Entry(key, None, loaded_map)
        surface = meshes.read_surface(obj, depsgraph, key.reading, known_weights=entry.weights)
        entry.take(shell_building.build(obj, surface, key, loaded_map.map, obj.mesoshell.thickness_image))
    except Exception as error:  # whatever it is, drawing goes on
        entry = _Entry(key, problem=sentences.of(error))
        entry.problem_cause = error.with_traceback(None)
        if not isinstance(error, sentences.expected()):
            traceback.print_exception(error)
    _entries[place] = entry
    return entry


def _bring_up_to_date(obj, depsgraph, entry):
    """Reads a stale entry's geometry, and updates or builds its shell if that changed.

    The depsgraph names an object whose color changed as well, and a new frame moves some objects only: what was read tells.
    """
    moved_only = entry.stale == _MOVED
    weights = entry.weights if moved_only and not parts.weights_may_move(obj) else {}
    surface = meshes.read_surface(obj, depsgraph, entry.key.reading, known_weights=weights)
    image = obj.mesoshell.thickness_image
    built = shell_building.again(obj, surface, entry.key, entry.built, entry.loaded_map.map, image, at_rest=moved_only)
    if built is not entry.built:
        entry.take(built)
    entry.weights, entry.stale = weights, _FRESH


def _instance(obj, depsgraph, entry):
    settings = obj.mesoshell
    return ShellInstance(
        obj.name, entry.shell, entry.loaded_map.map,
        np.array(obj.evaluated_get(depsgraph).matrix_world, np.float64),
        ShellSettings(settings.traversal, (*settings.base_color, 1.0), settings.fins), entry.version,
        entry.loaded_map.version, (versions.object_key(obj), depsgraph.mode), entry.found)


@persistent
def _on_depsgraph_update(_scene, depsgraph):
    if not _entries:
        return
    changed = set()
    for update in depsgraph.updates:
        if isinstance(update.id, bpy.types.Image):
            shell_keys.image_changed(update.id.original)
        elif update.is_updated_geometry and isinstance(update.id, bpy.types.Object):
            changed.add(versions.object_key(update.id.original))
    for (object_key, _mode), entry in list(_entries.items()):  # a render's thread may add some
        if object_key in changed:
            entry.stale = _EDITED


@persistent
def _on_frame_change(*_arguments):
    # The depsgraph's list of updates is empty then; what is read tells what really moved.
    for entry in list(_entries.values()):
        entry.stale = max(entry.stale, _MOVED)


@persistent
def _on_undo(*_arguments):
    # Undo replaces data without naming all of it; building once more is cheap beside drawing what is gone.
    alive = {versions.object_key(obj) for obj in bpy.data.objects}
    for place in [place for place in _entries if place[0] not in alive]:
        del _entries[place]
    for entry in _entries.values():
        entry.stale = _EDITED


@persistent
def _on_load(*_arguments):
    forget()


_HANDLERS = (("depsgraph_update_post", _on_depsgraph_update), ("frame_change_post", _on_frame_change),
             ("undo_post", _on_undo), ("redo_post", _on_undo), ("load_post", _on_load))


def register():
    handlers.add(_HANDLERS)


def unregister():
    handlers.remove(_HANDLERS)
    forget()
