// A surface of triangles that spans a closed polygon in space, without further vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

// Triangles (indices of corners) around the polygon in its own direction, corners.size() - 2 of them, of the least area
// (Barequet and Sharir 1995, "Filling gaps in the boundary of a polyhedron"; time with the third power). A long polygon is
// first halved along chords that are short beside what they cut off.
std::vector<std::array<std::uint32_t, 3>> triangulate_loop(std::span<const glm::dvec3> corners);

}  // namespace mesoshell
