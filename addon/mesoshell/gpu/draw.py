"""Draws shells into whatever framebuffer is bound: the viewport's handler, an offscreen picture and the tests all call it."""

import gpu
import numpy
from mathutils import Matrix

from ..core import native, shader_source
from . import program, resources

TRAVERSALS = {"gdm": 0, "sdf": 1, "march": 3, "slices": 4, "refined": 2}  # shaders/lib/traverse.glsl
FINS = {"exact": 0, "paper": 1}  # shaders/lib/shell_hit.glsl
OUTPUTS = {"color": 0, "texture": 1, "normal": 2}  # shaders/lib/pixel.glsl


def settings_record(*, traversal, base_color, lights, world_from_object, output="color", fins="exact"):
    """The uniform block before map and view are known: a NumPy record of shaders/interface.toml.

    `lights` has toward_sun, sun_color and ambient, linear RGB or world-space [3]; None keeps the defaults.
    `fins`: "exact" bilinear patches, or "paper", two planes each.
    """
    record = shader_source.shell_interface().defaults()
    normal_matrix = numpy.eye(4)
    normal_matrix[:3, :3] = numpy.linalg.inv(world_from_object[:3, :3]).T
    record["world_from_object_normal"] = normal_matrix.T  # columns first
    record["base_color"] = base_color
    if lights is not None:
        record["light_world"][:3] = lights.toward_sun
        record["light_color"][:3] = lights.sun_color
        record["ambient_color"][:3] = lights.ambient
    record["mode"] = (TRAVERSALS[traversal], OUTPUTS[output], FINS[fins], 0)
    return record


def draw_shell(instance, clip_from_world, lights, *, output="color"):
    """Draw one ShellInstance (host/shells.py) with depth test and depth write; the state is as before afterwards.

    Colors are linear: the viewport's framebuffer encodes sRGB as it is written.
    `clip_from_world` is float64 [4, 4], OpenGL clip space. Raises RuntimeError where the shader does not compile.
    """
    world_from_object = instance.world_from_object
    determinant = numpy.linalg.det(world_from_object[:3, :3])
    if determinant == 0.0:
        return  # scaled flat: nothing to see
    clip_from_object = clip_from_world @ world_from_object
    record = settings_record(
        traversal=instance.settings.traversal,
        base_color=instance.settings.base_color,
        lights=lights,
        world_from_object=world_from_object,
        output=output,
        fins=instance.settings.fins,
    )
    block = native.module().shell_params(record.tobytes(), instance.map, clip_from_object)
    shader = program.shell_program(TRAVERSALS[instance.settings.traversal], FINS[instance.settings.fins])
    shell = resources.shell_resources(instance.shell, instance.place, instance.shell_version)
    tile_map = resources.map_resources(instance.map, instance.map_version)

    before = gpu.state.depth_test_get(), gpu.state.depth_mask_get(), gpu.state.blend_get()
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(True)
    gpu.state.blend_set("NONE")
    # The far sides of the hulls cover the same pixels as the near ones, and also those of a camera inside a prism.
    gpu.state.face_culling_set("FRONT" if determinant > 0.0 else "BACK")
    try:
        shader.bind()
        block_buffer = gpu.types.GPUUniformBuf(block)  # the binding does not keep it alive, this name does
        shader.uniform_block(shader_source.shell_interface().instance, block_buffer)
        shader.uniform_float("clip_from_object", Matrix(clip_from_object.tolist()))
        shader.uniform_sampler("prism_table", shell.prism_table)
        shader.uniform_sampler("gdm_weights", tile_map.gdm_weights)
        shader.uniform_sampler("gdm_eigenmaps", tile_map.gdm_eigenmaps)
        shader.uniform_sampler("sdf_volume", tile_map.sdf_volume)
        shader.uniform_sampler("density_volume", tile_map.density_volume)
        shader.uniform_sampler("facet_volume", tile_map.facet_volume)
        shell.hulls.draw(shader)
    finally:
        depth_test, depth_mask, blend = before
        gpu.state.face_culling_set("NONE")
        gpu.state.depth_test_set(depth_test)
        gpu.state.depth_mask_set(depth_mask)
        gpu.state.blend_set(blend)
