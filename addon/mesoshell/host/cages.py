"""The mesh that a shell is read from: as Blender evaluates it, its control cage, or the mesh at rest.

The cage is the mesh without the Subdivision Surface modifiers at the end of its stack. Where other modifiers or shape keys
shape it, they are evaluated once more with those switched off on the evaluated object: its flags are set by foreach_set,
which notifies nobody, so that a draw handler may do it and no data-block is made. In Edit mode the cage is the mesh that is
edited, without modifiers; a render asks for what Object mode shows.
"""

from contextlib import contextmanager
from typing import NamedTuple

import bmesh

from .shell_options import MODIFIER_BOUNDARIES, MODIFIER_SCHEMES, MODIFIER_UV_RULES

MOST_LEVELS = 8  # that the native module takes


class Subdivision(NamedTuple):
    """What the native build_shell is told of the refinement."""

    levels: int
    scheme: str
    boundary: str
    uv_rule: str
    creases: bool


def subdivision(obj, depsgraph):
    """The Subdivision of the Subdivision Surface modifiers at the end of an object's stack; ValueError if there is none.

    Levels of several are added, all else is that of the first. The limit surface is taken whether or not the modifier does.
    """
    trailing = _trailing(obj, depsgraph)
    if not trailing:
        raise ValueError(f'"{obj.name}" has no Subdivision Surface modifier at the end of its stack: add one, or set '
                         "Subdivision to Own")
    name = "render_levels" if depsgraph.mode == 'RENDER' else "levels"
    first = trailing[0]
    levels = min(sum(getattr(modifier, name) for modifier in trailing), MOST_LEVELS)
    render = depsgraph.scene.render
    if render.use_simplify:
        levels = min(levels, render.simplify_subdivision_render if depsgraph.mode == 'RENDER' else
                     render.simplify_subdivision)
    return Subdivision(levels, MODIFIER_SCHEMES[first.subdivision_type], MODIFIER_BOUNDARIES[first.boundary_smooth],
                       MODIFIER_UV_RULES[first.uv_smooth], first.use_creases)


@contextmanager
def mesh_of(obj, depsgraph, *, cage=False, layers=False):
    """The mesh of an object while the block runs: evaluated, or its cage. ValueError.

    `layers` asks for what Blender leaves out of evaluated meshes where it needs it not, such as vertex groups.
    """
    evaluated = _evaluated(obj, depsgraph)
    switched_off = _trailing(obj, depsgraph) if cage else []
    edits = obj.data.is_editmode and depsgraph.mode != 'RENDER'
    if cage and edits or _is_at_rest(obj, depsgraph, switched_off):
        with rest_mesh(obj) as mesh:
            yield mesh
        return
    flags = _flags(evaluated, depsgraph)
    keep_all = layers and bool(obj.modifiers) and not edits
    try:
        if switched_off:
            off = {modifier.name for modifier in switched_off}
            evaluated.modifiers.foreach_set(_flag_name(depsgraph), [flag and modifier.name not in off for modifier, flag
                                                                    in zip(evaluated.modifiers, flags)])
        anew = dict(preserve_all_data_layers=True, depsgraph=depsgraph) if switched_off or keep_all else {}
        mesh = evaluated.to_mesh(**anew)
    except RuntimeError as error:
        raise ValueError(f'"{evaluated.name}" has no mesh: pick a mesh object') from error
    finally:
        if switched_off:
            evaluated.modifiers.foreach_set(_flag_name(depsgraph), flags)
    try:
        yield mesh
    finally:
        evaluated.to_mesh_clear()


@contextmanager
def rest_mesh(obj):
    """An object's own mesh, without modifiers, while the block runs; in Edit mode as it is edited."""
    if not obj.data.is_editmode:
        yield obj.data
        return
    mesh = obj.to_mesh()
    try:
        # A copy of what the mesh was when Edit mode began, of which nothing is left then.
        bmesh.from_edit_mesh(obj.data).to_mesh(mesh)
        yield mesh
    finally:
        obj.to_mesh_clear()


def _evaluated(obj, depsgraph):
    evaluated = obj.evaluated_get(depsgraph)
    # An object that is not part of the depsgraph is read as it is; with modifiers that would be the wrong shape.
    if not evaluated.is_evaluated and len(obj.modifiers) > 0:
        raise ValueError(f'Surface "{obj.name}" is disabled in viewports or in an excluded collection, so that its '
                         "modifiers are not evaluated: enable it (hiding it with H is fine), or apply them")
    return evaluated


def _flag_name(depsgraph):
    return "show_render" if depsgraph.mode == 'RENDER' else "show_viewport"


def _flags(obj, depsgraph):
    return [getattr(modifier, _flag_name(depsgraph)) for modifier in obj.modifiers]


def _trailing(obj, depsgraph):
    """The Subdivision Surface modifiers with nothing enabled behind them, in the stack's order.

    Disabled ones count: who hides one, so that Blender need not subdivide, still means its settings.
    """
    trailing = []
    for modifier, enabled in reversed(list(zip(obj.modifiers, _flags(obj, depsgraph)))):
        if modifier.type == 'SUBSURF':
            trailing.insert(0, modifier)
        elif enabled:
            break
    return trailing


def _is_at_rest(obj, depsgraph, switched_off):
    """Whether nothing but the modifiers `switched_off` shapes an object, so that its own mesh need not be copied."""
    others = sum(_flags(obj, depsgraph)) - sum(getattr(modifier, _flag_name(depsgraph)) for modifier in switched_off)
    mesh = obj.data
    return others == 0 and not mesh.is_editmode and mesh.shape_keys is None and mesh.animation_data is None
