// The inverse maps of a prism against double precision: places by bisection (PrismTruth), of every shape and distance.
#include <cmath>
#include <optional>

#include "check.h"
#include "mesoshell/render.h"
#include "prism_truth.h"

namespace mesoshell {
namespace {

// What the inverse maps promise, in prism coordinates, tile units and sizes of the prism.
constexpr double promised = 1e-5;

// How a coordinate that large is rounded.
double ulp(double value)
{
    return std::abs(value) * 0x1p-23;
}

// Not inlined: GCC 12 at -O3 takes the conversion and the one back to double for no change.
[[gnu::noinline]] glm::vec3 rounded(const glm::dvec3& v)
{
    return glm::vec3(v);
}

double largest(const glm::dvec3& v)
{
    return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z)));
}

// The map's Jacobian has one sign on a lattice of the prism, as far from zero as a tenth of its value in the middle.
bool folds(const PrismTruth& truth)
{
    const auto volume = [&](const glm::dvec3& q) {
        constexpr double step = 1e-4;
        const glm::dvec3 here = truth.position(q);
        return glm::dot(truth.position(q + glm::dvec3(step, 0, 0)) - here,
                        glm::cross(truth.position(q + glm::dvec3(0, step, 0)) - here,
                                   truth.position(q + glm::dvec3(0, 0, step)) - here));
    };
    const double middle = volume({1.0 / 3.0, 1.0 / 3.0, 0.5});
    for (int i = 0; i <= 4; ++i) {
        for (int k = 0; k <= 4 - i; ++k) {
            for (int z = 0; z <= 4; ++z) {
                if (volume(glm::dvec3(i, k, z) / 4.0) / middle < 0.1) {
                    return true;
                }
            }
        }
    }
    return false;
}

// An edge of 1, columns of the given height that lean, turned anywhere, some of them mirrored, `away` from the origin. The
// texture is some tiles large and tiles away from (0, 0), and shears from the base to the top.
PrismTexels turned_prism(Random& random, double thickness, double away)
{
    const glm::dvec3 up = random.direction();
    const glm::dvec3 side = glm::normalize(glm::cross(up, random.direction()));
    const glm::dmat3 turn(side, glm::cross(up, side) * (random.below(2) == 0 ? 1.0 : -1.0), up);
    const glm::dvec3 center = away * random.direction();
    const glm::dvec3 corners[3] = {{0, 0, 0}, {1, 0, 0}, {0.3, 0.9, 0}};
    const double lean = 0.4 * std::min(thickness, 1.0);
    const double tiles = random.uniform(0.2, 8.0);
    PrismTexels texels{};
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 base = corners[i] + random.in_box({-0.25, -0.25, 0.0}, {0.25, 0.25, 0.0});
        const glm::dvec3 top = base + random.in_box({-lean, -lean, 0.5 * thickness}, {lean, lean, 1.5 * thickness});
        const glm::dvec3 uv = tiles * corners[i] + random.in_box(glm::dvec3(-0.2 * tiles), glm::dvec3(0.2 * tiles)) + 3.0;
        const glm::dvec3 uv_top = uv + random.in_box(glm::dvec3(-0.1 * tiles), glm::dvec3(0.1 * tiles));
        texels[i] = glm::vec4(glm::vec3(center + turn * base), uv.x);
        texels[i + 3] = glm::vec4(glm::vec3(center + turn * top), uv_top.x);
        texels[6 + i / 4][static_cast<int>(i)] = static_cast<float>(uv.y);
        (i == 0 ? texels[6].w : texels[7][static_cast<int>(i) - 1]) = static_cast<float>(uv_top.y);
    }
    return texels;
}

glm::dvec3 random_place(Random& random)
{
    const double a = random.uniform(0.0, 1.0);
    const double b = random.uniform(0.0, 1.0);
    return {a + b > 1.0 ? 1.0 - a : a, a + b > 1.0 ? 1.0 - b : b, random.uniform(0.0, 1.0)};
}

