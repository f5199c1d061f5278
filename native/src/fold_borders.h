// Where prisms have no neighbor, and where they have too many.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/shell.h"

namespace mesoshell {

constexpr std::uint32_t no_neighbor = ~0u;

struct FoldBorders {
    // One a prism: which prism shares the fin over its edge from corner i to corner i + 1, from its other side; none on
    // borders, and where an edge has more than two prisms or both on one side.
    std::vector<std::array<std::uint32_t, 3>> neighbors;
    // Prisms on the same side of an edge, the smaller first, in ascending order.
    std::vector<glm::uvec2> same_side;
};

FoldBorders find_borders(const ShellTopology& topology, Job& job);

}  // namespace mesoshell
