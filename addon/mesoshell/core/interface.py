"""What the draw program reads, from shaders/interface.toml: the NumPy dtype, the GLSL struct, and the C++ struct.

Every member of the uniform block is 16 bytes or a multiple of it, so the std140 layout is the packed one in all of them.
"""

import tomllib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

_SHAPES = {"vec4": ("f4", (4,)), "ivec4": ("i4", (4,)), "mat4": ("f4", (4, 4))}
_SIZES = {"vec4": 16, "ivec4": 16, "mat4": 64}


@dataclass(frozen=True)
class Interface:
    """One table of `interface.toml`; names map to GLSL types in the order of their slots.

    Varyings map to an interpolation and a type, such as "flat vec4".
    """

    name: str
    push_constants: dict
    vertex_in: dict
    varying: dict
    fragment_out: dict
    samplers: dict
    struct: str
    instance: str
    members: tuple

    @cached_property
    def dtype(self):
        """The uniform block as a NumPy record. Matrices are stored by columns: assign the transpose."""
        import numpy

        return numpy.dtype([(name, *_SHAPES[kind]) for name, kind, _ in self.members])

    def defaults(self):
        """A record (shape ()) of the uniform block with every default of the table."""
        import numpy

        record = numpy.zeros((), self.dtype)
        for name, kind, default in self.members:
            record[name] = numpy.eye(4) if default == "identity" else default
        return record

    def glsl_struct(self):
        """The struct of the uniform block, as GLSL."""
        rows = "".join(f"    {kind} {name};\n" for name, kind, _ in self.members)
        return f"struct {self.struct} {{\n{rows}}};\n"

    def glsl_preamble(self, stage):
        """Declarations before a stage ("vert" or "frag") where no Blender makes them: desktop GLSL 4.5."""
        lines = ["#version 450 core\n", self.glsl_struct()]
        lines.append(f"layout(std140, binding = 0) uniform {self.struct}Block {{ {self.struct} {self.instance}; }};\n")
        lines += [f"uniform {kind} {name};\n" for name, kind in self.push_constants.items()]
        lines += [
            f"layout(binding = {slot}) uniform {kind} {name};\n" for slot, (name, kind) in enumerate(self.samplers.items())
        ]
        if stage == "vert":
            lines += [
                f"layout(location = {slot}) in {kind} {name};\n" for slot, (name, kind) in enumerate(self.vertex_in.items())
            ]
        else:
            lines += [
                f"layout(location = {slot}) out {kind} {name};\n"
                for slot, (name, kind) in enumerate(self.fragment_out.items())
            ]
        direction = "out" if stage == "vert" else "in"
        for name, kind in self.varying.items():
            qualifier, kind = kind.split()
            lines.append(f"{qualifier} {direction} {kind} {name};\n")
        return "".join(lines)

    def cpp_header(self):
        """The struct of the uniform block as C++, with its size and offsets asserted against std140."""
        rows = []
        checks = []
        offset = 0
        for name, kind, default in self.members:
            rows.append(f"    glm::{kind} {name}{{{_cpp_value(kind, default)}}};\n")
            checks.append(f"static_assert(offsetof({self.struct}, {name}) == {offset});\n")
            offset += _SIZES[kind]
        return (
            "// Generated from shaders/interface.toml.\n#pragma once\n\n#include <cstddef>\n\n#include <glm/glm.hpp>\n\n"
            f"namespace mesoshell {{\n\nstruct {self.struct} {{\n{''.join(rows)}}};\n\n{''.join(checks)}"
            f"static_assert(sizeof({self.struct}) == {offset});\n\n}}  // namespace mesoshell\n"
        )


def _cpp_value(kind, default):
    if default == "identity":
        return "1.0f"
    if kind == "ivec4":
        return ", ".join(str(value) for value in default)
    return ", ".join(f"{float(value)!r}f" for value in default)


def load(path):
    """Read `interface.toml` at `path`; ValueError names a member whose type would leave a hole in std140."""
    with open(path, "rb") as file:
        table = tomllib.load(file)
    block = table["uniform_block"]
    for name, kind, _ in block["members"]:
        if kind not in _SHAPES:
            raise ValueError(f"{Path(path).name}: {name} is a {kind}; use one of {', '.join(_SHAPES)}, which have no padding")
    return Interface(
        name=table["name"],
        push_constants=table["push_constants"],
        vertex_in=table["vertex_in"],
        varying=table["varying"],
        fragment_out=table["fragment_out"],
        samplers=table["samplers"],
        struct=block["struct"],
        instance=block["instance"],
        members=tuple(tuple(member) for member in block["members"]),
    )
