#include "mesoshell/facets.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "facet_reach.h"
#include "facet_texels.h"
#include "mesoshell/bake.h"
#include "parallel.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

constexpr int parts_a_side = 4;   // of a cell that is split
constexpr int points_a_side = 8;  // of a cell, at which it is known what is inside
constexpr int part_points = points_a_side / parts_a_side;
constexpr int most_wrong = 6;     // points, of a cell that is not split
constexpr double most_missed = 0.03 / 64.0;  // tile widths
constexpr int most_layers = 2048;            // of a texture

// Which points of the tile are in the solid.
class Points {
public:
    Points(const Sample& sample, const glm::ivec3& cells, Job& job)
        : nodes_(cells.x * points_a_side, cells.y * points_a_side, cells.z * points_a_side + 1),
          inside_(classify_inside(sample, nodes_, job))
    {
    }

    std::uint8_t at(const glm::ivec3& point) const
    {
        return inside_[(static_cast<std::size_t>(point.z) * nodes_.y + point.y % nodes_.y) * nodes_.x + point.x % nodes_.x];
    }

    // Those of a box of side^3 intervals, whose first point is `first`.
    std::vector<std::uint8_t> of_box(const glm::ivec3& first, int side) const
    {
        std::vector<std::uint8_t> points;
        for (int z = 0; z <= side; ++z) {
            for (int y = 0; y <= side; ++y) {
                for (int x = 0; x <= side; ++x) {
                    points.push_back(at(first + glm::ivec3(x, y, z)));
                }
            }
        }
        return points;
    }

private:
    glm::ivec3 nodes_;
    std::vector<std::uint8_t> inside_;
};

// A cell that a surface touches.
struct Cell {
    FacetFit fit;
    FacetReach reach;
    std::uint64_t parts = 0;  // where it is split
    std::vector<FacetTexel> part_texels;
};

void split(Cell& cell, const std::vector<FacetPolygon>& polygons, const FacetBox& box, const glm::ivec3& place,
           const Points& points)
{
    const glm::dvec3 side = box.side / double(parts_a_side);
    for (int bit = 0; bit < parts_a_side * parts_a_side * parts_a_side; ++bit) {
        const glm::ivec3 part = glm::ivec3(bit, bit / parts_a_side, bit / parts_a_side / parts_a_side) % parts_a_side;
        const std::vector<std::uint8_t> inside = points.of_box((place * parts_a_side + part) * part_points, part_points);
        const FacetFit fit = fit_facets(polygons, {box.lower + side * glm::dvec3(part), side}, inside, part_points);
        if (fit.found) {
            cell.parts |= std::uint64_t(1) << bit;
            cell.part_texels.push_back(plane_texel(fit));
        }
    }
}

}  // namespace

Facets bake_facets(const Sample& sample, int cells, Job& job, bool boxes)
{
    if (cells < 4 || cells > 128) {
        throw InvalidArgument("the facets have " + std::to_string(cells) + " cells along u; give 4 to 128");
    }
    Facets facets;
    facets.cells = facet_cells(cells, sample.height(), sample.aspect());
    facets.height = sample.height();
    facets.aspect = sample.aspect();
    const glm::ivec3& n = facets.cells;
    const std::size_t count = static_cast<std::size_t>(n.x) * n.y * n.z;
    check_memory("the facets", 600.0 * static_cast<double>(count), "lower their number of cells");

    job.stage(0.0f, 0.1f);
    const Points points(sample, n, job);
    job.stage(0.1f, 0.2f);
    const std::vector<std::vector<FacetPolygon>> polygons = facet_polygons(sample, n, job);
    job.stage(0.2f, 0.8f);
    const glm::dvec3 side = glm::dvec3(1.0, sample.aspect(), sample.height()) / glm::dvec3(n);
    std::vector<Cell> fitted(count);
    parallel_for(job, n.z * n.y, [&](int row) {
        for (int x = 0; x < n.x && !job.cancelled(); ++x) {
            const std::size_t index = static_cast<std::size_t>(row) * n.x + x;
            if (polygons[index].empty()) {
                continue;
            }
            const glm::ivec3 place(x, row % n.y, row / n.y);
            const FacetBox box{glm::dvec3(place) * side, side};
            Cell& cell = fitted[index];
            cell.fit = fit_facets(polygons[index], box, points.of_box(place * points_a_side, points_a_side), points_a_side);
            if (cell.fit.wrong > most_wrong || cell.fit.miss * side.x > most_missed) {
                split(cell, polygons[index], box, place, points);
            }
        }
    });

    job.stage(0.8f, 0.95f);
    const FacetGrid grid{n, side, polygons, points_a_side, [&](const glm::ivec3& point) { return points.at(point) != 0; }};
    parallel_for(job, n.z * n.y, [&](int row) {
        for (int x = 0; x < n.x && !job.cancelled(); ++x) {
            Cell& cell = fitted[static_cast<std::size_t>(row) * n.x + x];
            if (cell.fit.found && cell.parts == 0) {
                cell.reach = facet_reach(cell.fit, {x, row % n.y, row / n.y}, grid);
            }
        }
    });

    job.stage(0.95f, 1.0f);
    std::vector<std::uint8_t> full(count);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::ivec3 place(i % n.x, i / n.x % n.y, i / n.x / n.y);
        full[i] = fitted[i].fit.found || points.at(place * points_a_side + points_a_side / 2) != 0 ? 1 : 0;
    }
    const std::vector<EmptyBoxes> reaches = boxes ? empty_boxes(full, n, job) : std::vector<EmptyBoxes>(count);
    std::vector<FacetTexel> texels(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Cell& cell = fitted[i];
        if (full[i] == 0) {
            texels[i] = empty_texel(reaches[i]);
        } else if (!cell.fit.found) {
            texels[i] = solid_texel();
        } else if (cell.parts == 0) {
            texels[i] = plane_texel(cell.fit, cell.reach);
        } else {
            texels[i] = split_texel(cell.parts, static_cast<std::uint32_t>(texels.size()));
            texels.insert(texels.end(), cell.part_texels.begin(), cell.part_texels.end());
        }
    }
    const std::size_t layer = static_cast<std::size_t>(n.x) * n.y;
    texels.resize((texels.size() + layer - 1) / layer * layer, FacetTexel{});
    if (texels.size() / layer > most_layers) {
        throw InvalidArgument("the facets need more than " + std::to_string(most_layers) +
                              " layers of a texture; change their number of cells");
    }
    for (const FacetTexel& texel : texels) {
        facets.texels.insert(facets.texels.end(), texel.begin(), texel.end());
    }
    return facets;
}

}  // namespace mesoshell
