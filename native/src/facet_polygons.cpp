#include "facet_polygons.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "embree_scene.h"
#include "parallel.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

constexpr double margin = 1e-4;         // of a side
constexpr double least_area = 1e-9;     // of a cell's side, squared
constexpr double above_surface = 0.02;  // of a cell: where it is asked whether another solid covers a polygon

int wrapped(int i, int count)
{
    return (i % count + count) % count;
}

// Corners on one side of a plane through `level` across an axis.
std::vector<glm::dvec3> clipped(const std::vector<glm::dvec3>& corners, int axis, double level, double sign)
{
    std::vector<glm::dvec3> kept;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3& a = corners[i];
        const glm::dvec3& b = corners[(i + 1) % corners.size()];
        const double side_a = (a[axis] - level) * sign;
        const double side_b = (b[axis] - level) * sign;
        if (side_a >= 0.0) {
            kept.push_back(a);
        }
        if ((side_a >= 0.0) != (side_b >= 0.0)) {
            kept.push_back(glm::mix(a, b, side_a / (side_a - side_b)));
        }
    }
    return kept;
}

void measure(FacetPolygon& polygon)
{
    glm::dvec3 area(0.0);
    polygon.center = glm::dvec3(0.0);
    for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
        polygon.center += polygon.corners[i];
        if (i >= 2) {
            area += 0.5 * glm::cross(polygon.corners[i - 1] - polygon.corners[0], polygon.corners[i] - polygon.corners[0]);
        }
    }
    polygon.center /= static_cast<double>(polygon.corners.size());
    polygon.area = glm::length(area);
}

}  // namespace

FacetPolygon clipped_to(const FacetPolygon& polygon, const FacetBox& box)
{
    for (int axis = 0; axis < 3; ++axis) {
        const double low = box.lower[axis] - margin * box.side[axis];
        const double high = box.lower[axis] + (1.0 + margin) * box.side[axis];
        double least = high + 1.0;
        double most = low - 1.0;
        for (const glm::dvec3& corner : polygon.corners) {
            least = std::min(least, corner[axis]);
            most = std::max(most, corner[axis]);
        }
        if (least > high || most < low) {
            return {};
        }
    }
    FacetPolygon part = polygon;
    for (int axis = 0; axis < 3 && !part.corners.empty(); ++axis) {
        part.corners = clipped(part.corners, axis, box.lower[axis] - margin * box.side[axis], 1.0);
        part.corners = clipped(part.corners, axis, box.lower[axis] + (1.0 + margin) * box.side[axis], -1.0);
    }
    if (part.corners.size() < 3) {
        part.corners.clear();
        return part;
    }
    measure(part);
    if (part.area < least_area * box.side.x * box.side.x) {
        part.corners.clear();
    }
    return part;
}

std::vector<std::vector<FacetPolygon>> facet_polygons(const Sample& sample, const glm::ivec3& cells, Job& job)
{
    const std::vector<glm::vec3>& positions = sample.slab_positions();
    const glm::dvec3 scale(1.0, sample.aspect(), sample.height());
    const glm::dvec3 side = scale / glm::dvec3(cells);
    std::vector<std::vector<FacetPolygon>> polygons(static_cast<std::size_t>(cells.x) * cells.y * cells.z);
    for (const glm::uvec3& triangle : sample.slab_triangles()) {
        job.throw_if_cancelled();
        FacetPolygon whole;
        whole.corners = {positions[triangle.x], positions[triangle.y], positions[triangle.z]};
        const glm::dvec3 across = glm::cross(whole.corners[1] - whole.corners[0], whole.corners[2] - whole.corners[0]);
        if (glm::length(across) == 0.0) {
            continue;
        }
        whole.normal = glm::normalize(across);
        const auto cell_of = [&](const glm::dvec3& place, double slack) {
            return glm::ivec3(glm::floor(place / side + slack));
        };
        glm::ivec3 first = cell_of(glm::min(whole.corners[0], glm::min(whole.corners[1], whole.corners[2])), -margin);
        glm::ivec3 last = cell_of(glm::max(whole.corners[0], glm::max(whole.corners[1], whole.corners[2])), margin);
        first.z = std::max(first.z, 0);
        last.z = std::min(last.z, cells.z - 1);
        for (int z = first.z; z <= last.z; ++z) {
            for (int y = first.y; y <= last.y; ++y) {
                for (int x = first.x; x <= last.x; ++x) {
                    FacetPolygon part = clipped_to(whole, {glm::dvec3(x, y, z) * side, side});
                    if (part.corners.empty()) {
                        continue;
                    }
                    const glm::ivec3 cell(wrapped(x, cells.x), wrapped(y, cells.y), z);
                    const glm::dvec3 shift = glm::dvec3(cell - glm::ivec3(x, y, z)) * side;
                    for (glm::dvec3& corner : part.corners) {
                        corner += shift;
                    }
                    part.center += shift;
                    const std::size_t index = (static_cast<std::size_t>(cell.z) * cells.y + cell.y) * cells.x + cell.x;
                    polygons[index].push_back(std::move(part));
                }
            }
        }
    }
    if (!sample.overlaps()) {
        return polygons;
    }
    // Near a solid's own surface the winding number is that of the others.
    const TriangleScene scene(sample.positions(), sample.triangles(), lattice_within(sample, 0.1f * sample.height()),
                              TriangleScene::Use::crossings);
    const glm::vec3 up = glm::normalize(glm::vec3(0.0123f, 0.0077f, 1.0f));
    parallel_for(job, cells.z * cells.y, [&](int row) {
        for (int x = 0; x < cells.x; ++x) {
            std::erase_if(polygons[static_cast<std::size_t>(row) * cells.x + x], [&](const FacetPolygon& polygon) {
                const glm::dvec3 above = polygon.center + polygon.normal * (above_surface * side.x);
                return scene.count_crossings(glm::vec3(above), up).winding != 0;
            });
        }
    });
    return polygons;
}

}  // namespace mesoshell
