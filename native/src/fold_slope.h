// Shares of the asked thickness that change gently over a surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesoshell/shell.h"
#include "vertex_prisms.h"

namespace mesoshell {

// Lowers shares at and around the vertices `lowered`, until along every edge of a prism they differ by at most `slope` times
// its length. Nothing else changes, and no lower ones would do less. Each is the least, over all paths, of a share at its
// start and slope times its length, so that the order in which they are found does not matter. Returns the vertices that
// changed.
std::vector<std::uint32_t> limit_slope(const Shell& shell, const VertexPrisms& around, float slope,
                                       std::span<const std::uint32_t> lowered, std::vector<float>& shares);

}  // namespace mesoshell
