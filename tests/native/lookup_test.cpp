// The shader text's lookups against plain multilinear interpolation, written out here in double precision.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "check.h"
#include "mesoshell/render.h"

namespace mesoshell {
namespace {

struct Axis {
    int count;
    bool periodic;
};

// Values in C order at fractional node coordinates.
template <std::size_t n>
double interpolate(std::span<const double> values, const std::array<Axis, n>& axes, const std::array<double, n>& at)
{
    double sum = 0.0;
    for (unsigned corner = 0; corner < 1u << n; ++corner) {
        double weight = 1.0;
        std::size_t index = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const int count = axes[i].count;
            const double node = axes[i].periodic ? at[i] : std::clamp(at[i], 0.0, double(count - 1));
            const double low = std::floor(node);
            const bool upper = (corner >> i & 1u) != 0;
            weight *= upper ? node - low : 1.0 - (node - low);
            int k = static_cast<int>(low) + (upper ? 1 : 0);
            k = axes[i].periodic ? (k % count + count) % count : std::min(k, count - 1);
            index = index * static_cast<std::size_t>(count) + static_cast<std::size_t>(k);
        }
        sum += weight * values[index];
    }
    return sum;
}

// A map of random terms: no symmetry hides an exchanged axis.
Map random_map(int terms, Random& random, Layout layout = Layout::paper)
{
    Map map;
    map.layout = layout;
    map.resolution.nodes = glm::ivec3(6, 4, 5);
    map.resolution.ntheta = 7;
    map.resolution.nphi = 9;
    map.height = 0.6f;
    map.aspect = 1.3f;
    map.terms = terms;
    map.precision = Precision::single;
    map.weights.resize(static_cast<std::size_t>(terms) * map.weight_azimuths() * 4 * 6);
    map.eigenmaps.resize(static_cast<std::size_t>(terms) * map.eigen_azimuths() * 7 * 5);
    map.sdf_nodes = glm::ivec3(5, 8, 4);
    map.sdf.resize(5 * 8 * 4);
    for (std::vector<float>* values : {&map.weights, &map.eigenmaps, &map.sdf}) {
        for (float& value : *values) {
            value = static_cast<float>(random.uniform(-0.4, 1.0));
        }
    }
    return map;
}

// What the terms sum to, [nphi, ny, nx, ntheta, nz].
std::vector<double> multiplied_out(const Map& map)
{
    const std::size_t nodes = 4 * 6;
    const std::size_t columns = 7 * 5;
    const bool by_nodes = map.layout == Layout::nodes;
    std::vector<double> values(9 * nodes * columns, 0.0);
    for (std::size_t k = 0; k < static_cast<std::size_t>(map.terms); ++k) {
        for (std::size_t i = 0; i < values.size(); ++i) {
            const std::size_t column = i % columns;
            const std::size_t node = i / columns % nodes;
            const std::size_t phi = i / columns / nodes;
            const std::size_t weight = by_nodes ? k * nodes + node : (k * 9 + phi) * nodes + node;
            const std::size_t eigenmap = by_nodes ? (k * 9 + phi) * columns + column : k * columns + column;
            values[i] += double(map.weights[weight]) * double(map.eigenmaps[eigenmap]);
        }
    }
    return values;
}

// Values lie within 1.4 * terms of one another; a node coordinate of up to 9 errs by at most 8 ulps of 2^-21 (the angle
// by as much, more steeply near the poles, which the test keeps away from), in five dimensions.
double lookup_error(int terms)
{
    return 5 * 8 * 0x1p-21 * 1.4 * terms;
}

void check_gdm(int terms, std::uint32_t seed, Layout layout = Layout::paper)
{
    Random random(seed);
    const Map map = random_map(terms, random, layout);
    const std::vector<double> raw = multiplied_out(map);
    const std::array<Axis, 5> axes{Axis{9, true}, {4, true}, {6, true}, {7, false}, {5, false}};
    std::vector<glm::vec3> points;
    std::vector<glm::vec3> dirs;
    while (points.size() < 3000) {
        const glm::dvec3 dir = random.direction();
        if (std::hypot(dir.x, dir.y) > 0.1) {
            points.emplace_back(random.in_box({-2.0, -2.0, -0.2}, {3.0, 3.0, 1.2}));
            dirs.emplace_back(dir * random.uniform(0.1, 10.0));
        }
    }
    const std::vector<float> found = lookup_gdm(map, points, dirs);
    ASSERT_EQ(found.size(), points.size());
    int positive = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 p(points[i]);
        const glm::dvec3 d = glm::normalize(glm::dvec3(dirs[i]));
        const double turn = std::atan2(d.y, d.x) / (2.0 * 3.14159265358979324);
        const double truth =
            interpolate<5>(raw, axes, {turn * 9, p.y * 4, p.x * 6, std::acos(d.z) / 3.14159265358979324 * 6, p.z * 4});
        ASSERT_NEAR(found[i], std::max(truth, 0.0), lookup_error(terms)) << "point " << i;
        positive += truth > 0.0 ? 1 : 0;
    }
    EXPECT_GT(positive, 1000);
}

TEST(LookupGdm, InterpolatesInFiveDimensions)
{
    check_gdm(1, 1);
    check_gdm(4, 2);
}

TEST(LookupGdm, TermsThatFillNoGroupOfFour)
{
    check_gdm(3, 3);
    check_gdm(5, 4);
    check_gdm(10, 5);
}

TEST(LookupGdm, AzimuthAlongTheEigenmaps)
{
    check_gdm(1, 11, Layout::nodes);
    check_gdm(7, 12, Layout::nodes);
}

