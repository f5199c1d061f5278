// How far beyond its cell the planes of a cell hold: rays that miss them there need not ask the next cell.
#pragma once

#include <functional>
#include <vector>

#include <glm/glm.hpp>

#include "facet_fit.h"
#include "facet_polygons.h"

namespace mesoshell {

// The tile around a cell.
struct FacetGrid {
    glm::ivec3 cells;
    glm::dvec3 side;  // of a cell, tile widths
    const std::vector<std::vector<FacetPolygon>>& polygons;    // of every cell [cz, cy, cx]
    int points_a_side;                                         // of a cell, even
    std::function<bool(const glm::ivec3& point)> is_inside;    // point (0, 0, 0) is the lower corner of cell (0, 0, 0)
};

// 1 where a box may be one cell longer than the cell, toward smaller and toward larger coordinates.
struct FacetReach {
    glm::ivec3 back{0};
    glm::ivec3 forward{0};
};

// In every cell of the box the planes put every other of its points on the right side, and are nowhere farther than a twentieth,
// in the mean not farther than a hundredth, of a 64th of a tile width from the surface. Beyond the slab all is well.
FacetReach facet_reach(const FacetFit& fit, const glm::ivec3& place, const FacetGrid& grid);

}  // namespace mesoshell
