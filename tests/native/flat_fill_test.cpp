// Triangles over outlines: their boundary is the outline, none is turned over, and areas are those of the outlines.
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "check.h"
#include "flat_fill.h"

namespace mesoshell {
namespace {

struct Outline {
    std::vector<glm::i64vec2> points;
    std::vector<glm::uvec2> segments;

    void add(const std::vector<glm::i64vec2>& ring)
    {
        const auto first = static_cast<std::uint32_t>(points.size());
        const auto count = static_cast<std::uint32_t>(ring.size());
        points.insert(points.end(), ring.begin(), ring.end());
        for (std::uint32_t i = 0; i < count; ++i) {
            segments.emplace_back(first + i, first + (i + 1) % count);
        }
    }
};

double twice_area(const glm::i64vec2& a, const glm::i64vec2& b, const glm::i64vec2& c)
{
    const glm::dvec2 ab(b - a);
    const glm::dvec2 ac(c - a);
    return ab.x * ac.y - ab.y * ac.x;
}

// A star about a center, its radii at random within [low, high]; clockwise for holes.
std::vector<glm::i64vec2> star(Random& random, const glm::dvec2& center, double low, double high, int corners, bool clockwise)
{
    std::vector<glm::i64vec2> ring;
    for (int i = 0; i < corners; ++i) {
        const double angle = (clockwise ? -1.0 : 1.0) * 2.0 * 3.14159265358979 * (i + random.uniform(0.1, 0.9)) / corners;
        const double radius = random.uniform(low, high);
        ring.emplace_back(std::llround(center.x + radius * std::cos(angle)), std::llround(center.y + radius * std::sin(angle)));
    }
    return ring;
}

void check_fill(const Outline& outline)
{
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
    double outline_area = 0.0;
    for (const glm::uvec2& s : outline.segments) {
        balance[{s.x, s.y}] -= 1;
        balance[{s.y, s.x}] += 1;
        outline_area += twice_area(outline.points[0], outline.points[s.x], outline.points[s.y]);
    }
    double area = 0.0;
    for (const glm::uvec3& t : fill_region(outline.points, outline.segments)) {
        const double own = twice_area(outline.points[t.x], outline.points[t.y], outline.points[t.z]);
        EXPECT_GE(own, 0.0);
        area += own;
        for (int i = 0; i < 3; ++i) {
            balance[{t[i], t[(i + 1) % 3]}] += 1;
            balance[{t[(i + 1) % 3], t[i]}] -= 1;
        }
    }
    // None is turned over and none is missing: so they do not overlap either.
    EXPECT_NEAR(area, outline_area, 1e-9 * outline_area);
    for (const auto& [edge, count] : balance) {
        EXPECT_EQ(count, 0) << "from " << edge.first << " to " << edge.second;
    }
}

TEST(FlatFill, StarsWithHolesAndIslands)
{
    Random random(11);
    for (int i = 0; i < 60; ++i) {
        Outline outline;
        outline.add(star(random, {0, 0}, 9e5, 2e6, 40, false));
        for (int k = 0; k < 5; ++k) {
            const double turn = 2.0 * 3.14159265358979 * k / 5;
            const glm::dvec2 center = 5e5 * glm::dvec2(std::cos(turn), std::sin(turn));
            outline.add(star(random, center, 1e5, 2.5e5, 3 + random.below(9), true));
            outline.add(star(random, center, 2e4, 4e4, 3 + random.below(9), false));
        }
        outline.add(star(random, {3e6, 3e6}, 1e5, 9e5, 12, false));
        check_fill(outline);
    }
}

TEST(FlatFill, HolesInARow)
{
    // All rightmost points at one height, which also is that of corners of the outline.
    Outline outline;
    outline.add({{0, 0}, {100, 0}, {100, 5}, {100, 10}, {0, 10}, {0, 5}});
    for (std::int64_t x = 10; x < 90; x += 10) {
        outline.add({{x, 5}, {x + 3, 8}, {x + 6, 5}, {x + 3, 2}});
    }
    check_fill(outline);
}

TEST(FlatFill, LoopsThatTouchAtAPoint)
{
    Outline outline;
    outline.points = {{0, 0}, {4, 0}, {2, 3}, {4, 6}, {0, 6}};
    outline.segments = {{0, 1}, {1, 2}, {2, 0}, {2, 3}, {3, 4}, {4, 2}};
    check_fill(outline);
    EXPECT_EQ(fill_region(outline.points, outline.segments).size(), 2u);
}

TEST(FlatFill, BorderIsClosedBetweenEndsAndBeginnings)
{
    // A band from the left side to the right: the border goes down on the left and up on the right.
    Outline outline;
    outline.points = {{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 2}, {8, 2}, {8, 5}, {0, 5}};
    outline.segments = {{4, 5}, {6, 7}};
    const std::vector<std::uint32_t> corners{0, 1, 2, 3};
    std::vector<glm::uvec2> segments = outline.segments;
    ASSERT_TRUE(close_along_border(outline.points, corners, false, segments));
    EXPECT_EQ(segments.size(), 4u);
    outline.segments = segments;
    check_fill(outline);
    // What lies without the band goes around the corners.
    segments = {{5, 4}, {7, 6}};
    ASSERT_TRUE(close_along_border(outline.points, corners, false, segments));
    EXPECT_EQ(segments.size(), 8u);
    outline.segments = segments;
    check_fill(outline);
    // Two ends in a row bound nothing.
    segments = {{4, 5}, {7, 6}, {4, 6}};
    EXPECT_FALSE(close_along_border(outline.points, corners, false, segments));
    // Nothing at the border: all of it or none.
    segments.clear();
    ASSERT_TRUE(close_along_border(outline.points, corners, true, segments));
    EXPECT_EQ(segments.size(), 4u);
    segments.clear();
    ASSERT_TRUE(close_along_border(outline.points, corners, false, segments));
    EXPECT_TRUE(segments.empty());
}

}  // namespace
}  // namespace mesoshell
