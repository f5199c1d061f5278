// Caps that bend: from a surface that spans a hole somehow to the one on which the winding number is one half.
#pragma once

#include <cstdint>
#include <vector>

#include "mesoshell/job.h"
#include "periodic_mesh.h"

namespace mesoshell {

constexpr std::uint32_t no_cap = ~0u;

// cap_of: of every triangle of a closed mesh, the cap it belongs to, or no_cap. Splits the edges of caps, and with them the faces
// around holes, until a cap is fine enough to bend, by its size and that of the edges around it; never finer than the
// finest voxels see. Then moves its inner vertices along its normal to where the winding number of the other triangles is one
// half: harmonic between mesh and mesh, it is one half on a surface that ends on the rim. The constant that periods leave open is
// that of the closed mesh. A vertex that finds no such place stays where the number comes closest to it, and one that is
// within level_tolerance of it stays where it is, so that flat holes get flat caps.
void shape_caps(PeriodicMesh& mesh, std::vector<std::uint32_t>& cap_of, Job& job);

constexpr double level_tolerance = 0.01;

}  // namespace mesoshell
