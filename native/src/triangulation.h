// The triangles over which prisms stand.
#pragma once

#include <cstdint>
#include <span>

#include "limit_surface.h"
#include "mesoshell/shell.h"

namespace mesoshell {

// Quads are cut along their shorter diagonals, between the corners 0 and 2 if both are as good as equal; faces without area
// are left out, and so are those that come from faces that are not covered (none given: all are). Throws Error for a face of
// more than four corners, or where no triangle is left.
ShellTopology triangulate(const RefinedSurface& surface, std::span<const std::uint8_t> covered);

}  // namespace mesoshell
