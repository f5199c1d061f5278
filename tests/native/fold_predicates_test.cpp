// Exact signs, against integers of 128 bits; crossings of triangles, against sampled points; where a prism turns inside out.
#include <algorithm>
#include <cmath>
#include <random>

#include "check.h"
#include "fold_crossing.h"
#include "fold_jacobian.h"
#include "predicates.h"

namespace mesoshell {
namespace {

int integer_orientation(const glm::ivec3& a, const glm::ivec3& b, const glm::ivec3& c, const glm::ivec3& d)
{
    __extension__ using Wide = __int128;
    const auto difference = [&](const glm::ivec3& p, int i) { return static_cast<Wide>(p[i]) - a[i]; };
    const auto minor = [&](int i, int j) {
        return difference(c, i) * difference(d, j) - difference(c, j) * difference(d, i);
    };
    const Wide sum = difference(b, 0) * minor(1, 2) + difference(b, 1) * minor(2, 0) + difference(b, 2) * minor(0, 1);
    return sum > 0 ? 1 : sum < 0 ? -1 : 0;
}

TEST(Predicates, OrientationIsThatOfIntegers)
{
    std::mt19937 random(1);
    int zeros = 0;
    for (int i = 0; i < 20000; ++i) {
        const int reach = i % 2 == 0 ? 3 : (1 << 23);
        std::uniform_int_distribution<int> any(-reach, reach);
        const auto point = [&] { return glm::ivec3(any(random), any(random), any(random)); };
        const glm::ivec3 a = point(), b = point(), c = point();
        // In the plane of the others, exactly or but for one unit, in every other case.
        const glm::ivec3 d = i % 4 < 2 ? point() : b + c - a + glm::ivec3(0, 0, any(random) % 2);
        const int expected = integer_orientation(a, b, c, d);
        zeros += expected == 0 ? 1 : 0;
        if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) < 1 << 24) {
            EXPECT_EQ(orientation(glm::vec3(a), glm::vec3(b), glm::vec3(c), glm::vec3(d)), expected);
        }
    }
    EXPECT_GT(zeros, 1000);
}

TEST(Predicates, OrientationAtTheEndsOfTheRange)
{
    // A plane through the origin and a point off it by the least float there is.
    const float tiny = 0x1p-149f;
    const float huge = 0x1.fffffep127f;
    const glm::vec3 a(huge, 0, 0), b(0, huge, 0), c(-huge, -huge, 0);
    EXPECT_EQ(orientation(a, b, c, glm::vec3(1, 1, tiny)), 1);
    EXPECT_EQ(orientation(a, b, c, glm::vec3(1, 1, -tiny)), -1);
    EXPECT_EQ(orientation(glm::vec3(tiny, 0, 0), glm::vec3(0, tiny, 0), glm::vec3(0), glm::vec3(huge, huge, tiny)), 1);
    // z = x for all, at very different sizes.
    EXPECT_EQ(orientation(glm::vec3(huge, 1, huge), glm::vec3(tiny, -huge, tiny), glm::vec3(1, tiny, 1), glm::vec3(3, 7, 3)),
              0);
}

// --- Triangles ---

TEST(Crossing, EqualsSampledIntervals)
{
    // Small whole coordinates make every kind of contact. A point inside both triangles is sought in closed form: along the
    // line of both planes, each triangle has an interval.
    std::mt19937 random(2);
    std::uniform_int_distribution<int> any(-3, 3);
    int crossings = 0, others = 0;
    for (int i = 0; i < 200000; ++i) {
        glm::dvec3 p[3], q[3];
        Triangle a, b;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = glm::dvec3(any(random), any(random), any(random));
            q[k] = glm::dvec3(any(random), any(random), any(random));
            a[k] = glm::vec3(p[k]);
            b[k] = glm::vec3(q[k]);
        }
        const glm::dvec3 normal_p = glm::cross(p[1] - p[0], p[2] - p[0]);
        const glm::dvec3 normal_q = glm::cross(q[1] - q[0], q[2] - q[0]);
        const glm::dvec3 line = glm::cross(normal_p, normal_q);
        if (line == glm::dvec3(0.0)) {
            continue;  // parallel, or without area
        }
        const auto interval = [&](const glm::dvec3* t, const glm::dvec3& normal, const glm::dvec3& on) {
            double low = 1e30, high = -1e30;
            for (int k = 0; k < 3; ++k) {
                const double s0 = glm::dot(normal, t[k] - on), s1 = glm::dot(normal, t[(k + 1) % 3] - on);
                if (s0 * s1 < 0.0) {
                    const double at = glm::dot(line, glm::mix(t[k], t[(k + 1) % 3], s0 / (s0 - s1)));
                    low = std::min(low, at);
                    high = std::max(high, at);
                }
                if (s0 == 0.0) {
                    low = std::min(low, glm::dot(line, t[k]));
                    high = std::max(high, glm::dot(line, t[k]));
                }
            }
            const bool both =
                std::min({glm::dot(normal, t[0] - on), glm::dot(normal, t[1] - on), glm::dot(normal, t[2] - on)}) < 0 &&
                std::max({glm::dot(normal, t[0] - on), glm::dot(normal, t[1] - on), glm::dot(normal, t[2] - on)}) > 0;
            return both ? glm::dvec2(low, high) : glm::dvec2(1.0, 0.0);
        };
        const glm::dvec2 in_p = interval(p, normal_q, q[0]);
        const glm::dvec2 in_q = interval(q, normal_p, p[0]);
        const bool expected =
            in_p.x < in_p.y && in_q.x < in_q.y && std::max(in_p.x, in_q.x) < std::min(in_p.y, in_q.y) - 1e-9;
        EXPECT_EQ(crossing(a, Inside::front, b, Inside::back), expected);
        (expected ? crossings : others) += 1;
    }
    EXPECT_GT(crossings, 10000);
    EXPECT_GT(others, 10000);
}

