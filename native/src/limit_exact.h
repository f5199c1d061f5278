// Limit points that the limit masks of a level only approximate.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <opensubdiv/far/topologyRefiner.h>

#include "limit_masks.h"

namespace mesoshell {

// Rows over the vertices of the mesh, by vertex of the last level. OpenSubdiv's masks take what a level says for all that
// follow: they are off where a crease ends (a dart) and where semi-sharp creases and corners have sharpness left. All of
// these are on edges of the mesh, where its patches say what the limit is, at a dart within a thousandth of an edge. Where a
// patch cannot be made (patches_take) they keep their masks.
struct ExactRow {
    std::vector<std::uint32_t> vertices;
    std::vector<LimitWeights> weights;
};
using ExactRows = std::unordered_map<std::uint32_t, ExactRow>;
ExactRows exact_limits(const OpenSubdiv::Far::TopologyRefiner& refiner);

}  // namespace mesoshell
