// Walls at the tile's borders, where a mesh does not fit its own copies.
#pragma once

#include <cstddef>

#include "periodic_mesh.h"

namespace mesoshell {

// Where open edges of a coherent mesh lie above one another, seen from above and modulo the periods, on either side of a
// border, and bound the mesh in opposite directions: adds a vertical wall between them, behind the mesh's triangles. So
// terrain whose borders are not alike is solid below. Returns the number of edges that got a wall.
std::size_t add_border_walls(PeriodicMesh& mesh);

}  // namespace mesoshell
