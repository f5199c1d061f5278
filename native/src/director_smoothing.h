// Directors made smoother over a surface, without turning any behind a face.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "limit_surface.h"
#include "mesoshell/job.h"

namespace mesoshell {

// Faces of three or four corners; vertices without one keep their directors.
struct FaceLists {
    std::vector<std::int32_t> face_sizes;
    std::vector<std::int32_t> corners;
};

// Those of a refined surface that come from covered faces (none given: all are).
FaceLists covered_faces(const RefinedTopology& surface, std::span<const std::uint8_t> covered);

// `steps` times, each director moves half the way to the mean of its neighbors', weighted by the cotangents of the angles opposite
// to the edge, a quad's as the mean of its two triangulations and none below zero: on a sphere the mean is the director itself up
// to the square of an edge, and neither the order of vertices nor the diagonals of quads matter. A step that would bring a
// director nearer than 75 degrees to the plane of a triangle at its vertex, or nearer than it was if it was already, is halved
// until it does not. `triangles` are the prisms'.
void smooth_directors(std::vector<glm::vec3>& directors, std::span<const glm::vec3> positions,
                      std::span<const glm::uvec3> triangles, const FaceLists& faces, int steps, Job& job);

}  // namespace mesoshell
