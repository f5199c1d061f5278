// Empty boxes: from a cell that no surface touches, how many cells a ray may pass at once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"

namespace mesoshell {

// Cells beyond the ray's own, by code: how far a box reaches along one axis.
constexpr std::array<int, 8> box_reaches = {0, 1, 2, 3, 5, 8, 13, 31};

// The codes of a box along u, v and w, for directions of each octant: bit 0, 1 and 2 of its number are set where u, v and w
// grow.
using EmptyBoxes = std::array<glm::u8vec3, 8>;

// `full`: 1 where a surface touches the cell [cz, cy, cx] or it is solid. For every other cell the boxes that let rays run
// farthest in the mean over directions; beyond the slab all is empty. Throws Cancelled.
std::vector<EmptyBoxes> empty_boxes(const std::vector<std::uint8_t>& full, const glm::ivec3& cells, Job& job);

}  // namespace mesoshell
