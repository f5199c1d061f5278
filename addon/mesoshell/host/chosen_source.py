"""What a bake is of, from the scene's settings and what a call gives instead: objects and a box, an image, or a file."""

import os
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..core import grid_file, grid_tile, height_field, variation
from ..core.tile_options import TileOptions
from . import images, instances, paths, tile_box, tile_source


class Choice(NamedTuple):
    name: str  # for sentences, and the map
    objects: tuple = ()  # originals
    box: object = None  # the empty, or None: the object's own period, or the bounds of what a file holds
    image: object = None  # bpy.types.Image of a height field, or the path of one
    grid_path: str = ""  # of a .npy or .vdb file


def choose(context, *, source, tile=None, collection=None, box=None, image=None, grid_path=""):
    """The Choice of a source; `tile`, `collection`, `box` and `image` are Blender's data or None.

    An image may also be a path. Raises ValueError.
    """
    if source == 'IMAGE':
        if image is None:
            raise ValueError("No image is chosen: pick a height field in the sidebar, or give the name or path of one")
        return Choice(os.path.basename(image) if isinstance(image, str) else image.name, image=image)
    if source == 'FILE':
        path = paths.absolute(grid_path, what="grid")
        if not path.lower().endswith((".npy", ".vdb")):
            raise ValueError(f"{path} is no grid that can be read: choose a .vdb file, or a .npy file of NumPy's")
        return Choice(os.path.basename(path), box=box, grid_path=path)
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


def may_be_volume(context):
    """Whether the scene's settings name a volume, for panels: its threshold matters then."""
    settings = context.scene.mesoshell
    objects = {'OBJECT': (settings.tile,) if settings.tile else (), 'SELECTION': context.selected_objects,
               'COLLECTION': settings.tile_collection.all_objects if settings.tile_collection else ()}[settings.source]
    return any(obj.type == 'VOLUME' for obj in objects)


def read(choice, depsgraph, options=TileOptions()):
    """The TileSurface of a Choice, made of it as TileOptions say; raises ValueError or OSError."""
    if choice.image is not None:
        surface = _image_surface(choice, options)
    elif choice.grid_path:
        surface = _grid_surface(choice, depsgraph, options)
    else:
        surface = _objects_surface(choice, depsgraph, options)
    if options.periodic == 'MIRROR':
        notice = (f'Tile "{choice.name}" is 2 × 2 mirrored copies: its nodes are spread over all four, and its period is '
                  "twice as wide")
        surface = replace(surface, notices=(*surface.notices, notice))
    return variation.varied(surface, options.copies, options.variation, options.seed)


def _image_surface(choice, options):
    def surface(image):
        notices = []
        heights = images.heights(image, notices)
        return height_field.surface_of(heights, options, name=choice.name, notices=notices)

    if not isinstance(choice.image, str):
        return surface(choice.image)
    with images.heights_file(choice.image) as image:
        return surface(image)


def _grid_surface(choice, depsgraph, options):
    if choice.grid_path.lower().endswith(".vdb"):
        box = None if choice.box is None else box_of(choice, depsgraph)
        return tile_source.read_file(choice.grid_path, box, depsgraph.scene, options)
    return grid_tile.surface_of(grid_file.load(choice.grid_path), options.threshold, options.grid_height or None,
                                inside=options.inside.lower(), options=options, name=choice.name)


def _objects_surface(choice, depsgraph, options):
    for obj in choice.objects if len(choice.objects) == 1 else ():
        # What is not part of the depsgraph is read as it is; with modifiers that would be the wrong shape.
        if not instances.is_evaluated(obj, depsgraph) and (len(obj.modifiers) > 0 or obj.type != 'MESH'):
            raise ValueError(f'Tile "{obj.name}" is disabled in viewports or in an excluded collection, so that it is not '
                             "evaluated: enable it (hiding it with H is fine)")
    return tile_source.read(choice.objects, box_of(choice, depsgraph), depsgraph, choice.name, options)


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


def axes_of(choice):
    """The axes of a box around a Choice, by columns: one object's own fit it best, several share those of the world."""
    return tile_box.frame(choice.objects[0].matrix_world if len(choice.objects) == 1 else np.eye(3))


def bounds(choice, axes, depsgraph, options):
    """(low, high) of what a Choice shows along the columns of `axes`; raises ValueError."""
    if not choice.objects:
        raise ValueError(f'"{choice.name}" is a tile by itself and needs no box: to put one in a .vdb file, add the file as '
                         "a volume object and bake that")
    found = tile_source.bounds(choice.objects, axes, depsgraph, options)
    if found is None:
        raise ValueError(f'"{choice.name}" has no surface to put a box around: model the tile first, or pick another source')
    return found


def from_scene(context):
    """The Choice that the scene's settings name; raises ValueError."""
    settings = context.scene.mesoshell
    return choose(context, source=settings.source, tile=settings.tile, collection=settings.tile_collection,
                  box=settings.box, image=settings.image, grid_path=settings.grid_path)


def named(collection, name, what):
    """An item of a bpy collection by name; raises ValueError that says `what` (such as "object in the scene") is missing."""
    item = collection.get(name)
    if item is None:
        raise ValueError(f'There is no {what} called "{name}": check the name')
    return item
