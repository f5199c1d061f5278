"""The draw handler of the 3D View: every visible shell, after Blender's own objects, against their depth."""

import traceback

import bpy
import numpy

from ..host import lights, shells, versions
from . import draw, overlays, program, resources, scene_depth

_handle = None
_problem = None


def problem():
    """The sentence of what keeps shells from being drawn, or None."""
    return _problem


def _draw():
    context = bpy.context
    depsgraph = context.evaluated_depsgraph_get()
    problems = []
    try:
        instances = shells.visible(depsgraph, context.space_data)
        if instances:
            clip_from_world = numpy.array(context.region_data.perspective_matrix, numpy.float64)
            lit = lights.read(depsgraph)
            if not versions.handlers_see_depth(context.space_data, context.scene.render.engine):
                scene_depth.draw(depsgraph, context.space_data, clip_from_world)
        for instance in instances:
            try:
                draw.draw_shell(instance, clip_from_world, lit)
            except Exception as error:  # the others are drawn all the same
                problems.append((f'"{instance.object_name}": {error}', error))
        if context.space_data.overlay.show_overlays:
            problems += _draw_overlays(instances, context, clip_from_world if instances else None)
    except Exception as error:
        problems.append((str(error), error))
    finally:
        resources.end_draw()
        overlays.end_draw()
    _report(problems)


def _draw_overlays(instances, context, clip_from_world):
    """After all shells, so that none hides what is drawn over another; returns problems, as (sentence, error)."""
    problems = []
    settings, region = context.scene.mesoshell_overlays, context.region
    for instance in instances:
        try:
            overlays.draw(instance, settings, clip_from_world, (region.width, region.height))
        except Exception as error:
            problems.append((f'Overlays of "{instance.object_name}": {error}', error))
    return problems


def _report(problems):
    """Keep the first sentence for the panel, and print what was not printed before."""
    global _problem
    sentence = problems[0][0] if problems else None
    if sentence is not None and sentence != _problem:
        traceback.print_exception(problems[0][1])
    _problem = sentence


def register():
    global _handle
    scene_depth.register()
    _handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW")


def unregister():
    global _handle, _problem
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None
    _problem = None
    scene_depth.unregister()
    resources.forget()
    overlays.forget()
    program.forget()
