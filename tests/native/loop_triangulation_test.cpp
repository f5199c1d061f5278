// Surfaces that span a polygon: its own edges and no others are open, and in a plane it has the polygon's area.
#include "loop_triangulation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "check.h"

namespace mesoshell {
namespace {

double area_of(const std::vector<glm::dvec3>& corners, const std::vector<std::array<std::uint32_t, 3>>& triangles)
{
    double area = 0.0;
    for (const auto& t : triangles) {
        area += 0.5 * glm::length(glm::cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]]));
    }
    return area;
}

void expect_spans(const std::vector<glm::dvec3>& corners, const std::vector<std::array<std::uint32_t, 3>>& triangles)
{
    EXPECT_EQ(triangles.size(), corners.size() - 2);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
    for (const auto& t : triangles) {
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t a = t[i];
            const std::uint32_t b = t[(i + 1) % 3];
            sides[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
    }
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
        const auto next = static_cast<std::uint32_t>((i + 1) % corners.size());
        int& sum = sides[{std::min(i, next), std::max(i, next)}];
        EXPECT_EQ(sum, i < next ? 1 : -1);
        sum = 0;
    }
    for (const auto& [side, sum] : sides) {
        EXPECT_EQ(sum, 0) << side.first << " " << side.second;
    }
}

TEST(LoopTriangulation, OfAStarInAPlane)
{
    // Concave: a fan would lie partly outside.
    std::vector<glm::dvec3> star;
    double area = 0.0;
    for (int i = 0; i < 22; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 22;
        star.push_back((i % 2 == 0 ? 1.0 : 0.4) * glm::dvec3(std::cos(angle), 0.6 * std::sin(angle), 0.8 * std::sin(angle)));
    }
    for (std::size_t i = 0; i < star.size(); ++i) {
        area += 0.5 * glm::length(glm::cross(star[i], star[(i + 1) % star.size()]));
    }
    const auto triangles = triangulate_loop(star);
    expect_spans(star, triangles);
    EXPECT_NEAR(area_of(star, triangles), area, 1e-12);
}

TEST(LoopTriangulation, OfALongCircle)
{
    std::vector<glm::dvec3> circle;
    for (int i = 0; i < 1500; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 1500;
        circle.emplace_back(std::cos(angle), 1.0, -std::sin(angle));
    }
    const auto triangles = triangulate_loop(circle);
    expect_spans(circle, triangles);
    EXPECT_NEAR(area_of(circle, triangles), 750 * std::sin(2.0 * std::numbers::pi / 1500), 1e-9);
}

TEST(LoopTriangulation, OfASquareBentAlongItsDiagonal)
{
    // Two ways, of which the one with the crease along the shorter diagonal has less area.
    const std::vector<glm::dvec3> square{{1, 0, 0}, {0, 1, 0.9}, {-1, 0, 0}, {0, -1, 0.9}};
    const auto triangles = triangulate_loop(square);
    expect_spans(square, triangles);
    EXPECT_NEAR(area_of(square, triangles), 2.0 * std::sqrt(1.0 + 0.81), 1e-12);
}

TEST(LoopTriangulation, OfTooFewCorners)
{
    EXPECT_TRUE(triangulate_loop({}).empty());
    const std::vector<glm::dvec3> two{{0, 0, 0}, {1, 0, 0}};
    EXPECT_TRUE(triangulate_loop(two).empty());
}

}  // namespace
}  // namespace mesoshell
