"""Everything that one picture is made of, read from a depsgraph: shells, meshes, lamps, sky and film."""

from typing import NamedTuple

import numpy as np

from ..gpu import draw
from ..host import scene_camera, scene_lights, scene_meshes, shells, versions

_WIDEST_FILTER = 16.0  # pixels, that the native module takes


class Frame(NamedTuple):
    arguments: dict  # of the native render_scene
    depth_start: float  # what its depths are less than Blender's, which count from the camera
    notices: list  # sentences of what is not in the picture

    def sentence(self):
        """What is rendered."""
        return ", ".join(f"{len(self.arguments[name]):,} {name}" for name in ("shells", "meshes", "lights"))


def read(depsgraph, size):
    """The Frame of a depsgraph in mode RENDER, `size` being that of the whole picture in pixels; raises ValueError.

    A shell that can not be built is left out and noted.
    """
    scene, notices = depsgraph.scene, []
    render, settings = scene.render, scene.mesoshell_render
    view = scene_camera.read(depsgraph, size)
    return Frame({
        "clip_from_world": view.clip_from_world,
        "size": view.size,
        "shells": _shells(depsgraph, notices),
        "meshes": scene_meshes.read(depsgraph, notices),
        "lights": scene_lights.read(depsgraph),
        "world": scene_lights.world(depsgraph, notices),
        "samples": settings.samples,
        "seed": settings.seed,
        "filter_width": min(render.filter_size, _WIDEST_FILTER),
        "transparent": render.film_transparent,
        "threads": render.threads if render.threads_mode == 'FIXED' else 0,
    }, view.depth_start, notices)


def _shells(depsgraph, notices):
    shells.read_again(depsgraph)
    instances = shells.visible(depsgraph)
    objects = {versions.object_key(obj): obj for obj in shells.shown(depsgraph)}
    for obj in objects.values():
        problem = shells.problem(obj, modes=(depsgraph.mode,))
        if problem is not None:
            notices.append(f'The shell of "{obj.name}" is not rendered: {problem}')
    return [_shell(instance, objects[instance.place[0]].evaluated_get(depsgraph)) for instance in instances
            if np.linalg.det(instance.world_from_object[:3, :3]) != 0.0]  # scaled flat: nothing to see


def _shell(instance, obj):
    settings = instance.settings
    record = draw.settings_record(traversal=settings.traversal, base_color=settings.base_color, lights=None,
                                  world_from_object=instance.world_from_object, fins=settings.fins)
    return {"shell": instance.shell, "map": instance.map, "world_from_object": instance.world_from_object,
            "traversal": settings.traversal, "settings": record.tobytes(), "base_color": settings.base_color[:3],
            "object_index": obj.pass_index} | scene_meshes.visibility(obj)
