#include "facet_reach.h"

#include <cmath>
#include <cstddef>

namespace mesoshell {
namespace {

constexpr double voxel = 1.0 / 64.0;  // tile widths
constexpr double most_apart = 0.05 * voxel;
constexpr double most_apart_in_the_mean = 0.01 * voxel;

// Whether the planes of a cell hold in one that lies `offset` cells away.
bool holds(const FacetFit& fit, const glm::ivec3& place, const glm::ivec3& offset, const FacetGrid& grid)
{
    const int height = place.z + offset.z;
    if (height < 0 || height >= grid.cells.z) {
        return true;
    }
    const glm::ivec3 other = (place + offset + grid.cells) % grid.cells;
    const double radius = 0.5 * glm::length(grid.side);
    for (int z = 0; z <= grid.points_a_side; z += 2) {
        for (int y = 0; y <= grid.points_a_side; y += 2) {
            for (int x = 0; x <= grid.points_a_side; x += 2) {
                const glm::ivec3 point(x, y, z);
                const glm::dvec3 place_in_cells = glm::dvec3(offset) + glm::dvec3(point) / double(grid.points_a_side) - 0.5;
                const glm::dvec3 from_middle = place_in_cells * grid.side;
                const bool behind = distance_of(fit, from_middle, radius) < 0.0;
                if (behind != grid.is_inside(other * grid.points_a_side + point)) {
                    return false;
                }
            }
        }
    }
    double sum = 0.0;
    double area = 0.0;
    const glm::dvec3 middle = (glm::dvec3(other - offset) + 0.5) * grid.side;
    const std::size_t index = (static_cast<std::size_t>(other.z) * grid.cells.y + other.y) * grid.cells.x + other.x;
    for (const FacetPolygon& polygon : grid.polygons[index]) {
        for (const glm::dvec3& corner : polygon.corners) {
            if (std::abs(distance_of(fit, corner - middle, radius)) > most_apart) {
                return false;
            }
        }
        sum += polygon.area * std::abs(distance_of(fit, polygon.center - middle, radius));
        area += polygon.area;
    }
    return sum <= most_apart_in_the_mean * area;
}

}  // namespace

FacetReach facet_reach(const FacetFit& fit, const glm::ivec3& place, const FacetGrid& grid)
{
    glm::ivec3 first(0);
    glm::ivec3 last(0);
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        // The layer of cells that the box grows by.
        glm::ivec3 low = first;
        glm::ivec3 high = last;
        low[axis] = high[axis] = face % 2 == 0 ? first[axis] - 1 : last[axis] + 1;
        bool all = true;
        for (int z = low.z; z <= high.z; ++z) {
            for (int y = low.y; y <= high.y; ++y) {
                for (int x = low.x; x <= high.x && all; ++x) {
                    all = holds(fit, place, {x, y, z}, grid);
                }
            }
        }
        if (all) {
            first = glm::min(first, low);
            last = glm::max(last, high);
        }
    }
    return {-first, last};
}

}  // namespace mesoshell
