"""Overlays of shells: edges of prisms, folds, stretch and cut seams, drawn into whatever framebuffer is bound.

What they show is computed when it is first drawn, and again for another version of a shell; one place holds one version.
"""

import gpu
import numpy
from mathutils import Matrix

from ..core import native, overlay_shapes
from ..host import shell_checks, versions

# Overlays lie this share of their distance before what they are drawn on; less of it lets the depth buffer choose.
_NEARER = 0.002
_LINE_WIDTH, _SEAM_WIDTH = 1.0, 3.0  # pixels
_FIN_OPACITY = 0.35  # of a cut seam's color, on the fin above it
_HIDDEN_OPACITY = 0.35  # of the edges of folds behind what hides them: most lie deep in a narrow place

# What none of this many draws showed is dropped.
_IDLE_DRAWS = 240

_batches = {}  # (place, what) -> [what it was made of, batches, last draw]
_draws = 0


def draw(instance, settings, clip_from_world, size):
    """Draw what `settings` (host/overlay_options.py) ask for, of one ShellInstance; the state is as before afterwards.

    clip_from_world  float64 [4, 4], OpenGL clip space
    size             width and height of the target in pixels, for the widths of lines
    """
    if not settings.any_shown():
        return
    clip_from_object = _drawn_nearer(instance, clip_from_world) @ instance.world_from_object
    before = gpu.state.depth_test_get(), gpu.state.depth_mask_get(), gpu.state.blend_get()
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(False)
    gpu.state.blend_set("ALPHA")
    try:
        with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
            gpu.matrix.load_matrix(Matrix.Identity(4))
            gpu.matrix.load_projection_matrix(Matrix(clip_from_object.tolist()))
            if settings.show_stretch:
                _draw_stretch(instance, settings)
            if settings.show_folds:
                _draw_folds(instance, settings, size)
            if settings.show_seams:
                _draw_seams(instance, settings, size)
            if settings.show_prisms:
                _draw_lines(_kept(instance, "prisms", None, _wires), settings.prism_color, _LINE_WIDTH, size)
    finally:
        depth_test, depth_mask, blend = before
        gpu.state.depth_test_set(depth_test)
        gpu.state.depth_mask_set(depth_mask)
        gpu.state.blend_set(blend)


def end_draw():
    """Count a draw, and drop what has not been drawn for long."""
    global _draws
    _draws += 1
    for key in [key for key, held in _batches.items() if _draws - held[2] > _IDLE_DRAWS]:
        del _batches[key]


def forget():
    """Drop everything."""
    _batches.clear()


def _drawn_nearer(instance, clip_from_world):
    reach = float(numpy.linalg.norm(instance.world_from_object[:3, :3], 2)
                  * numpy.linalg.norm(numpy.diff(instance.shell.bounds, axis=0)))
    return clip_from_world @ overlay_shapes.nearer(native.module().eye(clip_from_world), _NEARER, reach)


def _draw_stretch(instance, settings):
    most = settings.most_stretch if settings.measure == "rms" else settings.most_angle
    colors = tuple(tuple(color) for color in (settings.low_color, settings.even_color, settings.high_color))
    batch = _kept(instance, "stretch", (settings.measure, most, colors), _tops)
    if batch is None:
        return
    shader = gpu.shader.from_builtin(versions.SMOOTH_COLOR_SHADER)
    gpu.state.depth_mask_set(True)  # folds and seams must not shine through from the far side
    shader.bind()
    batch.draw(shader)
    gpu.state.depth_mask_set(False)


def _draw_folds(instance, settings, size):
    own, base = _kept(instance, "folds", None, _folds)
    for batches, color in ((base, settings.base_fold_color), (own, settings.fold_color)):
        if batches is not None:
            gpu.state.depth_test_set("ALWAYS")
            _draw_lines(batches[1], (*color[:3], _HIDDEN_OPACITY), _LINE_WIDTH, size)
            gpu.state.depth_test_set("LESS_EQUAL")
            _fill(batches[0], color)
            _draw_lines(batches[1], (*color[:3], 1.0), _LINE_WIDTH, size)


def _draw_seams(instance, settings, size):
    batches = _kept(instance, "seams", None, _seams)
    if batches is not None:
        color = tuple(settings.seam_color)
        _fill(batches[0], (*color[:3], _FIN_OPACITY * color[3]))
        _draw_lines(batches[1], color, _SEAM_WIDTH, size)


def _fill(batch, color):
    shader = gpu.shader.from_builtin(versions.FLAT_COLOR_SHADER)
    shader.bind()
    shader.uniform_float("color", tuple(color))
    batch.draw(shader)


def _draw_lines(batch, color, width, size):
    shader = gpu.shader.from_builtin(versions.LINE_SHADER)
    shader.bind()
    shader.uniform_float("viewportSize", size)
    shader.uniform_float("lineWidth", width)
    shader.uniform_float("color", tuple(color))
    batch.draw(shader)


def _kept(instance, what, how, make):
    """What make(instance, how) made of this version of a shell."""
    made_of = (instance.shell_version, how)
    held = _batches.get((instance.place, what))
    if held is None or held[0] != made_of:
        held = _batches[instance.place, what] = [made_of, make(instance, how), _draws]
    held[2] = _draws
    return held[1]


def _wires(instance, _how):
    vertices, edges = overlay_shapes.wires(instance.shell)
    return _batch('LINES', vertices, edges)


def _folds(instance, _how):
    made = []
    for marked in shell_checks.folded(shell_checks.folds(instance)):
        if not marked.any():
            made.append(None)
            continue
        vertices, triangles, edges = overlay_shapes.hulls(instance.shell, marked)
        made.append((_batch('TRIS', vertices, triangles), _batch('LINES', vertices, edges)))
    return made


def _seams(instance, _how):
    found = shell_checks.seams(instance)
    if not len(found["edges"]):
        return None
    vertices, triangles, lines = overlay_shapes.ribbons(found["edges"], found["tops"])
    return _batch('TRIS', vertices, triangles), _batch('LINES', vertices, lines)


def _tops(instance, how):
    measure, most, colors = how
    values = numpy.asarray(shell_checks.stretch(instance)[measure], numpy.float64)
    levels = (overlay_shapes.stretch_level if measure == "rms" else overlay_shapes.angle_level)(values, most)
    vertices, triangles, levels = overlay_shapes.tops(instance.shell, levels)
    return _batch('TRIS', vertices, triangles, overlay_shapes.gradient(levels, *colors))


def _batch(kind, vertices, indices, colors=None):
    form = gpu.types.GPUVertFormat()
    form.attr_add(id="pos", comp_type='F32', len=3, fetch_mode='FLOAT')
    if colors is not None:
        form.attr_add(id="color", comp_type='F32', len=4, fetch_mode='FLOAT')
    buffer = gpu.types.GPUVertBuf(form, len(vertices))
    buffer.attr_fill("pos", numpy.ascontiguousarray(vertices, numpy.float32))
    if colors is not None:
        buffer.attr_fill("color", colors)
    return gpu.types.GPUBatch(type=kind, buf=buffer, elem=gpu.types.GPUIndexBuf(type=kind, seq=indices))
