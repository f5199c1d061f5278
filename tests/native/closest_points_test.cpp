// The nearest points of a tile's surface against a loop over all triangles and copies.
#include <algorithm>
#include <cmath>
#include <limits>

#include "check.h"
#include "closest_point.h"
#include "mesoshell/attributes.h"
#include "meshes.h"

namespace mesoshell {
namespace {

SurfacePoints bake(const Sample& sample, const glm::ivec3& nodes, int threads = 0)
{
    Job job(threads);
    return closest_points(sample, nodes, job);
}

template <typename Check>
void for_each_node(const Sample& sample, const glm::ivec3& nodes, const Check& check)
{
    std::size_t i = 0;
    for (int z = 0; z < nodes.z; ++z) {
        for (int y = 0; y < nodes.y; ++y) {
            for (int x = 0; x < nodes.x; ++x) {
                check(i++, glm::dvec3(double(x) / nodes.x, sample.aspect() * double(y) / nodes.y,
                                      sample.height() * double(z) / (nodes.z - 1)));
            }
        }
    }
}

glm::dvec3 place_of(const Sample& sample, const SurfacePoints& points, std::size_t i)
{
    const glm::uvec3& t = sample.input_triangles()[points.triangles[i]];
    const glm::dvec2 weights(points.weights[i]);
    const auto corner = [&](int k) { return glm::dvec3(sample.input_positions()[t[k]]); };
    return corner(0) * (1.0 - weights.x - weights.y) + corner(1) * weights.x + corner(2) * weights.y;
}

// Of a place and its copies, as far as two periods.
double periodic_distance(const glm::dvec3& a, const glm::dvec3& b, double aspect)
{
    double least = std::numeric_limits<double>::infinity();
    for (int j = -2; j <= 2; ++j) {
        for (int i = -2; i <= 2; ++i) {
            least = std::min(least, glm::length(a - b + glm::dvec3(i, j * aspect, 0.0)));
        }
    }
    return least;
}

Mesh random_triangles(std::uint32_t seed, int count, float aspect, float height)
{
    Random random(seed);
    Mesh mesh;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 center = random.in_box({-0.1, -0.1, 0.0}, {1.1, aspect + 0.1, height});
        for (int corner = 0; corner < 3; ++corner) {
            const glm::dvec3 offset = random.in_box(glm::dvec3(-0.2), glm::dvec3(0.2));
            mesh.positions.emplace_back(center + offset);
            mesh.positions.back().z = std::clamp(mesh.positions.back().z, 0.01f, height - 0.01f);
        }
        const auto first = static_cast<std::uint32_t>(3 * i);
        mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
    return mesh;
}

TEST(ClosestPoints, AmongAllTrianglesAndCopies)
{
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
        const float aspect = 0.5f + 0.4f * static_cast<float>(seed);
        const Mesh mesh = random_triangles(seed, 12, aspect, 0.6f);
        const Sample sample(mesh.positions, mesh.triangles, 0.6f, aspect, {.thickness = 0.01f});
        const glm::ivec3 nodes(9, 7, 6);
        const SurfacePoints points = bake(sample, nodes);
        for_each_node(sample, nodes, [&](std::size_t i, const glm::dvec3& node) {
            double nearest = std::numeric_limits<double>::infinity();
            double of_found = nearest;
            for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
                for (int copy = 0; copy < 25; ++copy) {
                    const glm::vec3 p(node - glm::dvec3(copy % 5 - 2, (copy / 5 - 2) * aspect, 0.0));
                    const glm::uvec3& t = mesh.triangles[k];
                    const double distance =
                        std::sqrt(squared_distance(p, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]));
                    nearest = std::min(nearest, distance);
                    of_found = k == points.triangles[i] ? std::min(of_found, distance) : of_found;
                }
            }
            ASSERT_LT(points.triangles[i], mesh.triangles.size());
            ASSERT_NEAR(of_found, nearest, 1e-6);
            ASSERT_NEAR(periodic_distance(place_of(sample, points, i), node, aspect), nearest, 1e-6);
            const glm::vec2 weights = points.weights[i];
            ASSERT_GE(std::min(weights.x, std::min(weights.y, 1.0f - weights.x - weights.y)), -1e-6f);
            ASSERT_NEAR(glm::length(points.outward[i]), 1.0f, 1e-5f);
        });
    }
}

