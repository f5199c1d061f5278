"""The depth of the scene's ordinary objects, rasterized by us where Blender gives its handlers none.

Meshes go to the GPU when they are first asked for, and again when the depsgraph says that their geometry changed.
"""

import bpy
import gpu
import numpy
from bpy.app.handlers import persistent
from mathutils import Matrix

from ..host import handlers, versions

_SOLID_TYPES = {'MESH', 'CURVE', 'SURFACE', 'FONT', 'META'}

_batches = {}  # (object key, pointer of the evaluated data) -> batch, or None for an object without faces
_used = {}  # the same key -> the last draw that used it
_draws = 0
_IDLE_DRAWS = 240


def draw(depsgraph, space, clip_from_world):
    """Replace the depth of the bound framebuffer by that of what `space` shows as surfaces."""
    global _draws
    _draws += 1
    shader = gpu.shader.from_builtin(versions.FLAT_COLOR_SHADER)
    gpu.state.active_framebuffer_get().clear(depth=1.0)
    gpu.state.color_mask_set(False, False, False, False)
    gpu.state.depth_test_set('LESS_EQUAL')
    gpu.state.depth_mask_set(True)
    try:
        shader.bind()
        shader.uniform_float("color", (0.0, 0.0, 0.0, 1.0))
        with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
            gpu.matrix.load_projection_matrix(Matrix(clip_from_world.tolist()))
            for instance in depsgraph.object_instances:
                obj = instance.object
                if not _shows_surface(instance, obj, space):
                    continue
                batch = _batch(obj)
                if batch is not None:
                    gpu.matrix.load_matrix(instance.matrix_world)
                    batch.draw(shader)
    finally:
        gpu.state.color_mask_set(True, True, True, True)
        gpu.state.depth_test_set('NONE')
        gpu.state.depth_mask_set(False)
    _drop([key for key, last in _used.items() if _draws - last > _IDLE_DRAWS])


def forget():
    """Drop everything."""
    _batches.clear()
    _used.clear()


def _drop(keys):
    for key in keys:
        del _batches[key], _used[key]


def _shows_surface(instance, obj, space):
    if obj.type not in _SOLID_TYPES or obj.display_type in {'WIRE', 'BOUNDS'} or not instance.show_self:
        return False
    shown = instance.parent if instance.is_instance else obj
    return shown.original.visible_in_viewport_get(space)


def _batch(obj):
    # A node-made instance has the original of the object whose nodes made it, and data of its own.
    key = versions.object_key(obj.original), obj.data.as_pointer()
    _used[key] = _draws
    if key not in _batches:
        mesh = obj.to_mesh()
        try:
            _batches[key] = _upload(mesh) if mesh is not None else None
        finally:
            obj.to_mesh_clear()
    return _batches[key]


def _upload(mesh):
    mesh.calc_loop_triangles()
    if not mesh.loop_triangles:
        return None
    positions = numpy.empty(len(mesh.vertices) * 3, numpy.float32)
    mesh.vertices.foreach_get("co", positions)
    corners = numpy.empty(len(mesh.loop_triangles) * 3, numpy.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    form = gpu.types.GPUVertFormat()
    form.attr_add(id="pos", comp_type='F32', len=3, fetch_mode='FLOAT')
    vertices = gpu.types.GPUVertBuf(form, len(mesh.vertices))
    vertices.attr_fill("pos", positions.reshape(-1, 3))
    indices = gpu.types.GPUIndexBuf(type='TRIS', seq=corners.reshape(-1, 3).astype(numpy.uint32))
    return gpu.types.GPUBatch(type='TRIS', buf=vertices, elem=indices)


@persistent
def _on_depsgraph_update(_scene, depsgraph):
    if not _batches:
        return
    changed = {versions.object_key(update.id.original) for update in depsgraph.updates
               if update.is_updated_geometry and isinstance(update.id, bpy.types.Object)}
    _drop([key for key in _batches if key[0] in changed])


@persistent
def _on_other_data(*_arguments):
    forget()


_HANDLERS = (("depsgraph_update_post", _on_depsgraph_update), ("frame_change_post", _on_other_data),
             ("undo_post", _on_other_data), ("redo_post", _on_other_data), ("load_post", _on_other_data))


def register():
    handlers.add(_HANDLERS)


def unregister():
    handlers.remove(_HANDLERS)
    forget()
