// Where a UV seam cuts the pattern.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/shell.h"

namespace mesoshell {

// An edge between two prisms, as the corners of both have it: corner `ends[k]` of triangle `prism` lies where corner
// `other_ends[k]` of triangle `other` does.
struct SharedEdge {
    std::uint32_t prism;
    std::uint32_t other;
    std::array<std::uint8_t, 2> ends;
    std::array<std::uint8_t, 2> other_ends;
};

// Every edge of two prisms, once; of edges of more prisms, the first prism with each of the others. Ordered by vertices.
std::vector<SharedEdge> shared_edges(const ShellTopology& topology);

// UVs on both sides of a seam continue where they differ by whole tiles, the same at both ends, up to this many tiles.
constexpr float seam_tolerance = 1e-3f;

// Whether the pattern goes on across an edge: its UVs at the base and at the top continue, and the UVs of both prisms wind
// alike (a mirrored island continues nowhere). A prism whose UVs have no area winds as any other.
bool pattern_continues(const Shell& shell, const SharedEdge& edge);

struct Seams {
    std::vector<std::array<glm::vec3, 2>> edges;  // object space, at the base
    std::vector<std::array<glm::vec3, 2>> tops;   // above them
};

// The shared edges across which the pattern does not continue.
Seams find_seams(const Shell& shell);

}  // namespace mesoshell
