// The signed distance field against closed forms, at its nodes and between them.
#include <algorithm>
#include <cmath>

#include "ball_lattice.h"
#include "check.h"
#include "mesoshell/bake.h"
#include "mesoshell/render.h"
#include "meshes.h"

namespace mesoshell {
namespace {

// Coordinates stay below 4 tile widths, distances below 2: a few ulps.
constexpr double rounding = 16 * 0x1p-23;

Sdf bake(const Sample& sample, const glm::ivec3& nodes)
{
    Job job;
    return bake_sdf(sample, nodes, job);
}

glm::dvec3 node_place(const Sdf& sdf, int x, int y, int z)
{
    return {double(x) / sdf.nodes.x, sdf.aspect * double(y) / sdf.nodes.y, sdf.height * double(z) / (sdf.nodes.z - 1)};
}

template <typename Check>
void for_each_node(const Sdf& sdf, const Check& check)
{
    std::size_t i = 0;
    for (int z = 0; z < sdf.nodes.z; ++z) {
        for (int y = 0; y < sdf.nodes.y; ++y) {
            for (int x = 0; x < sdf.nodes.x; ++x) {
                check(node_place(sdf, x, y, z), static_cast<double>(sdf.values[i++]));
            }
        }
    }
}

// The field alone, as a map.
Map map_of(const Sdf& sdf)
{
    Map map;
    map.height = sdf.height;
    map.aspect = sdf.aspect;
    map.sdf_nodes = sdf.nodes;
    map.sdf = sdf.values;
    map.precision = Precision::single;
    return map;
}

TEST(BakeSdf, Slab)
{
    const Sdf sdf = bake(slab(0.21f, 0.44f, 0.6f).sample(0.7f, 0.6f), {7, 5, 12});
    EXPECT_EQ(sdf.nodes, glm::ivec3(7, 5, 12));
    ASSERT_EQ(sdf.values.size(), 7u * 5u * 12u);
    for_each_node(sdf, [](const glm::dvec3& p, double value) {
        ASSERT_NEAR(value, std::max(0.21f - p.z, p.z - 0.44f), rounding) << "z " << p.z;
    });
}

TEST(BakeSdf, SlabThatTheTileBoxCuts)
{
    // What is left of [-0.2, 0.3] is [0, 0.3], and the cap at 0 is surface too.
    const Sdf sdf = bake(slab(-0.2f, 0.3f).sample(0.7f), {4, 4, 15});
    for_each_node(sdf, [](const glm::dvec3& p, double value) {
        ASSERT_NEAR(value, std::max(-p.z, p.z - 0.3f), rounding) << "z " << p.z;
    });
    const Sdf upper = bake(slab(0.3f, 1.1f).sample(0.7f), {4, 4, 15});
    for_each_node(upper, [](const glm::dvec3& p, double value) {
        ASSERT_NEAR(value, std::max(0.3f - p.z, p.z - 0.7f), rounding) << "z " << p.z;
    });
}

// Between the fields of the balls around and within the polyhedra.
void check_balls(const glm::vec3& center, float radius, float height, float aspect, const glm::ivec3& nodes)
{
    const Mesh mesh = sphere(center, radius, 24, 48);
    const BallLattice around{glm::dvec3(center), outer_radius(mesh, glm::dvec3(center)), height, aspect};
    const BallLattice within{glm::dvec3(center), inner_radius(mesh, glm::dvec3(center)), height, aspect};
    int inside = 0;
    for_each_node(bake(mesh.sample(height, aspect), nodes), [&](const glm::dvec3& p, double value) {
        ASSERT_GE(value, around.signed_distance(p) - rounding) << p.x << " " << p.y << " " << p.z;
        ASSERT_LE(value, within.signed_distance(p) + rounding) << p.x << " " << p.y << " " << p.z;
        inside += value < 0.0 ? 1 : 0;
    });
    EXPECT_GT(inside, 0);
}

TEST(BakeSdf, Balls)
{
    check_balls({0.5f, 0.5f, 0.3f}, 0.2f, 0.6f, 1.0f, {16, 16, 9});
}

TEST(BakeSdf, BallsAtRandomPlaces)
{
    Random random(11);
    for (int i = 0; i < 4; ++i) {
        const float aspect = static_cast<float>(random.uniform(0.7, 1.7));
        const glm::vec3 center(random.in_box({-1.0, -1.0, 0.25}, {2.0, 2.0, 0.35}));
        check_balls(center, static_cast<float>(random.uniform(0.15, 0.24)), 0.6f, aspect, {11, 7, 10});
    }
}

TEST(BakeSdf, BallsThatTheTileBoxCuts)
{
    // Half a ball and more, and less than half: then the nearest point may lie on the rim of the cap.
    check_balls({0.3f, 0.2f, 0.04f}, 0.3f, 0.5f, 1.0f, {13, 13, 11});
    check_balls({0.3f, 0.2f, -0.1f}, 0.3f, 0.5f, 1.0f, {13, 13, 11});
    check_balls({0.3f, 0.2f, 0.62f}, 0.3f, 0.5f, 0.9f, {13, 13, 11});
}

TEST(BakeSdf, NoSteeperThanDistance)
{
    const Mesh links = merged(sphere({0.1f, 0.2f, 0.15f}, 0.3f, 9, 11), sphere({0.7f, 0.6f, 0.4f}, 0.22f, 7, 13));
    const Sdf sdf = bake(links.sample(0.5f, 1.3f), {9, 14, 8});
    const auto at = [&](int x, int y, int z) {
        return sdf.values[(std::size_t(z) * sdf.nodes.y + y % sdf.nodes.y) * sdf.nodes.x + x % sdf.nodes.x];
    };
    for (int z = 0; z < sdf.nodes.z; ++z) {
        for (int y = 0; y < sdf.nodes.y; ++y) {
            for (int x = 0; x < sdf.nodes.x; ++x) {
                ASSERT_LE(std::abs(at(x + 1, y, z) - at(x, y, z)), 1.0 / 9 + rounding);
                ASSERT_LE(std::abs(at(x, y + 1, z) - at(x, y, z)), 1.3 / 14 + rounding);
                if (z + 1 < sdf.nodes.z) {
                    ASSERT_LE(std::abs(at(x, y, z + 1) - at(x, y, z)), 0.5 / 7 + rounding);
                    ASSERT_LE(std::abs(at(x + 1, y + 1, z + 1) - at(x, y, z)),
                              glm::length(glm::dvec3(1.0 / 9, 1.3 / 14, 0.5 / 7)) + rounding);
                }
            }
        }
    }
}

TEST(BakeSdf, InterpolatedAnywhereInTheSlab)
{
    // Linear along z in every cell without a kink, so interpolation is exact there. Kinks: the middle of the solid.
    const Sdf sdf = bake(slab(0.21f, 0.44f).sample(0.7f), {4, 4, 29});
    const double middle = 0.5 * (0.21 + 0.44);
    Random random(5);
    std::vector<glm::vec3> points;
    for (int i = 0; i < 2000; ++i) {
        points.emplace_back(random.in_box({-2.0, -2.0, 0.0}, {2.0, 2.0, 1.0}));
    }
    const std::vector<float> values = lookup_sdf(map_of(sdf), points);
    int exact = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double z = 0.7f * points[i].z;
        if (std::abs(z - middle) > 0.7 / 28) {
            ASSERT_NEAR(values[i], std::max(0.21f - z, z - 0.44f), 2 * rounding);
            exact += 1;
        }
    }
    EXPECT_GT(exact, 1800);
}

TEST(BakeSdf, InterpolatedAnywhereAroundBalls)
{
    // Trilinear interpolation of f errs by at most the sum over the axes of h^2 / 8 max|f''|, and the second derivative
    // of a distance at distance d from a ball's center is at most 1 / d, except where two balls are equally near. The
    // polyhedron adds the distance between the balls around and within it. Anywhere, a field of slope 1 errs by at most
    // half the diagonal of a cell.
    const glm::vec3 center(0.43f, 0.57f, 0.3f);
    const Mesh mesh = sphere(center, 0.25f, 48, 96);
    const glm::ivec3 nodes(20, 24, 13);
    const double aspect = 1.2f;
    const double height = 0.6f;
    const Sdf sdf = bake(mesh.sample(0.6f, 1.2f), nodes);
    const glm::dvec3 cell(1.0 / nodes.x, aspect / nodes.y, height / (nodes.z - 1));
    const BallLattice balls{glm::dvec3(center), 0.25f, height, aspect};
    const double layer = 0.25 - inner_radius(mesh, glm::dvec3(center));
    Random random(6);
    std::vector<glm::vec3> points;
    for (int i = 0; i < 5000; ++i) {
        points.emplace_back(random.in_box({-1.0, -1.0, 0.0}, {2.0, 2.0, 1.0}));
    }
    const std::vector<float> values = lookup_sdf(map_of(sdf), points);
    int smooth = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 p = glm::dvec3(points[i]) * glm::dvec3(1.0, aspect, height);
        glm::dvec3 offset = p - glm::dvec3(center);
        offset.x -= std::round(offset.x);
        offset.y -= std::round(offset.y / aspect) * aspect;
        const double error = std::abs(values[i] - balls.signed_distance(p));
        ASSERT_LE(error, 0.5 * glm::length(cell) + layer + rounding);
        const double nearest_center = glm::length(offset) - glm::length(cell);
        const bool one_ball = std::abs(offset.x) < 0.5 - cell.x && std::abs(offset.y) < 0.5 * aspect - cell.y;
        if (nearest_center > 0.1 && one_ball) {
            ASSERT_LE(error, glm::dot(cell, cell) / 8.0 / nearest_center + layer + rounding);
            smooth += 1;
        }
    }
    EXPECT_GT(smooth, 2500);
}

