"""The draw programs, one a traversal and kind of fins, compiled on first use in the running Blender."""

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

_programs = {}  # (traversal, fins) -> GPUShader
_refused = {}  # the same -> the driver's answer, so that it is not asked again at every draw


def shell_program(traversal, fins):
    """The GPUShader of interface.toml for two numbers of the uniform block's mode.

    A program of all traversals takes a third longer on llvmpipe, which runs every branch, and more registers on any GPU.
    Raises RuntimeError with one sentence where it does not compile.
    """
    key = traversal, fins
    if key in _refused:
        raise RuntimeError(_SENTENCE) from _refused[key]
    if key not in _programs:
        try:
            _programs[key] = gpu.shader.create_from_info(_create_info(shader_source.shell_interface(), *key))
        except Exception as error:  # Blender raises a bare Exception
            _refused[key] = error
            raise RuntimeError(_SENTENCE) from error
    return _programs[key]


def forget():
    """Drop all programs, so that the next draws compile them again."""
    _programs.clear()
    _refused.clear()


def _create_info(interface, traversal, fins):
    info = gpu.types.GPUShaderCreateInfo()
    info.define("SHELL_TRAVERSAL", str(traversal))
    info.define("SHELL_FINS", str(fins))
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
