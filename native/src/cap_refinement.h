// Caps fine enough to bend.
#pragma once

#include <cstdint>
#include <vector>

#include "holes.h"
#include "periodic_mesh.h"

namespace mesoshell {

// Splits the edges of caps, and with them the faces around holes, until no edge is longer than its cap wants: by the size of
// the cap and that of the edges around it, never finer than the finest voxels see. cap_of: of every triangle, the cap it
// belongs to, or no_cap; edges whose other faces are not among the triangles stay whole. Returns, for every vertex, whether
// it was added inside a cap and is free to move.
std::vector<bool> refine_caps(PeriodicMesh& mesh, std::vector<std::uint32_t>& cap_of);

}  // namespace mesoshell
