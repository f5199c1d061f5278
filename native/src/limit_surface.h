// The one home of OpenSubdiv: a mesh refined to a level, with limit positions and limit normals.
#pragma once

#include <span>
#include <vector>

#include "mesoshell/surface.h"

namespace mesoshell {

struct RefinedSurface {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  // unit length; zero where the surface has none
    std::vector<std::int32_t> face_sizes;
    std::vector<std::int32_t> corners;     // vertices
    std::vector<std::int32_t> uv_corners;  // one a corner: an entry of uvs; corners of a vertex with equal UVs share one
    std::vector<glm::vec2> uvs;
    std::vector<std::int32_t> faces;  // one a face: the face of the surface it comes from
};

// At level 0 the mesh as it is, with its own normals; else positions and normals of the limit surface.
RefinedSurface refine(const Surface& surface, const Refinement& refinement);

// Numbers at the surface's vertices, carried to those of the refined surface as positions are.
std::vector<float> refine_values(const Surface& surface, const Refinement& refinement, std::span<const float> values);

// The address of an OpenSubdiv function, as this code calls it.
const void* opensubdiv_function();

}  // namespace mesoshell