TEST(Crossing, CoplanarOnesByTheirSides)
{
    const Triangle a{glm::vec3(0, 0, 1), glm::vec3(4, 0, 1), glm::vec3(0, 4, 1)};
    const Triangle inside{glm::vec3(1, 1, 1), glm::vec3(2, 1, 1), glm::vec3(1, 2, 1)};
    const Triangle turned{inside[0], inside[2], inside[1]};
    const Triangle beside{glm::vec3(4, 4, 1), glm::vec3(0, 4, 1), glm::vec3(4, 0, 1)};  // shares the long edge
    EXPECT_TRUE(crossing(a, Inside::front, inside, Inside::front));
    EXPECT_FALSE(crossing(a, Inside::front, inside, Inside::back));
    EXPECT_TRUE(crossing(a, Inside::front, turned, Inside::back));
    EXPECT_FALSE(crossing(a, Inside::front, turned, Inside::front));
    EXPECT_FALSE(crossing(a, Inside::front, beside, Inside::front));
    EXPECT_TRUE(crossing(a, Inside::front, a, Inside::front));
}

TEST(Crossing, TwistedFinsFillLittleOfTheirHull)
{
    // The saddle z = u v over the unit square, whose hull reaches z = 1/2 in its middle (the other diagonal: 0), where it is
    // 1/4.
    const Patch saddle{glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(1, 1, 1), glm::vec3(0, 1, 0)};
    const auto plate = [](float z) {
        return Triangle{glm::vec3(0.45f, 0.45f, z), glm::vec3(0.55f, 0.45f, z), glm::vec3(0.5f, 0.55f, z)};
    };
    EXPECT_FALSE(crossing(saddle, plate(0.4f), Inside::front, true));
    EXPECT_FALSE(crossing(saddle, plate(0.1f), Inside::front, true));
    EXPECT_TRUE(crossing(saddle, plate(0.1f), Inside::front, false)) << "the hull alone";
    EXPECT_TRUE(crossing(saddle, plate(0.25f), Inside::front, true));
    const Triangle upright{glm::vec3(0.5f, 0.5f, 0.2f), glm::vec3(0.55f, 0.5f, 0.4f), glm::vec3(0.5f, 0.55f, 0.4f)};
    EXPECT_TRUE(crossing(saddle, upright, Inside::front, true));
}

// --- One prism ---

PrismCorners straight(float height)
{
    return {{glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)},
            {glm::vec3(0, 0, height), glm::vec3(1, 0, height), glm::vec3(0, 1, height)}};
}

TEST(Jacobian, StraightPrismsAreNotInverted)
{
    EXPECT_FALSE(inverted(straight(1.0f)));
    EXPECT_FALSE(inverted(straight(0x1p-140f)));
    EXPECT_TRUE(inverted(straight(-1.0f)));
    EXPECT_FALSE(inverted(straight(0.0f))) << "it has no inside";
}

TEST(Jacobian, ColumnsWithoutThickness)
{
    for (int mask = 0; mask < 8; ++mask) {
        PrismCorners prism = straight(1.0f);
        PrismCorners turned = straight(-1.0f);
        for (std::size_t i = 0; i < 3; ++i) {
            if ((mask >> i & 1) != 0) {
                prism.top[i] = prism.base[i];
                turned.top[i] = turned.base[i];
            }
        }
        EXPECT_FALSE(inverted(prism));
        EXPECT_EQ(inverted(turned), mask != 7);
    }
}

// The triangle turns about its center by `angle` while it rises: N(w) has the length |1 - w + w e^(i angle)|^2, which is
// least halfway, cos^2(angle / 2), and zero there for a half turn.
PrismCorners turning(double angle, double scale)
{
    PrismCorners prism;
    for (std::size_t i = 0; i < 3; ++i) {
        const double at = 2.0943951023931953 * static_cast<double>(i);
        prism.base[i] = glm::vec3(std::cos(at), std::sin(at), 0.0);
        prism.top[i] = glm::vec3(scale * std::cos(at + angle), scale * std::sin(at + angle), 1.0);
    }
    return prism;
}

