// Closes what is open, so that the solid is where the generalized winding number says.
#pragma once

#include <cstddef>

#include "mesoshell/job.h"
#include "periodic_mesh.h"

namespace mesoshell {

struct HolesReport {
    std::size_t holes = 0;     // closed
    std::size_t left_out = 0;  // faces of open parts that enclose nothing
};

// Adds caps to a coherent mesh that faces outward until no edge is open. A cap spans a hole by the least area; where the hole is
// not in a plane it then follows the surface on which the generalized winding number of the open mesh is one half
// (cap_surface.h). Rims that go on through all copies of the tile are joined into one hole: a gutter gets a lid. Open parts that
// enclose no volume with their caps are left out, unless nothing else is left: then all is as it was, and holes is zero.
HolesReport close_holes(PeriodicMesh& mesh, Job& job);

}  // namespace mesoshell
