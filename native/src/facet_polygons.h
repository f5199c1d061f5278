// The surface of a tile, cut along the cells of a grid.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/sample.h"

namespace mesoshell {

struct FacetBox {
    glm::dvec3 lower;
    glm::dvec3 side;
};

// A part of a triangle, metric texture space.
struct FacetPolygon {
    glm::dvec3 normal{0.0};  // out of the solid, unit length
    glm::dvec3 center{0.0};  // mean of the corners
    double area = 0.0;
    std::vector<glm::dvec3> corners;
};

// The part of a polygon in a box that is larger than the given one by 1e-4 of its sides, so that neighbors leave no gap; with
// no corners where there is none.
FacetPolygon clipped_to(const FacetPolygon& polygon, const FacetBox& box);

// Those of every cell [cz, cy, cx], copies of the tile included, without what lies inside overlapping solids and what is too
// small to be seen.
std::vector<std::vector<FacetPolygon>> facet_polygons(const Sample& sample, const glm::ivec3& cells, Job& job);

}  // namespace mesoshell
