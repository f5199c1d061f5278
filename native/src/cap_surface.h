// Caps that bend: from a surface that spans a hole somehow to the one on which the winding number is one half.
#pragma once

#include "holes.h"
#include "mesoshell/job.h"
#include "periodic_mesh.h"

namespace mesoshell {

// The mesh is closed, caps and all, and faces outward. Splits the edges of caps, and with them the faces around holes, until
// a cap is fine enough to bend, by its size and that of the edges around it; never finer than the finest voxels see. Then
// moves its inner vertices along its normal to where the winding number of the other triangles is one half: harmonic between
// mesh and mesh, it is one half on a surface that ends on the rim. The constant that periods leave open is that of the
// closed mesh. A vertex that finds no such place stays where the number comes closest to it, and one that is within
// level_tolerance of it stays where it is, so that flat holes get flat caps. Returns, for every vertex, whether the number
// stayed below one half wherever it looked: caps of a tube too short to be solid meet in its middle.
std::vector<bool> shape_caps(PeriodicMesh& mesh, Caps& caps, Job& job);

constexpr double level_tolerance = 0.01;

}  // namespace mesoshell
