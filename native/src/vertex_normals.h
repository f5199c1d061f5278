// Normals of a mesh's vertices from its faces.
#pragma once

#include <vector>

#include "mesoshell/surface.h"

namespace mesoshell {

// Face normals weighted by the angle at the vertex, so that triangulation does not matter. Unit length; zero where a vertex has
// no face with an area, or faces that cancel.
std::vector<glm::vec3> angle_weighted_normals(const Surface& surface);

}  // namespace mesoshell
