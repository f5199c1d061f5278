// The one home of OpenSubdiv: a mesh refined to a level, with limit positions and limit normals.
#pragma once

#include "mesoshell/shell.h"

namespace mesoshell {

struct RefinedSurface {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  // unit length; zero where the surface has none
    std::vector<std::int32_t> face_sizes;
    std::vector<std::int32_t> corners;
    std::vector<glm::vec2> uvs;  // one a corner
};

// levels at least 1. UVs interpolate smoothly inside an island and linearly along its boundary, as Blender does by default.
RefinedSurface refine(const Surface& surface, int levels, Scheme scheme);

// The address of an OpenSubdiv function, as this code calls it.
const void* opensubdiv_function();

}  // namespace mesoshell
