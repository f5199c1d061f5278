// The four planes that come nearest to a piece of a tile's surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "facet_polygons.h"

namespace mesoshell {

// How the half-spaces behind four planes make a solid: the union of up to four groups, each the intersection of the planes
// whose bits are set. As FACET_* of shaders/lib/facets.glsl, less one.
constexpr std::array<std::array<int, 4>, 8> facet_forms = {{{15, 15, 15, 15},
                                                            {1, 2, 4, 8},
                                                            {5, 9, 6, 10},
                                                            {3, 12, 3, 12},
                                                            {7, 11, 7, 11},
                                                            {1, 2, 12, 12},
                                                            {1, 14, 1, 14},
                                                            {3, 5, 9, 9}}};

struct FacetFit {
    bool found = false;  // nothing to fit otherwise
    int form = 0;        // index into facet_forms
    std::array<glm::dvec4, 4> planes{};  // outward normal, and distance from the middle of the box over half its diagonal
    int wrong = 0;       // of the points, those on the wrong side
    double miss = 0.0;   // mean distance of the surface from that of the planes, sides of the box along u
};

// Signed distance of a point from the planes' solid, as far as planes tell; `radius` is half the diagonal of the box.
double distance_of(const FacetFit& fit, const glm::dvec3& from_middle, double radius);

// `inside`: 1 where a point is in the solid, [side + 1, side + 1, side + 1] points from corner to corner of the box.
FacetFit fit_facets(std::span<const FacetPolygon> polygons, const FacetBox& box, std::span<const std::uint8_t> inside, int side);

}  // namespace mesoshell
