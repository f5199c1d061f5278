// Where the tiles lie on a surface.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/shell.h"

namespace mesoshell {

// Tiles from UVs, in double precision. Whole tiles of the offset are left out, since they move the whole pattern onto itself
// and would cost the digits that place it. Throws InvalidArgument where a result is not finite.
void place_uvs(std::vector<glm::vec2>& uvs, const Placement& placement);

}  // namespace mesoshell