TEST(PrismInverse, PlacesOfPositionsAreExact)
{
    for (const double away : {0.0, 1e3}) {
        for (const double thickness : {1e-3, 1e-2, 0.1, 1.0, 10.0}) {
            Random random(11);
            int inside = 0;
            double worst = 0.0;
            for (int i = 0; i < 15000; ++i) {
                const PrismTexels prism = turned_prism(random, thickness, away * std::max(thickness, 1.0));
                const PrismTruth truth(prism);
                if (folds(truth)) {
                    continue;
                }
                // The nearest point that single precision has: far away that may lie outside.
                const glm::vec3 point = rounded(truth.position(random_place(random)));
                const PrismTruth::Place place = truth.locate(glm::dvec3(point));
                if (place.depth < 0.0) {
                    continue;
                }
                const std::optional<glm::vec3> found = place_of_position(prism, point);
                ASSERT_TRUE(found) << "thickness " << thickness << ", " << away << " away, prism " << i;
                worst = std::max(worst, largest(glm::dvec3(*found) - place.q));
                ASSERT_LE(glm::length(truth.position(glm::dvec3(*found)) - glm::dvec3(point)), promised * truth.size());
                const glm::vec3 texture = *texture_of_position(prism, point);
                const glm::dvec2 expected = texture_at(prism, place.q);
                ASSERT_NEAR(texture.x, expected.x, promised + 2.0 * ulp(16.0));
                ASSERT_NEAR(texture.y, expected.y, promised + 2.0 * ulp(16.0));
                ASSERT_NEAR(texture.z, place.q.z, promised);
                inside += 1;
            }
            EXPECT_LE(worst, promised) << "thickness " << thickness << ", " << away << " away";
            EXPECT_GT(inside, 5000) << "thickness " << thickness << ", " << away << " away";
        }
    }
}

TEST(PrismInverse, WhatLiesOutsideHasNoPlace)
{
    Random random(12);
    int inside = 0;
    int outside = 0;
    for (int i = 0; i < 20000; ++i) {
        const double thickness = std::pow(10.0, random.uniform(-3.0, 1.0));
        const PrismTexels prism = turned_prism(random, thickness, 0.0);
        const PrismTruth truth(prism);
        if (folds(truth)) {
            continue;
        }
        const glm::vec3 point = rounded(truth.position(random_place(random) * 1.3 - 0.15));
        const double depth = truth.depth(glm::dvec3(point));
        // Roundings of the point, seen as shares of the thickness.
        if (std::abs(depth) > 1e-5 + 4e-6 / std::min(thickness, 1.0)) {
            ASSERT_EQ(place_of_position(prism, point).has_value(), depth > 0.0) << "prism " << i << ", depth " << depth;
            (depth > 0.0 ? inside : outside) += 1;
        }
    }
    EXPECT_GT(inside, 3000);
    EXPECT_GT(outside, 3000);
}

TEST(PrismInverse, TexturePlacesAreExact)
{
    Random random(13);
    for (int i = 0; i < 50000; ++i) {
        const PrismTexels prism = turned_prism(random, 0.5, 0.0);
        const glm::dvec3 q = random_place(random);
        const glm::vec3 texture = rounded({texture_at(prism, q), q.z});
        const std::optional<glm::vec3> found = place_of_texture(prism, texture);
        ASSERT_TRUE(found) << "prism " << i;
        // The place is that of a rounded texture position: what counts is where it is in the texture.
        ASSERT_LE(glm::length(texture_at(prism, glm::dvec3(*found)) - glm::dvec2(texture)), promised);
        ASSERT_EQ(found->z, texture.z);
        const glm::dvec3 beyond = glm::dvec3(1.01, 0.0, 0.0) * random.uniform(1.0, 3.0) + glm::dvec3(0.0, q.y, q.z);
        ASSERT_FALSE(place_of_texture(prism, glm::vec3(texture_at(prism, beyond), q.z))) << "prism " << i;
        ASSERT_FALSE(place_of_texture(prism, {texture.x, texture.y, 1.001f}));
        ASSERT_FALSE(place_of_texture(prism, {texture.x, texture.y, -0.001f}));
    }
}

