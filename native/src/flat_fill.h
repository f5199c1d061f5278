// Triangles over a region of the plane that directed segments bound.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

// Counterclockwise triangles over what lies to the left of the segments, with no further points, so that together they have
// exactly the segments as their boundary. Segments form closed loops: as many end at a point as begin there. Loops may lie
// within one another, and touch at points; where they cross or one lies in no other although it runs clockwise, the
// triangles still have that boundary but overlap. Holes are joined by bridges, then ears are cut (Meisters 1975, "Polygons
// have ears"); time with the square of a loop's length. Coordinates differ by less than 2^62.
std::vector<glm::uvec3> fill_region(std::span<const glm::i64vec2> points, std::span<const glm::uvec2> segments);

// Adds segments along the border of the rectangle [lower, upper], counterclockwise, from every point on it where a segment
// ends and none begins to the next where one begins; `corners` are the four points counterclockwise from `lower`. Where
// nothing ends on the border and `filled`, all of it. Returns false where ends and beginnings do not alternate.
bool close_along_border(std::span<const glm::i64vec2> points, std::span<const std::uint32_t> corners, bool filled,
                        std::vector<glm::uvec2>& segments);

}  // namespace mesoshell
