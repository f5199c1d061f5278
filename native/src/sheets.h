// Sheets of a thickness: what is open becomes a slab around itself.
#pragma once

#include "periodic_mesh.h"
#include "repair.h"

namespace mesoshell {

// Replaces every open component by its two offsets, half the thickness along vertex normals to either side (angle-weighted:
// Thuermer and Wuethrich 1998, "Computing vertex normals from polygonal facets"; lengthened at creases, at most to double, so
// that the faces keep their distance), joined along the rim. Three sheets that meet at an edge become three slabs that end
// there. A sheet that covers the whole tile has no rim; it counts as open where nothing closes the space below it, that is,
// where the areas seen from above and from below differ. Returns the number of components replaced. The result is not welded.
std::size_t thicken(PeriodicMesh& mesh, const Components& components, float thickness);

}  // namespace mesoshell