TEST(PrismInverse, ThereAndBackIsWhereItWas)
{
    Random random(14);
    int trips = 0;
    for (int i = 0; i < 20000; ++i) {
        const PrismTexels prism = turned_prism(random, std::pow(10.0, random.uniform(-2.0, 1.0)), 0.0);
        const PrismTruth truth(prism);
        if (folds(truth)) {
            continue;
        }
        // Not so near the border that a rounding takes it across.
        const glm::dvec3 q = 0.98 * random_place(random) + 0.005;
        const glm::vec3 point = rounded(truth.position(q));
        const std::optional<glm::vec3> texture = texture_of_position(prism, point);
        ASSERT_TRUE(texture) << "prism " << i;
        const std::optional<glm::vec3> back = position_of_texture(prism, *texture);
        ASSERT_TRUE(back) << "prism " << i;
        ASSERT_LE(glm::length(*back - point), promised * truth.size()) << "prism " << i;

        const glm::vec3 start = rounded({texture_at(prism, q), q.z});
        const std::optional<glm::vec3> object = position_of_texture(prism, start);
        ASSERT_TRUE(object) << "prism " << i;
        const std::optional<glm::vec3> again = texture_of_position(prism, *object);
        ASSERT_TRUE(again) << "prism " << i;
        // The object position in between is rounded, which the texture sees in tiles a length and heights a thickness.
        ASSERT_LE(largest(glm::dvec3(*again) - glm::dvec3(start)), promised + 4.0 * 0x1p-24 * 40.0 * truth.size()) << i;
        trips += 1;
    }
    EXPECT_GT(trips, 8000);
}

TEST(PrismInverse, EqualDirectorsMakeAnAffineMap)
{
    // The cubic has only its linear term then, and the inverse is that of a matrix.
    Random random(15);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 base(random.in_box(glm::dvec3(-1.0), glm::dvec3(1.0)));
        const glm::dmat3 axes{random.direction(), random.direction(), random.direction()};
        if (std::abs(glm::determinant(axes)) < 0.05) {
            continue;
        }
        const std::array<glm::vec3, 3> bottom{base, base + glm::vec3(axes[0]), base + glm::vec3(axes[1])};
        const glm::vec3 director(axes[2]);
        const PrismTexels prism = prism_of(bottom, {bottom[0] + director, bottom[1] + director, bottom[2] + director});
        const glm::dmat3 to_object(glm::dvec3(prism[1]) - glm::dvec3(prism[0]), glm::dvec3(prism[2]) - glm::dvec3(prism[0]),
                                   glm::dvec3(prism[3]) - glm::dvec3(prism[0]));
        const glm::vec3 point = rounded(glm::dvec3(base) + to_object * (0.98 * random_place(random) + 0.005));
        const glm::dvec3 expected = glm::inverse(to_object) * (glm::dvec3(point) - glm::dvec3(base));
        const std::optional<glm::vec3> found = place_of_position(prism, point);
        ASSERT_TRUE(found) << "prism " << i;
        // Rounded tops differ from equal directors by as much as they are rounded, over the least height of the prism.
        ASSERT_LE(largest(glm::dvec3(*found) - expected), promised) << "prism " << i;
    }
}

