// Directions from a vertex that are in front of all faces around it.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/shell.h"

namespace mesoshell {

// The direction whose least dot product with these unit normals is greatest (Aubry and Loehner 2008, "On the 'most normal'
// normal"): the axis of the narrowest cone around them. Exact but for rounding up to 16 normals, beyond that to 1e-3.
// Zero where no direction has a positive dot product with all of them.
glm::dvec3 most_visible_direction(const std::vector<glm::dvec3>& normals);

// The same for the vertices of a shell, by the triangles around them.
class VisibleNormals {
public:
    explicit VisibleNormals(const Shell& shell);

    // Zero where there is none: the surface is folded onto itself.
    glm::vec3 at(std::uint32_t vertex) const;
    // Whether every corner of a prism has one.
    bool mendable(std::uint32_t prism) const;

private:
    const Shell& shell_;
    std::vector<std::uint32_t> first_;   // one a vertex and one more
    std::vector<std::uint32_t> prisms_;  // around each vertex
};

}  // namespace mesoshell
