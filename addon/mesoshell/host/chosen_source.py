"""Which objects and which box a bake is of, from the scene's settings and what a call gives instead."""

from typing import NamedTuple


from . import instances, tile_box, tile_source


class Choice(NamedTuple):
    name: str  # for sentences, and the map
    objects: tuple  # originals
    box: object  # the empty, or None: the object's own period


def choose(context, *, source, tile=None, collection=None, box=None):
    """The Choice of objects; `tile`, `collection` and `box` are data of the scene or None. Raises ValueError."""
    if source == 'OBJECT':
        if tile is None:
            raise ValueError("No tile is chosen: pick the tile object in the sidebar, or give its name")
        return Choice(tile.name, (tile,), box)
    if source == 'SELECTION':
        objects = tuple(obj for obj in context.view_layer.objects if obj.select_get() and obj != box and is_source(obj))
        if not objects:
            raise ValueError("No object that shows a surface is selected: select the objects of the tile")
        name = objects[0].name if len(objects) == 1 else f"{objects[0].name} and {len(objects) - 1} more"
        return Choice(name, objects, box)
    if collection is None:
        raise ValueError("No collection is chosen: pick the tile's collection in the sidebar, or give its name")
    objects = tuple(obj for obj in collection.all_objects if obj != box and is_source(obj))
    if not objects:
        raise ValueError(f'The collection "{collection.name}" holds no object that shows a surface: put the tile\'s objects '
                         "into it, or pick another one")
    if not any(obj.visible_get(view_layer=context.view_layer) for obj in objects):
        raise ValueError(f'Nothing of the collection "{collection.name}" is visible in the view layer '
                         f'"{context.view_layer.name}": show it while you bake')
    return Choice(collection.name, objects, box)


def is_source(obj):
    """Whether an object may show a surface: an empty does if it instances a collection."""
    return obj.type in instances.SOURCE_TYPES and (obj.type != 'EMPTY' or obj.instance_type == 'COLLECTION')


def read(choice, depsgraph):
    """The TileSurface of a Choice; raises ValueError."""
    for obj in choice.objects if len(choice.objects) == 1 else ():
        # What is not part of the depsgraph is read as it is; with modifiers that would be the wrong shape.
        if not instances.is_evaluated(obj, depsgraph) and (len(obj.modifiers) > 0 or obj.type != 'MESH'):
            raise ValueError(f'Tile "{obj.name}" is disabled in viewports or in an excluded collection, so that it is not '
                             "evaluated: enable it (hiding it with H is fine)")
    return tile_source.read(choice.objects, box_of(choice, depsgraph), depsgraph, choice.name)


def box_of(choice, depsgraph):
    """The TileBox of a Choice; raises ValueError."""
    if choice.box is not None:
        return tile_box.of_empty(choice.box, choice.box.evaluated_get(depsgraph))
    if len(choice.objects) > 1:
        raise ValueError(f'Tile "{choice.name}" has no box: add one (Add Tile Box), since several objects make the tile')
    obj, = choice.objects
    if not obj.mesoshell_tile.is_tile:
        raise ValueError(f'"{obj.name}" is not a tile yet: add a tile box (Add Tile Box), or tick Tile and set its period '
                         "and height in the sidebar")
    return tile_box.of_object(obj, obj.evaluated_get(depsgraph))


def bounds(choice, axes, depsgraph):
    """(low, high) of what a Choice shows along the columns of `axes`; raises ValueError."""
    found = tile_source.bounds(choice.objects, axes, depsgraph)
    if found is None:
        raise ValueError(f'"{choice.name}" has no surface to put a box around: model the tile first, or pick another source')
    return found


def from_scene(context):
    """The Choice that the scene's settings name; raises ValueError."""
    settings = context.scene.mesoshell
    return choose(context, source=settings.source, tile=settings.tile, collection=settings.tile_collection,
                  box=settings.box)


def named(collection, name, what):
    """An item of a bpy collection by name; raises ValueError that says `what` (such as "object in the scene") is missing."""
    item = collection.get(name)
    if item is None:
        raise ValueError(f'There is no {what} called "{name}": check the name')
    return item
