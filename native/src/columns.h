// The surfaces that vertical lines cross, without a gap and without a double: the winding number of a closed mesh, exact.
//
// Places are snapped to 2^-23 periods sideways. Then edge functions are exact integers, the same for every copy of a triangle
// by whole periods, and the top-left rule of rasterizers (Pineda 1988, "A parallel algorithm for polygon rasterization")
// gives a line through an edge or a vertex to exactly one of the triangles that share it. So the signed crossings of a line
// with a closed mesh sum to zero, and partial sums from the top down are winding numbers.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "periodic_mesh.h"

namespace mesoshell {

struct Crossing {
    double z = 0.0;
    int sign = 0;  // 1 where a line from above goes in, -1 where it comes out
};

// A mesh that Sample has checked: nothing farther away than most_periods.
class Columns {
public:
    explicit Columns(const PeriodicMesh& mesh);

    // Crossings of the vertical line through (x, y) with some of the triangles and all their copies, unsorted.
    std::vector<Crossing> along(const glm::dvec2& point, std::span<const std::uint32_t> triangles) const;

    // Crossings of the lines through the nodes (i / nx, j / ny aspect), downward: those of node (i, j) are
    // [first[j nx + i], first[j nx + i + 1]).
    struct Grid {
        std::vector<std::size_t> first;
        std::vector<Crossing> crossings;
    };
    // Throws InvalidArgument where they are too many: copies of huge triangles.
    Grid grid(const glm::ivec2& nodes, Job& job) const;

private:
    const PeriodicMesh& mesh_;
    std::vector<glm::i64vec2> fixed_;  // of every vertex
};

// 1 where a node (i / nx, j / ny aspect, z[k]) of an [nz, ny, nx] grid has a winding number other than zero. What lies on the
// surface of a solid is in it.
std::vector<std::uint8_t> classify_by_columns(const PeriodicMesh& mesh, const glm::ivec2& nodes, std::span<const float> z,
                                              Job& job);

// The range of winding numbers, over some 16,000 vertical lines.
glm::ivec2 winding_range(const PeriodicMesh& mesh, Job& job);

}  // namespace mesoshell
