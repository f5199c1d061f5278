"""The draw program, compiled on first use in the running Blender."""

import gpu

from ..core import shader_source

# Blender's names for the GLSL types of interface.toml.
_TYPES = {
    "float": "FLOAT",
    "vec3": "VEC3",
    "vec4": "VEC4",
    "mat4": "MAT4",
    "int": "INT",
    "uint": "UINT",
    "sampler2D": "FLOAT_2D",
    "sampler3D": "FLOAT_3D",
}

_SENTENCE = "The graphics driver refused Mesoshell's shader; the log above says why. Update the driver."

_program = None
_refused = None  # the driver's answer, so that it is not asked again at every draw


def shell_program():
    """The GPUShader of interface.toml; raises RuntimeError with one sentence where it does not compile."""
    global _program, _refused
    if _refused is not None:
        raise RuntimeError(_SENTENCE) from _refused
    if _program is None:
        try:
            _program = gpu.shader.create_from_info(_create_info(shader_source.shell_interface()))
        except Exception as error:  # Blender raises a bare Exception
            _refused = error
            raise RuntimeError(_SENTENCE) from error
    return _program


def forget():
    """Drop the program, so that the next draw compiles it again."""
    global _program, _refused
    _program = _refused = None
_refused = None  # the driver's answer, so that it is not asked again at every draw


def _create_info(interface):
    info = gpu.types.GPUShaderCreateInfo()
    info.typedef_source(interface.glsl_struct())
    info.uniform_buf(0, interface.struct, interface.instance)
    for name, kind in interface.push_constants.items():
        info.push_constant(_TYPES[kind], name)
    for slot, (name, kind) in enumerate(interface.samplers.items()):
        info.sampler(slot, _TYPES[kind], name)
    for slot, (name, kind) in enumerate(interface.vertex_in.items()):
        info.vertex_in(slot, _TYPES[kind], name)
    varying = gpu.types.GPUStageInterfaceInfo("mesoshell_varying")
    for name, kind in interface.varying.items():
        interpolation, kind = kind.split()
        getattr(varying, interpolation)(_TYPES[kind], name)
    info.vertex_out(varying)
    for slot, (name, kind) in enumerate(interface.fragment_out.items()):
        info.fragment_out(slot, _TYPES[kind], name)
    if hasattr(info, "depth_write"):  # where it exists, gl_FragDepth must be declared
        info.depth_write("ANY")
    info.vertex_source(shader_source.stage("shell.vert"))
    info.fragment_source(shader_source.stage("shell.frag"))
    return info
