// Facets, and the traversal `refined` that reads them: against the traversal `exact`, which asks the tile's triangles along
// the true path, and against closed forms.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "camera.h"
#include "facet_boxes.h"
#include "facet_fit.h"
#include "facet_reach.h"
#include "mesoshell/facets.h"
#include "meshes.h"
#include "render_with.h"

namespace mesoshell {
namespace {

constexpr int refined_traversal = 2;
constexpr float voxel = 1.0f / 64.0f;

// Two balls that overlap and a thin plate that leans: smooth, sharp and narrow, across the tile's borders too.
Sample balls_and_plate()
{
    Mesh plate = sphere({0.0f, 0.0f, 0.0f}, 0.3f, 8, 12);
    for (glm::vec3& p : plate.positions) {
        p = glm::vec3(0.15f * p.x + 0.8f * p.z + 0.7f, p.y + 0.9f, 0.7f * p.z - 0.1f * p.x + 0.28f);
    }
    return merged(merged(sphere({0.3f, 0.35f, 0.2f}, 0.17f, 16, 24), sphere({0.45f, 0.45f, 0.26f}, 0.17f, 16, 24)), plate)
        .sample(0.55f);
}

Map bake_map_of(const Sample& sample, int cells)
{
    Job job;
    Map map = sdf_map(sample, {48, 48, 27});
    const Facets facets = bake_facets(sample, cells, job);
    attach(map, &facets, nullptr);
    return map;
}

const Sample& tile()
{
    static const Sample sample = balls_and_plate();
    return sample;
}

const Map& tile_map()
{
    static const Map map = bake_map_of(tile(), 40);
    return map;
}

struct Agreement {
    int either = 0;
    int both = 0;
    double error = 0.0;  // mean, object units
    double far = 0.0;    // share of hits more than a voxel away
    double fetches = 0.0;
};

Agreement compare(const Rendering& picture, const Rendering& truth, double unit)
{
    Agreement result;
    double fetches = 0.0;
    int far = 0;
    for (std::size_t i = 0; i < picture.hit.size(); ++i) {
        result.either += (picture.hit[i] | truth.hit[i]) != 0 ? 1 : 0;
        fetches += picture.fetches[i];
        if (picture.hit[i] != 0 && truth.hit[i] != 0) {
            const double error = std::abs(picture.distance[i] - truth.distance[i]) / unit;
            result.both += 1;
            result.error += error;
            far += error > voxel ? 1 : 0;
        }
    }
    result.error /= result.both;
    result.far = static_cast<double>(far) / result.both;
    result.fetches = fetches / static_cast<double>(picture.hit.size());
    return result;
}

TEST(Facets, RefinedIsExactOnAPlane)
{
    const Shell shell = flat_grid(3, 3, 6.0f, 6.0f).shell(0.55f);
    for (const double elevation : {65.0, 35.0, 15.0}) {
        const double e = glm::radians(elevation);
        const glm::dvec3 target(3.1, 2.9, 0.2);
        const Camera camera(false, target + 8.0 * glm::dvec3(std::cos(e) * 0.9, std::cos(e) * 0.436, std::sin(e)), target,
                            elevation < 20.0 ? 0.4 : 1.2, {128, 128});
        const Rendering truth = render_exactly(shell, tile(), camera.view());
        const Agreement refined = compare(render_with(shell, tile_map(), camera.view(), refined_traversal), truth, 1.0);
        const Agreement sdf = compare(render_with(shell, tile_map(), camera.view(), sdf_traversal), truth, 1.0);
        ASSERT_GT(refined.both, 2000);
        EXPECT_GE(refined.both, 0.998 * refined.either) << elevation;
        EXPECT_LE(refined.error, 0.03 * voxel) << elevation;
        EXPECT_LE(refined.far, 2e-3) << elevation;
        EXPECT_LT(refined.error, 0.5 * sdf.error) << elevation;
        EXPECT_LT(refined.fetches, 0.6 * sdf.fetches) << elevation;
    }
}

// Prisms a tile wide on a torus: paths are curves, and one chord a stretch is voxels away.
TEST(Facets, RefinedFollowsCurves)
{
    const Shell shell = torus(1.0f, 0.42f, 12, 6, 10.0f, 5.0f).shell(0.31f);
    const Camera camera(true, {2.5, -2.6, 2.4}, {0, 0, 0}, 0.36, {96, 96});
    const Rendering truth = render_exactly(shell, tile(), camera.view());
    const Agreement refined = compare(render_with(shell, tile_map(), camera.view(), refined_traversal), truth, 0.6);
    ASSERT_GT(refined.both, 3000);
    EXPECT_GE(refined.both, 0.998 * refined.either);
    EXPECT_LE(refined.error, 0.1 * voxel);
    EXPECT_LE(refined.far, 5e-3);
}

TEST(Facets, NormalsAreThoseOfTheSurface)
{
    const Shell shell = flat_grid(3, 3, 6.0f, 6.0f).shell(0.55f);
    const Camera camera(false, {8.0, -2.0, 6.0}, {3.1, 2.9, 0.2}, 1.2, {96, 96});
    const Rendering truth = render_exactly(shell, tile(), camera.view());
    const Rendering picture = render_with(shell, tile_map(), camera.view(), refined_traversal);
    double degrees = 0.0;
    int hits = 0;
    for (std::size_t i = 0; i < picture.hit.size(); ++i) {
        if (picture.hit[i] != 0 && truth.hit[i] != 0) {
            degrees += glm::degrees(std::acos(glm::clamp(glm::dot(picture.normal[i], truth.normal[i]), -1.0f, 1.0f)));
            hits += 1;
        }
    }
    EXPECT_LE(degrees / hits, 2.0);
}

TEST(Facets, WithoutThemRefinedIsSphereTracing)
{
    const Map map = sdf_map(tile(), {24, 24, 14});
    const Shell shell = flat_grid(2, 2, 3.0f, 3.0f).shell(0.2f);
    const View view = Camera(true, {1.3, -0.7, 1.4}, {0.5, 0.5, 0.1}, 0.4, {32, 32}).view();
    const Rendering refined = render_with(shell, map, view, refined_traversal);
    const Rendering sdf = render_with(shell, map, view, sdf_traversal);
    EXPECT_EQ(refined.hit, sdf.hit);
    EXPECT_EQ(refined.fetches, sdf.fetches);
    EXPECT_EQ(refined.distance, sdf.distance);
}

TEST(Facets, BoxesHoldNoFullCell)
{
    std::mt19937 random(3);
    const glm::ivec3 cells(11, 7, 5);
    const auto index = [&](const glm::ivec3& cell) {
        const glm::ivec3 within = (cell % cells + cells) % cells;
        return (within.z * cells.y + within.y) * cells.x + within.x;
    };
    std::vector<std::uint8_t> full(11 * 7 * 5);
    for (std::uint8_t& cell : full) {
        cell = random() % 24 == 0 ? 1 : 0;
    }
    Job job;
    const std::vector<EmptyBoxes> boxes = empty_boxes(full, cells, job);
    int longer = 0;
    for (int i = 0; i < static_cast<int>(full.size()); ++i) {
        const glm::ivec3 cell(i % cells.x, i / cells.x % cells.y, i / cells.x / cells.y);
        for (int octant = 0; octant < 8 && full[i] == 0; ++octant) {
            const glm::ivec3 sign(2 * (octant & 1) - 1, (octant & 2) - 1, (octant & 4) / 2 - 1);
            const glm::u8vec3 code = boxes[i][octant];
            const glm::ivec3 reach(box_reaches[code.x], box_reaches[code.y], box_reaches[code.z]);
            longer += reach.x + reach.y + reach.z > 3 ? 1 : 0;
            for (int z = 0; z <= reach.z; ++z) {
                const int height = cell.z + sign.z * z;
                for (int y = 0; y <= reach.y && height >= 0 && height < cells.z; ++y) {
                    for (int x = 0; x <= reach.x; ++x) {
                        ASSERT_EQ(full[index({cell.x + sign.x * x, cell.y + sign.y * y, height})], 0);
                    }
                }
            }
        }
    }
    EXPECT_GT(longer, 500);
}

TEST(Facets, ATileWithNothingInTheWayTakesFewFetches)
{
    // A thin floor: one box leads down to it from the top of the tile.
    const Sample sample = slab(0.01f, 0.05f).sample(0.5f);
    const Map map = bake_map_of(sample, 32);
    const Shell shell = flat_grid(2, 2, 4.0f, 4.0f).shell(0.5f);
    const View view = Camera(false, {2.1, 1.9, 6.0}, {2.1, 2.2, 0.0}, 0.5, {16, 16}).view();
    const Rendering picture = render_with(shell, map, view, refined_traversal);
    for (std::size_t i = 0; i < picture.hit.size(); ++i) {
        ASSERT_EQ(picture.hit[i], 1);
        EXPECT_LE(picture.fetches[i], 3);
        EXPECT_NEAR(picture.texture[i].z, 0.1f, 1e-3f);
    }
}

// Three planes of a cube's corner, and of the hole that it leaves: fits without an error.
TEST(Facets, CornersAreFittedExactly)
{
    const FacetBox box{{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};
    constexpr int side = 8;
    for (const bool hollow : {false, true}) {
        // The cube [0.4, 2]^3, or all but it.
        std::vector<FacetPolygon> polygons;
        for (int axis = 0; axis < 3; ++axis) {
            FacetPolygon polygon;
            polygon.normal[axis] = hollow ? 1.0 : -1.0;
            for (const glm::dvec2 place : {glm::dvec2(0.4, 0.4), {2, 0.4}, {2, 2}, {0.4, 2}}) {
                glm::dvec3 corner(0.4);
                corner[(axis + 1) % 3] = place.x;
                corner[(axis + 2) % 3] = place.y;
                polygon.corners.push_back(corner);
            }
            polygons.push_back(polygon);
        }
        std::vector<std::uint8_t> inside;
        for (int i = 0; i < 729; ++i) {
            const bool in_cube = i % 9 > 0.4 * side && i / 9 % 9 > 0.4 * side && i / 81 > 0.4 * side;
            inside.push_back(in_cube != hollow ? 1 : 0);
        }
        const FacetFit fit = fit_facets(polygons, box, inside, side);
        EXPECT_TRUE(fit.found);
        EXPECT_EQ(fit.wrong, 0);
        EXPECT_NEAR(fit.miss, 0.0, 1e-12);
    }
}

// The plane of a floor holds in the cells beside and above, and beyond the slab, but not in one that a step touches.
TEST(Facets, PlanesReachAsFarAsTheyHold)
{
    const glm::ivec3 cells(6, 3, 2);
    const glm::dvec3 side(1.0 / 6.0, 1.0 / 3.0, 0.25);
    // The floor is 0.1 high, 0.2 in the last column.
    const auto height_at = [](int column) { return column < 5 ? 0.1 : 0.2; };
    std::vector<std::vector<FacetPolygon>> polygons(36);
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 6; ++x) {
            FacetPolygon polygon;
            polygon.normal = {0.0, 0.0, 1.0};
            for (const glm::ivec2 corner : {glm::ivec2(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
                polygon.corners.push_back(glm::dvec3(glm::dvec2(x + corner.x, y + corner.y) * glm::dvec2(side), height_at(x)));
            }
            polygon.area = side.x * side.y;
            polygon.center = 0.5 * (polygon.corners[0] + polygon.corners[2]);
            polygons[y * 6 + x].push_back(polygon);
        }
    }
    const FacetGrid grid{cells, side, polygons, 8, [&](const glm::ivec3& point) {
        return point.z * side.z / 8 < height_at(point.x / 8 % 6);
    }};
    std::vector<std::uint8_t> inside;
    for (int i = 0; i < 729; ++i) {
        inside.push_back(i / 81 * side.z / 8 < 0.1 ? 1 : 0);
    }
    const FacetFit fit = fit_facets(polygons[2], {{2.0 * side.x, 0.0, 0.0}, side}, inside, 8);
    const FacetReach flat = facet_reach(fit, {2, 0, 0}, grid);
    EXPECT_EQ(flat.back, glm::ivec3(1, 1, 1));
    EXPECT_EQ(flat.forward, glm::ivec3(1, 1, 1));
    const FacetReach at_step = facet_reach(fit, {3, 0, 0}, grid);
    EXPECT_EQ(at_step.back, glm::ivec3(1, 1, 1));
    EXPECT_EQ(at_step.forward, glm::ivec3(0, 1, 1));
}

// Boxes lead over cells in which nothing is met: without them rays meet the same, a cell a fetch.
TEST(Facets, BoxesOnlySaveFetches)
{
    Job job;
    Map without = tile_map();
    const Facets facets = bake_facets(tile(), tile_map().facets.cells.x, job, false);
    ASSERT_EQ(facets.texels.size(), tile_map().facets.texels.size());
    attach(without, &facets, nullptr);
    const Shell shell = flat_grid(3, 3, 6.0f, 6.0f).shell(0.55f);
    for (const double height : {7.0, 2.0}) {
        const View view = Camera(false, {8.0, -2.0, height}, {3.1, 2.9, 0.2}, 1.0, {96, 96}).view();
        const Rendering truth = render_with(shell, tile_map(), view, refined_traversal);
        const Rendering picture = render_with(shell, without, view, refined_traversal);
        const Agreement with_boxes = compare(truth, truth, 1.0);
        const Agreement cell_by_cell = compare(picture, truth, 1.0);
        ASSERT_GT(cell_by_cell.both, 2000);
        // Rays through an edge of cells may take another of them, as places are rounded.
        EXPECT_GE(cell_by_cell.both, cell_by_cell.either - 2) << height;
        EXPECT_LE(cell_by_cell.error, 1e-5) << height;
        EXPECT_LE(cell_by_cell.far, 1e-3) << height;
        EXPECT_GT(cell_by_cell.fetches, 1.5 * with_boxes.fetches) << height;
        int fewer = 0;
        for (std::size_t i = 0; i < picture.fetches.size(); ++i) {
            fewer += picture.fetches[i] < truth.fetches[i] ? 1 : 0;
        }
        EXPECT_LE(fewer, 2) << height;
    }
}

TEST(Facets, NumbersOutOfRange)
{
    const Sample sample = slab(0.01f, 0.05f).sample(0.5f);
    Job job;
    for (const int cells : {3, 129}) {
        EXPECT_THROW(bake_facets(sample, cells, job), InvalidArgument);
    }
    EXPECT_EQ(bake_facets(sample, 4, job).cells, glm::ivec3(4, 4, 2));
}

}  // namespace
}  // namespace mesoshell
