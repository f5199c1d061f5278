// What closes a solid that a plane of the slab cuts: the cut's area, triangulated in one copy of the tile.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

// One edge of the cut, in tile coordinates (plane_side.h), with the solid to its left.
struct CutEdge {
    glm::i64vec2 from{0};
    glm::i64vec2 to{0};
};

// The tile is cut open along two lines, at places that no modeled edge is likely to lie on; an edge across them is divided
// there, in the cap and in the mesh beside it alike. Points of the edge, in order, without its ends: the same from both
// sides.
std::vector<glm::i64vec2> divisions(const glm::i64vec2& from, const glm::i64vec2& to);

// Counterclockwise triangles over the area to the left of the edges; `solid_at` says whether a point that the edges do not
// tell about lies in it. Empty where the edges bound no area once around.
std::vector<std::array<glm::i64vec2, 3>> fill_cut(const std::vector<CutEdge>& edges,
                                                  const std::function<bool(const glm::i64vec2&)>& solid_at);

}  // namespace mesoshell
