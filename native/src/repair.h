// What is done to a mesh before anything is asked of it: degenerate and duplicate faces go, neighbors agree on a side, and
// solids have their outsides out.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "periodic_mesh.h"

namespace mesoshell {

// Drops the triangles with two corners at one place. As a chain the mesh keeps its boundary. Returns their number.
std::size_t drop_degenerate(PeriodicMesh& mesh);

// Drops all but one of the triangles with the same three corners, modulo a common period and whatever their sides. Where a
// patch of such triangles is a wall between two solids that meet there (without it every edge of the patch has an even
// number of faces), none of it is kept. Returns the number of triangles dropped.
std::size_t drop_duplicates(PeriodicMesh& mesh);

// The triangles that hang together across edges of exactly two faces.
struct Components {
    std::vector<std::uint32_t> of_triangle;
    std::vector<std::vector<std::uint32_t>> triangles;  // of every component
    // Whole periods that lay a triangle beside its neighbors, in one piece unless the component wraps.
    std::vector<glm::ivec2> offset;
    std::vector<bool> wraps;  // a walk within the component ends a period away from where it began
};

// Turns triangles over until those of a component agree, by the side that the larger area of it had. Around a component
// with one side only (a Moebius strip) the disagreement stays along some of its edges.
Components make_coherent(PeriodicMesh& mesh);

// Turns components of a closed mesh over, so that solids have their outsides out: one that is inside out, by the sign of the
// volume it encloses, is turned together with what it contains, unless it is a cavity of a larger one. Sheets that cover the
// whole tile are turned, all of them, where the solid would be above.
void turn_outward(PeriodicMesh& mesh, const Components& components);

}  // namespace mesoshell
