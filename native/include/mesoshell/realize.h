// The independent truth: the tile's own triangles warped into the shell, and Embree on that mesh.
// Nothing here shares code with the traversals or with the shader text.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/render.h"
#include "mesoshell/sample.h"
#include "mesoshell/shell.h"

namespace mesoshell {

struct RealizedMesh {
    std::vector<glm::vec3> positions;  // object space, three a triangle
    std::vector<glm::uvec3> triangles;
};

// For every prism: the tile's triangles that its texture triangle covers, clipped to it, split until the bilinear map bends
// them by little, and mapped. Where the top has other UVs than the base the texture triangle is another at each height, and
// the tile's triangles are split before they are clipped. Open where the slab clips the solid. Throws InvalidArgument for a
// prism whose UVs turn over between base and top; Cancelled.
RealizedMesh realize(const Shell& shell, const Sample& sample, Job& job);

// A picture of any triangle mesh; row 0 is the bottom. Nothing hit: distance infinite, normal 0.
struct Trace {
    glm::ivec2 size{0};
    std::vector<std::uint8_t> hit;
    std::vector<float> distance;    // as in Rendering
    std::vector<glm::vec3> normal;  // of the triangle, unit length, facing as it winds
};

Trace trace(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, const View& view, Job& job);

}  // namespace mesoshell
