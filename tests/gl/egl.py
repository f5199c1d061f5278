"""A surfaceless EGL context and the draw program in it: the shader text without Blender."""

import ctypes
import os

os.environ.setdefault("PYOPENGL_PLATFORM", "egl")
os.environ.setdefault("EGL_PLATFORM", "surfaceless")

import numpy
from core import packing, shader_source  # the add-on's core, which knows no Blender; conftest.py has put it on the path
from OpenGL import EGL, GL


def make_context():
    """Make a desktop OpenGL 4.5 core context current on the surfaceless platform; returns what keeps it alive."""
    display = EGL.eglGetDisplay(EGL.EGL_DEFAULT_DISPLAY)
    major, minor = EGL.EGLint(), EGL.EGLint()
    assert EGL.eglInitialize(display, major, minor), "EGL does not start: install libegl1 and libgl1-mesa-dri"
    assert EGL.eglBindAPI(EGL.EGL_OPENGL_API)
    wanted = [EGL.EGL_RENDERABLE_TYPE, EGL.EGL_OPENGL_BIT, EGL.EGL_SURFACE_TYPE, EGL.EGL_PBUFFER_BIT, EGL.EGL_NONE]
    configs = (EGL.EGLConfig * 1)()
    count = EGL.EGLint()
    assert EGL.eglChooseConfig(display, (EGL.EGLint * len(wanted))(*wanted), configs, 1, count) and count.value == 1
    version = [
        EGL.EGL_CONTEXT_MAJOR_VERSION,
        4,
        EGL.EGL_CONTEXT_MINOR_VERSION,
        5,
        EGL.EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL.EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        EGL.EGL_NONE,
    ]
    context = EGL.eglCreateContext(display, configs[0], EGL.EGL_NO_CONTEXT, (EGL.EGLint * len(version))(*version))
    assert EGL.eglMakeCurrent(display, EGL.EGL_NO_SURFACE, EGL.EGL_NO_SURFACE, context)
    return display, context


def compile_program(**stages):
    """A linked program from keyword arguments vert=, frag= or comp= of GLSL text; the driver's log is the error."""
    kinds = {"vert": GL.GL_VERTEX_SHADER, "frag": GL.GL_FRAGMENT_SHADER, "comp": GL.GL_COMPUTE_SHADER}
    program = GL.glCreateProgram()
    for stage, text in stages.items():
        shader = GL.glCreateShader(kinds[stage])
        GL.glShaderSource(shader, text)
        GL.glCompileShader(shader)
        assert GL.glGetShaderiv(shader, GL.GL_COMPILE_STATUS), GL.glGetShaderInfoLog(shader).decode()
        GL.glAttachShader(program, shader)
    GL.glLinkProgram(program)
    assert GL.glGetProgramiv(program, GL.GL_LINK_STATUS), GL.glGetProgramInfoLog(program).decode()
    return program


def texture(target, form, texels):
    """A texture of float32 texels [..., height, width, channels]; trilinear, clamped to the edge."""
    name = int(GL.glGenTextures(1))
    GL.glBindTexture(target, name)
    channels = {1: GL.GL_RED, 4: GL.GL_RGBA}[texels.shape[-1]]
    size = texels.shape[-2::-1]
    GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
    if target == GL.GL_TEXTURE_3D:
        GL.glTexImage3D(target, 0, form, *size, 0, channels, GL.GL_FLOAT, texels)
        GL.glTexParameteri(target, GL.GL_TEXTURE_WRAP_R, GL.GL_CLAMP_TO_EDGE)
    else:
        GL.glTexImage2D(target, 0, form, *size, 0, channels, GL.GL_FLOAT, texels)
    for name_of, value in (
        (GL.GL_TEXTURE_WRAP_S, GL.GL_CLAMP_TO_EDGE),
        (GL.GL_TEXTURE_WRAP_T, GL.GL_CLAMP_TO_EDGE),
        (GL.GL_TEXTURE_MIN_FILTER, GL.GL_LINEAR),
        (GL.GL_TEXTURE_MAG_FILTER, GL.GL_LINEAR),
        (GL.GL_TEXTURE_MAX_LEVEL, 0),
    ):
        GL.glTexParameteri(target, name_of, value)
    return name


class Inputs:
    """A shell and a map on the GPU, bound to the slots of interface.toml."""

    def __init__(self, shell, tile_map):
        self.textures = [
            (GL.GL_TEXTURE_2D, texture(GL.GL_TEXTURE_2D, GL.GL_RGBA32F, packing.prism_table(shell.prisms))),
            (GL.GL_TEXTURE_3D, texture(GL.GL_TEXTURE_3D, GL.GL_RGBA16F, packing.gdm_weights(tile_map.weights))),
            (GL.GL_TEXTURE_3D, texture(GL.GL_TEXTURE_3D, GL.GL_RGBA16F, packing.gdm_eigenmaps(tile_map.eigenmaps))),
            (GL.GL_TEXTURE_3D, texture(GL.GL_TEXTURE_3D, GL.GL_R16F, packing.sdf_volume(tile_map.sdf))),
            (GL.GL_TEXTURE_3D, texture(GL.GL_TEXTURE_3D, GL.GL_R16F, packing.density_volume(tile_map.sdf))),
            (GL.GL_TEXTURE_3D, texture(GL.GL_TEXTURE_3D, GL.GL_RGBA32F, packing.facet_volume(tile_map))),
        ]
        self.block = int(GL.glGenBuffers(1))

    def bind(self, block):
        """Bind textures and the uniform block's bytes."""
        for slot, (target, name) in enumerate(self.textures):
            GL.glActiveTexture(GL.GL_TEXTURE0 + slot)
            GL.glBindTexture(target, name)
        GL.glBindBuffer(GL.GL_UNIFORM_BUFFER, self.block)
        GL.glBufferData(GL.GL_UNIFORM_BUFFER, len(block), block, GL.GL_STATIC_DRAW)
        GL.glBindBufferBase(GL.GL_UNIFORM_BUFFER, 0, self.block)

    def release(self):
        GL.glDeleteTextures([name for _, name in self.textures])
        GL.glDeleteBuffers(1, [self.block])