TEST(PrismInverse, ColumnsMayMeetInAPointOrHaveNoHeight)
{
    // A pyramid: all columns end in its apex, where weights mean nothing. A wedge: column 0 has no height.
    const std::array<glm::vec3, 3> base{glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)};
    const glm::vec3 apex(0.25f, 0.25f, 1.0f);
    const PrismTexels pyramid = prism_of(base, {apex, apex, apex});
    const PrismTexels wedge = prism_of(base, {base[0], base[1] + glm::vec3(0, 0, 1), base[2] + glm::vec3(0.1f, 0, 1.5f)});
    Random random(16);
    for (const PrismTexels& prism : {pyramid, wedge}) {
        const PrismTruth truth(prism);
        for (int i = 0; i < 20000; ++i) {
            const glm::vec3 point = rounded(truth.position(0.98 * random_place(random) + 0.005));
            const std::optional<glm::vec3> found = place_of_position(prism, point);
            ASSERT_TRUE(found) << "point " << i;
            ASSERT_LE(glm::length(truth.position(glm::dvec3(*found)) - glm::dvec3(point)), promised);
        }
        for (std::size_t corner = 0; corner < 6; ++corner) {
            const glm::vec3 point(prism[corner]);
            const std::optional<glm::vec3> found = place_of_position(prism, point);
            ASSERT_TRUE(found) << "corner " << corner;
            ASSERT_LE(glm::length(truth.position(glm::dvec3(*found)) - glm::dvec3(point)), promised) << "corner " << corner;
        }
    }
    EXPECT_FALSE(place_of_position(pyramid, {0.25f, 0.25f, 1.01f}));
    EXPECT_FALSE(place_of_position(wedge, {-0.01f, 0.0f, 0.0f}));
}

TEST(PrismInverse, NoPlaceWithoutVolumeOrTexture)
{
    const std::array<glm::vec3, 3> base{glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)};
    const PrismTexels flat = prism_of(base, base);
    EXPECT_FALSE(place_of_position(flat, {0.25f, 0.25f, 0.5f}));
    EXPECT_FALSE(place_of_position(flat, {0.25f, 1.25f, 0.0f}));
    // All corners at one place of the texture, or on a line through it.
    const glm::vec3 up(0, 0, 1);
    PrismTexels prism = prism_of(base, {base[0] + up, base[1] + up, base[2] + up});
    EXPECT_FALSE(place_of_texture(prism, {0.0f, 0.0f, 0.5f}));
    for (std::size_t i = 0; i < 6; ++i) {
        prism[i].w = 0.1f * static_cast<float>(i % 3);
    }
    prism[6] = glm::vec4(0.0f, 0.3f, 0.6f, 0.0f);
    prism[7] = glm::vec4(0.3f, 0.6f, 0.0f, 0.0f);
    EXPECT_FALSE(place_of_texture(prism, {0.1f, 0.3f, 0.5f}));
    EXPECT_TRUE(place_of_position(prism, {0.25f, 0.25f, 0.5f}));
}

TEST(PrismInverse, APointOnAFinHasAPlaceInBothPrisms)
{
    Random random(17);
    int points = 0;
    for (int i = 0; i < 20000; ++i) {
        const PrismTexels here = turned_prism(random, std::pow(10.0, random.uniform(-3.0, 1.0)), random.uniform(0.0, 30.0));
        const PrismTruth truth(here);
        // The neighbor across the fin of columns 1 and 2: column 0 mirrored through the middle of the fin.
        const glm::dvec3 through = truth.position({0.5, 0.5, 0.0}) * 2.0;
        const glm::dvec3 through_top = truth.position({0.5, 0.5, 1.0}) * 2.0;
        PrismTexels there = here;
        there[0] = glm::vec4(glm::vec3(through - glm::dvec3(here[0])), 0.0f);
        there[3] = glm::vec4(glm::vec3(through_top - glm::dvec3(here[3])), 0.0f);
        std::swap(there[1], there[2]);
        std::swap(there[4], there[5]);
        if (folds(truth) || folds(PrismTruth(there))) {
            continue;
        }
        const double along = random.uniform(0.0, 1.0);
        const glm::vec3 point = rounded(truth.position({along, 1.0 - along, random.uniform(0.0, 1.0)}));
        ASSERT_TRUE(place_of_position(here, point)) << "fin " << i;
        ASSERT_TRUE(place_of_position(there, point)) << "fin " << i;
        points += 1;
    }
    EXPECT_GT(points, 8000);
}

}  // namespace
}  // namespace mesoshell