TEST(ClosestPoints, OfEquallyNearTrianglesTheFirst)
{
    // Two floors with the same triangles in the plane between them: a node half-way is as near to the one as to the other.
    const float height = 0.5f;
    const Mesh lower = flipped(slab(0.0f, 0.125f, 1.0f, 2, 2));
    const Mesh upper = slab(0.375f, 0.5f, 1.0f, 2, 2);
    const glm::ivec3 nodes(8, 8, 3);
    for (const bool lower_first : {true, false}) {
        const Sample sample = (lower_first ? merged(lower, upper) : merged(upper, lower)).sample(height);
        const SurfacePoints points = bake(sample, nodes);
        for (std::size_t i = 64; i < 128; ++i) {
            ASSERT_LT(points.triangles[i], lower.triangles.size()) << "the first mesh has the first triangles";
            const double z = place_of(sample, points, i).z;
            ASSERT_EQ(z, lower_first ? 0.125 : 0.375);
        }
    }
}

TEST(ClosestPoints, ThreadsChangeNothing)
{
    const Mesh mesh = sphere({0.3f, 0.4f, 0.25f}, 0.2f, 12, 16);
    const Sample sample = mesh.sample(0.5f, 0.9f);
    const SurfacePoints alone = bake(sample, {16, 16, 9}, 1);
    for (int round = 0; round < 4; ++round) {
        const SurfacePoints points = bake(sample, {16, 16, 9}, 2 + round);
        EXPECT_EQ(points.triangles, alone.triangles);
        EXPECT_EQ(points.weights, alone.weights);
        EXPECT_EQ(points.outward, alone.outward);
    }
}

TEST(ClosestPoints, OutwardIsAwayFromABallWhateverItsFaces)
{
    const glm::vec3 center(0.4f, 0.5f, 0.25f);
    const Mesh mesh = sphere(center, 0.2f, 24, 32);
    const glm::ivec3 nodes(11, 13, 8);
    for (const Mesh& either : {mesh, flipped(mesh)}) {
        const Sample sample = either.sample(0.5f);
        const SurfacePoints points = bake(sample, nodes);
        for_each_node(sample, nodes, [&](std::size_t i, const glm::dvec3&) {
            const glm::dvec3 radial = glm::normalize(place_of(sample, points, i) - glm::dvec3(center));
            ASSERT_GT(glm::dot(radial, glm::dvec3(points.outward[i])), 0.98);
        });
    }
}

TEST(ClosestPoints, WhatTheSlabCutsOffIsNotSeen)
{
    // The ball's lower half is below the slab, and so is its nearest point to the nodes at w = 0 in its middle.
    const Sample sample = sphere({0.5f, 0.5f, 0.0f}, 0.3f, 24, 32).sample(0.5f);
    const glm::ivec3 nodes(16, 16, 5);
    const SurfacePoints points = bake(sample, nodes);
    for_each_node(sample, nodes, [&](std::size_t i, const glm::dvec3& node) {
        const glm::dvec3 place = place_of(sample, points, i);
        ASSERT_GE(place.z, -1e-6);
        // The rim at z = 0 belongs to it.
        const double away = glm::length(node - glm::dvec3(0.5, 0.5, 0.0));
        ASSERT_NEAR(periodic_distance(place, node, 1.0), std::abs(away - 0.3), 0.012);
    });
}

TEST(ClosestPoints, SheetWhoseThicknessAloneReachesIntoTheSlab)
{
    const Mesh sheet{{{0, 0, -0.01f}, {1, 0, -0.01f}, {1, 1, -0.01f}, {0, 1, -0.01f}}, {{0, 1, 2}, {0, 2, 3}}};
    const Sample sample(sheet.positions, sheet.triangles, 0.5f, 1.0f, {.thickness = 0.1f});
    const SurfacePoints points = bake(sample, {4, 4, 3});
    for_each_node(sample, {4, 4, 3}, [&](std::size_t i, const glm::dvec3& node) {
        ASSERT_NEAR(periodic_distance(place_of(sample, points, i), node, 1.0), node.z + 0.01, 1e-6);
    });
}

TEST(ClosestPoints, FacesWithoutAnAreaAreNobodysNearest)
{
    Mesh mesh{{{0.5f, 0.5f, 0.2f}}, {{0, 0, 0}}};
    mesh = merged(mesh, sphere({0.5f, 0.5f, 0.2f}, 0.15f, 6, 8));
    const SurfacePoints points = bake(mesh.sample(0.4f), {8, 8, 5});
    EXPECT_EQ(std::count(points.triangles.begin(), points.triangles.end(), 0u), 0);
}

TEST(ClosestPoints, ResolutionOutOfRange)
{
    const Sample sample = slab(0.1f, 0.2f).sample(0.7f);
    for (int axis = 0; axis < 3; ++axis) {
        for (const int bad : {1, 0, -1, 4097}) {
            glm::ivec3 nodes(4);
            nodes[axis] = bad;
            expect_refusal<InvalidArgument>([&] { bake(sample, nodes); }, {"attributes", "2 to 4096"});
        }
    }
}

}  // namespace
}  // namespace mesoshell
