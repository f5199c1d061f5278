// Contouring: the surface of a solid that a grid of numbers describes, as a sample's mesh.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"

namespace mesoshell {

// Indexed triangles in metric texture space that wind counterclockwise seen from outside the solid.
struct Contour {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
};

// The solid where `values` [nz, ny, nx] lie above `threshold`. nodes: (nx, ny, nz), each 2 to 4096; node i lies at i / n along
// u and v, which are periodic, and at i / (n - 1) along w. height and aspect are positive (tile widths, pv / pu).
//
// Marching tetrahedra: every cell is cut into the same six tetrahedra around its diagonal (Kuhn 1960), so that neighbors agree
// on every face, also across the borders; inside a tetrahedron the values are linear (Doi and Koide 1991). The mesh is cut at
// the tile's sides, where a vertex and its copy a period away have the same bits in their other coordinates, and capped at
// w = 0 and w = 1, where the solid reaches them: closed modulo the periods. Vertices are shared. The result does not depend on
// the number of threads.
//
// Throws InvalidArgument for a size that does not fit, a value that is not finite, and where no value or every value lies
// above the threshold; Cancelled.
Contour contour(std::span<const float> values, const glm::ivec3& nodes, float threshold, float height, float aspect, Job& job);

}  // namespace mesoshell
