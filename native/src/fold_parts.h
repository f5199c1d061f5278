// Parts of a shell that do not hang together: one may lie wholly inside another, and no boundaries cross.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "fold_search.h"
#include "mesoshell/job.h"

namespace mesoshell {

// Whether a point lies in a prism, to a 1e-9th of its size: at a height where it is in the plane of the prism's triangle, a
// root of a cubic. Double precision.
bool holds(const PrismCorners& prism, const glm::dvec3& point);

class FoldParts {
public:
    // Prisms that share a vertex are of one part.
    explicit FoldParts(const FoldSearch& search);

    // For every part, a prism of it and those of other parts that hold the middle of its base: the smaller first.
    std::vector<glm::uvec2> nested(const FoldSearch& search, Job& job) const;

private:
    std::vector<std::uint32_t> part_;   // one a prism: the first vertex of its part
    std::vector<std::uint32_t> first_;  // prisms, one of every part
};

}  // namespace mesoshell
