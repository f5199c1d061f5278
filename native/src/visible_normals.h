// Directions from a vertex that are in front of all faces around it.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/shell.h"
#include "vertex_prisms.h"

namespace mesoshell {

// The direction whose least dot product with these unit normals is greatest (Aubry and Loehner 2008, "On the 'most normal'
// normal"): the axis of the narrowest cone around them. Exact but for rounding up to 16 normals, beyond that to 1e-3.
// Zero where no direction has a positive dot product with all of them.
glm::dvec3 most_visible_direction(const std::vector<glm::dvec3>& normals);

// The same for a vertex of a shell and the triangles around it. In single precision it is still in front of all of them,
// exactly, or it is zero: the surface is folded onto itself.
glm::vec3 most_visible_normal(const Shell& shell, const VertexPrisms& prisms, std::uint32_t vertex);

}  // namespace mesoshell