TEST(LookupGdm, SharesOfTheWayOutOfTheSlab)
{
    // Terms that sum to 1/4 everywhere: a quarter of the way, but never more than a quarter of the horizon's distance.
    Random random(13);
    Map map = random_map(1, random, Layout::share);
    std::fill(map.weights.begin(), map.weights.end(), 0.5f);
    std::fill(map.eigenmaps.begin(), map.eigenmaps.end(), 0.5f);
    int near_horizon = 0;
    for (int i = 0; i < 3000; ++i) {
        const glm::vec3 point(random.in_box({-1.0, -1.0, 0.0}, {2.0, 2.0, 1.0}));
        glm::dvec3 dir = random.direction();
        dir.z *= i % 2 == 0 ? 1.0 : 0.01;
        const glm::vec3 given(glm::normalize(dir));
        const double way = given.z > 0.0f ? (1.0 - point.z) * 0.6 / given.z : point.z * 0.6 / -given.z;
        const double expected = std::min(way, static_cast<double>(horizon_distance)) / 4.0;
        near_horizon += way > horizon_distance ? 1 : 0;
        ASSERT_NEAR(lookup_gdm(map, {&point, 1}, {&given, 1})[0], expected, 1e-5 * (1.0 + expected)) << i;
    }
    EXPECT_GT(near_horizon, 100);
}

TEST(LookupGdm, NodesHoldTheirValues)
{
    Random random(6);
    Map map = random_map(2, random);
    for (float& value : map.eigenmaps) {
        value = std::abs(value);
    }
    for (float& value : map.weights) {
        value = std::abs(value);
    }
    const std::vector<double> raw = multiplied_out(map);
    for (std::size_t i = 0; i < raw.size(); ++i) {
        const int z = static_cast<int>(i % 5);
        const int theta = static_cast<int>(i / 5 % 7);
        const int x = static_cast<int>(i / 35 % 6);
        const int y = static_cast<int>(i / 210 % 4);
        const int phi = static_cast<int>(i / 840);
        if (phi != 0 && (theta == 0 || theta == 6)) {
            continue;  // at the poles every azimuth is one direction
        }
        const glm::vec3 point(static_cast<float>(x) / 6.0f, static_cast<float>(y) / 4.0f, static_cast<float>(z) / 4.0f);
        const glm::vec3 dir(gdm_direction(map.resolution, theta, phi));
        ASSERT_NEAR(lookup_gdm(map, {&point, 1}, {&dir, 1})[0], raw[i], lookup_error(2)) << "value " << i;
    }
}

TEST(LookupSdf, InterpolatesInThreeDimensions)
{
    Random random(7);
    const Map map = random_map(1, random);
    const std::vector<double> raw(map.sdf.begin(), map.sdf.end());
    const std::array<Axis, 3> axes{Axis{4, false}, {8, true}, {5, true}};
    std::vector<glm::vec3> points;
    for (int i = 0; i < 3000; ++i) {
        points.emplace_back(random.in_box({-2.0, -2.0, -0.2}, {3.0, 3.0, 1.2}));
    }
    const std::vector<float> found = lookup_sdf(map, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 p(points[i]);
        ASSERT_NEAR(found[i], interpolate<3>(raw, axes, {p.z * 3, p.y * 8, p.x * 5}), lookup_error(1)) << "point " << i;
    }
}

TEST(LookupSdf, BordersOfTheTile)
{
    Random random(8);
    const Map map = random_map(1, random);
    const float just_below = -0x1p-30f;  // its fractional part rounds to 1
    const std::vector<glm::vec3> points{{0, 0, 0},          {1, 1, 0},          {-1, 2, 0},
                                        {just_below, 0, 0}, {0, just_below, 0}, {0, 0, -1}};
    for (const float value : lookup_sdf(map, points)) {
        EXPECT_EQ(value, map.sdf[0]);
    }
    const std::vector<glm::vec3> top{{0, 0, 1}, {0, 0, 2}};
    for (const float value : lookup_sdf(map, top)) {
        EXPECT_EQ(value, map.sdf[3 * 8 * 5]);
    }
}

TEST(Lookup, ArgumentsThatCannotBeMeant)
{
    Random random(9);
    const Map map = random_map(1, random);
    const std::vector<glm::vec3> one{{0.1f, 0.2f, 0.3f}};
    const std::vector<glm::vec3> two(2, glm::vec3(0.0f, 0.0f, 1.0f));
    expect_refusal<InvalidArgument>([&] { lookup_gdm(map, one, two); }, {"1 positions", "2 directions"});
    Map without = map;
    without.sdf.clear();
    without.sdf_nodes = glm::ivec3(0);
    expect_refusal<InvalidArgument>([&] { lookup_sdf(without, one); }, {"no distance field"});
}

TEST(Lookup, NumbersThatAreNotFinite)
{
    Random random(10);
    const Map map = random_map(1, random);
    const std::vector<glm::vec3> good{{0.1f, 0.2f, 0.3f}};
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        for (int axis = 0; axis < 3; ++axis) {
            std::vector<glm::vec3> point = good;
            point[0][axis] = bad;
            expect_refusal<InvalidArgument>([&] { lookup_gdm(map, point, good); }, {"position 0", "finite"});
            expect_refusal<InvalidArgument>([&] { lookup_gdm(map, good, point); }, {"direction 0"});
            expect_refusal<InvalidArgument>([&] { lookup_sdf(map, point); }, {"position 0", "finite"});
        }
    }
    const std::vector<glm::vec3> nowhere{glm::vec3(0.0f)};
    expect_refusal<InvalidArgument>([&] { lookup_gdm(map, good, nowhere); }, {"direction 0"});
}

}  // namespace
}  // namespace mesoshell
