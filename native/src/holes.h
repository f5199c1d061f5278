// Closes what is open, so that the solid is where the generalized winding number says.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "periodic_mesh.h"

namespace mesoshell {

constexpr std::uint32_t no_cap = ~0u;

struct Caps {
    std::size_t count = 0;
    std::vector<std::uint32_t> of_triangle;  // the cap that each triangle belongs to, or no_cap
};

// Adds caps to a coherent mesh, behind its triangles, until no edge is open: surfaces of least area over its holes. Rims
// that go on through all copies of the tile are joined into one hole: a gutter gets a lid.
Caps span_holes(PeriodicMesh& mesh);

// Drops open parts that enclose no volume together with their caps, and those caps. Returns the number of triangles dropped,
// caps not counted.
std::size_t leave_out_sheets(PeriodicMesh& mesh, Caps& caps);

// Takes out the parts of caps at the vertices given, and where two of them lie against each other joins what is left: a
// short wide tube becomes a ring around its wall. Where nothing lies against another, all stays as it is.
void join_caps(PeriodicMesh& mesh, Caps& caps, const std::vector<bool>& taken_out);

}  // namespace mesoshell