TEST(BakeSdf, FlippedWindingChangesNothing)
{
    const Mesh mesh = sphere({0.5f, 0.5f, 0.3f}, 0.2f, 8, 12);
    Mesh one_flipped = mesh;
    std::swap(one_flipped.triangles[20].x, one_flipped.triangles[20].y);
    const glm::ivec3 nodes(7, 9, 6);
    const Sdf sdf = bake(mesh.sample(0.6f), nodes);
    const Sdf of_flipped = bake(flipped(mesh).sample(0.6f), nodes);
    const Sdf of_one_flipped = bake(one_flipped.sample(0.6f), nodes);
    for (std::size_t i = 0; i < sdf.values.size(); ++i) {
        ASSERT_NEAR(of_flipped.values[i], sdf.values[i], rounding);
        ASSERT_NEAR(of_one_flipped.values[i], sdf.values[i], rounding);
    }
}

TEST(BakeSdf, ResolutionOutOfRange)
{
    const Sample sample = slab(0.1f, 0.2f).sample(0.7f);
    for (int axis = 0; axis < 3; ++axis) {
        for (const int bad : {1, 0, -1, 4097}) {
            glm::ivec3 nodes(4);
            nodes[axis] = bad;
            expect_refusal<InvalidArgument>([&] { bake(sample, nodes); }, {"SDF resolution", "2 to 4096"});
        }
    }
}

}  // namespace
}  // namespace mesoshell
