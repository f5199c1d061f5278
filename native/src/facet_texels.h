// The 128 bits of a facet texel, as shaders/lib/facets.glsl reads them.
#pragma once

#include <array>
#include <cstdint>

#include <glm/glm.hpp>

#include "facet_boxes.h"
#include "facet_fit.h"
#include "facet_reach.h"
#include "mesoshell/facets.h"

namespace mesoshell {

using FacetTexel = std::array<float, 4>;

FacetTexel empty_texel(const EmptyBoxes& boxes);
FacetTexel plane_texel(const FacetFit& fit, const FacetReach& reach = {});
FacetTexel solid_texel();
// `parts`: bit (z 4 + y) 4 + x where a part has a texel; `first`: index of the first of these, below 2^26.
FacetTexel split_texel(std::uint64_t parts, std::uint32_t first);

// Whether there is a texel for every cell and for every part that one names.
bool facets_make_sense(const Facets& facets);

}  // namespace mesoshell
