// The holes of a mesh modulo the periods: the cycles of edges that bound it, in the direction of the faces that are missing.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "periodic_mesh.h"

namespace mesoshell {

// A place and the copy of it.
struct LoopCorner {
    std::uint32_t place = 0;
    glm::ivec2 shift{0};
};

// From every corner an edge leads to the next, and from the last to the first moved by `period`: zero where the loop closes
// within one copy of the tile, else it goes on through all of them.
struct Loop {
    std::vector<LoopCorner> corners;
    glm::ivec2 period{0};
};

// The edges out of balance, each in as many loops as it is out of balance. Where loops touch at a vertex, each goes on along
// its own hole, by the angles about the vertex.
std::vector<Loop> boundary_loops(const PeriodicMesh& mesh);

// Loops that go on through all copies are joined by an edge there and back to the nearest of those that, all together,
// cancel their periods: the two rims of a gutter become one loop around its lid. What is left has period zero.
void join_periodic_loops(const PeriodicMesh& mesh, std::vector<Loop>& loops);

// One loop of two, joined by an edge there and back between their nearest corners.
Loop joined(const PeriodicMesh& mesh, const Loop& a, const Loop& b);

// Distance between the nearest corners of two loops, modulo the periods.
double distance_between(const PeriodicMesh& mesh, const Loop& a, const Loop& b);

}  // namespace mesoshell
