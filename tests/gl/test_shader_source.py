"""The resolver of include lines, and the layout that every side of the interface agrees on."""

import pytest
from core import interface, shader_source


def test_include_is_inlined_once_before_its_use(tmp_path):
    (tmp_path / "a.glsl").write_text('#include "b.glsl"\n#include "c.glsl"\nA\n')
    (tmp_path / "b.glsl").write_text('#include "c.glsl"\nB\n')
    (tmp_path / "c.glsl").write_text("C\n")
    assert shader_source.resolve(tmp_path / "a.glsl").split() == ["C", "B", "A"]


def test_missing_include_names_both_files(tmp_path):
    (tmp_path / "a.glsl").write_text('#include "gone.glsl"\n')
    with pytest.raises(FileNotFoundError, match="a.glsl includes gone.glsl"):
        shader_source.resolve(tmp_path / "a.glsl")


def test_stages_have_no_include_left():
    for stage in ("shell.vert", "shell.frag"):
        assert "#include" not in shader_source.stage(stage)


def test_member_that_std140_would_pad_is_refused(tmp_path):
    text = (shader_source.FOLDER / "interface.toml").read_text().replace('["tile", "vec4"', '["tile", "vec3"')
    (tmp_path / "interface.toml").write_text(text)
    with pytest.raises(ValueError, match="tile is a vec3"):
        interface.load(tmp_path / "interface.toml")


def test_block_layout_is_what_the_driver_uses(gl):
    from OpenGL import GL

    table = shader_source.shell_interface()
    program = gl.shell_program()
    index = GL.glGetUniformBlockIndex(program, table.struct + "Block")
    size = (GL.GLint * 1)()
    GL.glGetActiveUniformBlockiv(program, index, GL.GL_UNIFORM_BLOCK_DATA_SIZE, size)
    assert size[0] == table.dtype.itemsize
    seen = 0
    for name in table.dtype.names:
        member = GL.glGetProgramResourceIndex(program, GL.GL_UNIFORM, f"{table.instance}.{name}".encode())
        if member == GL.GL_INVALID_INDEX:
            continue  # optimized away
        properties, values = (GL.GLenum * 1)(GL.GL_OFFSET), (GL.GLint * 1)()
        GL.glGetProgramResourceiv(program, GL.GL_UNIFORM, member, 1, properties, 1, None, values)
        assert values[0] == table.dtype.fields[name][1], name
        seen += 1
    assert seen >= 5