TEST(Jacobian, InteriorZerosAreDecidedExactly)
{
    // Base and top corners whose triangle shrinks to a point halfway and opens again, half a turn on: zero there, exactly.
    PrismCorners pinched = straight(1.0f);
    for (std::size_t i = 0; i < 3; ++i) {
        pinched.top[i] = glm::vec3(1.0f - pinched.base[i].x, 1.0f - pinched.base[i].y, 1.0f);
    }
    EXPECT_TRUE(inverted(pinched));
    // Less than that is positive everywhere.
    EXPECT_FALSE(inverted(turning(3.0, 1.0)));
    EXPECT_FALSE(inverted(turning(2.0, 0.5)));
}

TEST(Jacobian, InvertsBetweenPositiveEnds)
{
    // E1 goes from (1, 0) to (-1, c) and E2 from (0, 1) to (c, -1): halfway they are (0, c / 2) and (c / 2, 0), whose cross
    // product is -c^2 / 4, while at the ends it is 1 and 1 - c^2.
    for (const float c : {0.5f, 0x1p-10f, 0x1p-20f}) {
        PrismCorners prism{{glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)},
                           {glm::vec3(0, 0, 1), glm::vec3(-1, c, 1), glm::vec3(c, -1, 1)}};
        EXPECT_TRUE(inverted(prism)) << c;
        const PrismCorners ends[2] = {{prism.base, {prism.base[0] + glm::vec3(0, 0, 1), prism.base[1] + glm::vec3(0, 0, 1),
                                                    prism.base[2] + glm::vec3(0, 0, 1)}},
                                      {prism.top, {prism.top[0] + glm::vec3(0, 0, 1), prism.top[1] + glm::vec3(0, 0, 1),
                                                   prism.top[2] + glm::vec3(0, 0, 1)}}};
        EXPECT_FALSE(inverted(ends[0]));
        EXPECT_FALSE(inverted(ends[1]));
        // With the other sign of one, b2 = 1 + c^2 is enough.
        prism.top[2].x = -c;
        EXPECT_FALSE(inverted(prism)) << c;
    }
}

TEST(Jacobian, EqualsDenseSampling)
{
    std::mt19937 random(3);
    std::normal_distribution<float> normal(0.0f, 1.0f);
    int counts[2] = {0, 0};
    for (int i = 0; i < 4000; ++i) {
        PrismCorners prism = straight(1.0f);
        const float size = i % 2 == 0 ? 0.5f : 1.5f;
        for (std::size_t k = 0; k < 3; ++k) {
            prism.top[k] += size * glm::vec3(normal(random), normal(random), 0.5f * normal(random));
        }
        double least = 1e30;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 column = glm::dvec3(prism.top[k]) - glm::dvec3(prism.base[k]);
            for (int step = 0; step <= 1000; ++step) {
                const double w = step / 1000.0;
                const auto at = [&](std::size_t j) {
                    return glm::mix(glm::dvec3(prism.base[j]), glm::dvec3(prism.top[j]), w);
                };
                least = std::min(least, glm::dot(glm::cross(at(1) - at(0), at(2) - at(0)), column));
            }
        }
        if (std::abs(least) > 1e-3) {  // steps of 1/1000 miss the least by some 1e-6 of the curvature
            EXPECT_EQ(inverted(prism), least < 0.0);
            counts[least < 0.0 ? 1 : 0] += 1;
        }
    }
    EXPECT_GT(counts[0], 500);
    EXPECT_GT(counts[1], 500);
}

TEST(Jacobian, SoundShareReachesTheLeast)
{
    // The prism from the surface to the share of its height has a Jacobian of `least` of the surface's somewhere, and no
    // less.
    std::mt19937 random(4);
    std::normal_distribution<float> normal(0.0f, 1.0f);
    int reduced = 0;
    for (int i = 0; i < 2000; ++i) {
        PrismCorners prism = straight(1.0f);
        for (std::size_t k = 0; k < 3; ++k) {
            prism.top[k] += 0.7f * glm::vec3(normal(random), normal(random), 0.2f * normal(random));
        }
        for (const double surface : {0.0, 0.5, 1.0}) {
            const double share = sound_share(prism, surface, 0.01);
            double least = 1e30;
            bool positive = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const glm::dvec3 column = glm::dvec3(prism.top[k]) - glm::dvec3(prism.base[k]);
                const auto at = [&](double w) {
                    const auto p = [&](std::size_t j) {
                        return glm::mix(glm::dvec3(prism.base[j]), glm::dvec3(prism.top[j]), w);
                    };
                    return glm::dot(glm::cross(p(1) - p(0), p(2) - p(0)), column);
                };
                positive = positive && at(surface) > 0.0;
                for (int step = 0; step <= 200; ++step) {
                    const double low = surface - surface * share, high = surface + (1.0 - surface) * share;
                    least = std::min(least, at(low + (high - low) * step / 200.0) / at(surface));
                }
            }
            if (!positive) {
                EXPECT_EQ(share, 0.0);
            } else if (share < 1.0) {
                EXPECT_NEAR(least, 0.01, 1e-3);
                ++reduced;
            } else {
                EXPECT_GT(least, 0.01 - 1e-9);
            }
        }
    }
    EXPECT_GT(reduced, 200);
}

}  // namespace
}  // namespace mesoshell
