// How thick a shell is at each vertex: a constant, times an image, times factors of the surface's vertices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/shell.h"

namespace mesoshell {

// Object units, one of `vertices`: `thickness` times the image at the vertex's UVs, the image repeating over [0, 1]^2 with
// pixel (i, j) centered at ((i + 1/2) / width, (j + 1/2) / height). A vertex on a seam has several UVs and one column: it
// takes the mean of the image there. `corners` and `uv_corners` are those of the refined surface, `uvs` not placed yet.
// Throws Error where a thickness is not finite.
std::vector<float> image_thickness(float thickness, const FactorImage& image, std::size_t vertices,
                                   std::span<const std::int32_t> corners, std::span<const std::int32_t> uv_corners,
                                   std::span<const glm::vec2> uvs);

// Multiplies by factors of the refined surface's vertices, clamped to [0, 1], which refining leaves by rounding only.
void scale_thickness(std::vector<float>& thickness, std::span<const float> factors);

}  // namespace mesoshell