def shell_program(traversal=None, fins=None):
    """The draw program, compiled from the shaders of the add-on with the EGL preamble.

    For one traversal and kind of fins, as the add-on draws, or without them for whatever the uniform block says.
    """
    interface = shader_source.shell_interface()
    chosen = {"SHELL_TRAVERSAL": traversal, "SHELL_FINS": fins}
    defines = "".join(f"#define {name} {value}\n" for name, value in chosen.items() if value is not None)
    return compile_program(
        vert=interface.glsl_preamble("vert") + shader_source.stage("shell.vert"),
        frag=interface.glsl_preamble("frag") + defines + shader_source.stage("shell.frag"),
    )


class Frame:
    """A target of `size` (width, height) and a shell's hulls, for as many draws as wanted; release() frees both."""

    def __init__(self, shell, size):
        self.size = width, height = size
        self.color = texture(GL.GL_TEXTURE_2D, GL.GL_RGBA32F, numpy.zeros((height, width, 4), numpy.float32))
        self.depth = int(GL.glGenRenderbuffers(1))
        GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, self.depth)
        GL.glRenderbufferStorage(GL.GL_RENDERBUFFER, GL.GL_DEPTH_COMPONENT32F, width, height)
        self.target = int(GL.glGenFramebuffers(1))
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.target)
        GL.glFramebufferTexture2D(GL.GL_FRAMEBUFFER, GL.GL_COLOR_ATTACHMENT0, GL.GL_TEXTURE_2D, self.color, 0)
        GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, GL.GL_DEPTH_ATTACHMENT, GL.GL_RENDERBUFFER, self.depth)
        assert GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER) == GL.GL_FRAMEBUFFER_COMPLETE
        self.vertices = int(GL.glGenVertexArrays(1))
        GL.glBindVertexArray(self.vertices)
        corners = packing.hull_corners(shell.prism_count)
        indices = numpy.ascontiguousarray(shell.indices).reshape(-1)
        self.index_count = len(indices)
        self.buffers = [int(name) for name in GL.glGenBuffers(2)]
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self.buffers[0])
        GL.glBufferData(GL.GL_ARRAY_BUFFER, corners.nbytes, corners, GL.GL_STATIC_DRAW)
        GL.glEnableVertexAttribArray(0)
        GL.glVertexAttribIPointer(0, 1, GL.GL_UNSIGNED_INT, 4, ctypes.c_void_p(0))
        GL.glBindBuffer(GL.GL_ELEMENT_ARRAY_BUFFER, self.buffers[1])
        GL.glBufferData(GL.GL_ELEMENT_ARRAY_BUFFER, indices.nbytes, indices, GL.GL_STATIC_DRAW)

    def draw(self, program, inputs, block, clip_from_object):
        """Draw as the viewport does, into a cleared target; the uniform block's bytes are `block`."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.target)
        GL.glBindVertexArray(self.vertices)
        GL.glViewport(0, 0, *self.size)
        GL.glClearColor(0.0, 0.0, 0.0, 0.0)
        GL.glClearDepth(1.0)
        GL.glClear(GL.GL_COLOR_BUFFER_BIT | GL.GL_DEPTH_BUFFER_BIT)
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LEQUAL)
        GL.glEnable(GL.GL_CULL_FACE)
        GL.glCullFace(GL.GL_FRONT)
        inputs.bind(block)
        GL.glUseProgram(program)
        columns = numpy.asarray(clip_from_object, numpy.float32).T.copy()
        GL.glUniformMatrix4fv(GL.glGetUniformLocation(program, "clip_from_object"), 1, False, columns)
        GL.glDrawElements(GL.GL_TRIANGLES, self.index_count, GL.GL_UNSIGNED_INT, None)

    def read(self):
        """(color float32 [h, w, 4], depth float32 [h, w]); row 0 is the bottom."""
        width, height = self.size
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.target)
        pixels = GL.glReadPixels(0, 0, width, height, GL.GL_RGBA, GL.GL_FLOAT)
        depths = GL.glReadPixels(0, 0, width, height, GL.GL_DEPTH_COMPONENT, GL.GL_FLOAT)
        return (
            numpy.frombuffer(pixels, numpy.float32).reshape(height, width, 4),
            numpy.frombuffer(depths, numpy.float32).reshape(height, width),
        )

    def release(self):
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
        GL.glDeleteFramebuffers(1, [self.target])
        GL.glDeleteRenderbuffers(1, [self.depth])
        GL.glDeleteTextures([self.color])
        GL.glDeleteBuffers(2, self.buffers)
        GL.glDeleteVertexArrays(1, [self.vertices])


def draw_shell(program, shell, inputs, block, clip_from_object, size):
    """Draw once: (color float32 [h, w, 4], depth float32 [h, w]); row 0 is the bottom."""
    frame = Frame(shell, size)
    frame.draw(program, inputs, block, clip_from_object)
    picture = frame.read()
    frame.release()
    return picture
