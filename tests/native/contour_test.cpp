// The contour of a grid: closed modulo the periods, turned outward, and as large as closed forms say.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>

#include "check.h"
#include "mesoshell/bake.h"
#include "mesoshell/contour.h"

namespace mesoshell {
namespace {

constexpr double pi = std::numbers::pi;

struct Volume {
    glm::ivec3 nodes;
    float height;
    float aspect;
    std::vector<float> values;

    Contour contour(float threshold = 0.0f, int threads = 0) const
    {
        Job job(threads);
        return mesoshell::contour(values, nodes, threshold, height, aspect, job);
    }
    std::size_t index(int x, int y, int z) const { return (static_cast<std::size_t>(z) * nodes.y + y) * nodes.x + x; }
};

// A field of metric places, sampled at the nodes.
Volume sampled(const glm::ivec3& nodes, float height, float aspect, const std::function<double(glm::dvec3)>& field)
{
    Volume volume{nodes, height, aspect, {}};
    for (int z = 0; z < nodes.z; ++z) {
        for (int y = 0; y < nodes.y; ++y) {
            for (int x = 0; x < nodes.x; ++x) {
                const glm::dvec3 place(double(x) / nodes.x, aspect * double(y) / nodes.y, height * double(z) / (nodes.z - 1));
                volume.values.push_back(static_cast<float>(field(place)));
            }
        }
    }
    return volume;
}

// Radius minus distance to the nearest copy of a center.
std::function<double(glm::dvec3)> ball(const glm::dvec3& center, double radius, double aspect)
{
    return [=](glm::dvec3 p) {
        p -= center;
        p.x -= std::round(p.x);
        p.y -= aspect * std::round(p.y / aspect);
        return radius - glm::length(p);
    };
}

struct Measures {
    double area = 0.0;
    double volume = 0.0;  // by the flux of (0, 0, z), to which the open sides add nothing
};

Measures measured(const Contour& mesh)
{
    Measures sum;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a = mesh.positions[t.x];
        const glm::dvec3 b = mesh.positions[t.y];
        const glm::dvec3 c = mesh.positions[t.z];
        const glm::dvec3 normal = 0.5 * glm::cross(b - a, c - a);
        sum.area += glm::length(normal);
        sum.volume += normal.z * (a.z + b.z + c.z) / 3.0;
    }
    return sum;
}

// Every edge runs as often one way as the other, where places one period apart, and only those, are the same.
void expect_closed(const Contour& mesh, float aspect)
{
    using Place = std::array<float, 3>;
    std::map<Place, int> numbers;
    std::vector<int> number;
    std::vector<std::array<int, 2>> period;
    for (const glm::vec3& p : mesh.positions) {
        ASSERT_GE(p.x, 0.0f);
        ASSERT_LE(p.x, 1.0f);
        ASSERT_GE(p.y, 0.0f);
        ASSERT_LE(p.y, aspect);
        const std::array<int, 2> over{p.x == 1.0f, p.y == aspect};
        const Place place{over[0] ? 0.0f : p.x, over[1] ? 0.0f : p.y, p.z};
        number.push_back(numbers.emplace(place, static_cast<int>(numbers.size())).first->second);
        period.push_back(over);
    }
    std::map<std::array<int, 4>, int> balance;
    for (const glm::uvec3& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t a = t[i];
            const std::uint32_t b = t[(i + 1) % 3];
            const std::array<int, 4> there{number[a], number[b], period[b][0] - period[a][0], period[b][1] - period[a][1]};
            const std::array<int, 4> back{there[1], there[0], -there[2], -there[3]};
            if (there != back) {
                balance[std::min(there, back)] += there < back ? 1 : -1;
            }
        }
    }
    for (const auto& [edge, sum] : balance) {
        ASSERT_EQ(sum, 0);
    }
}

Volume noise(std::uint32_t seed, const glm::ivec3& nodes, int levels)
{
    Random random(seed);
    Volume volume{nodes, 0.7f, 0.6f, {}};
    for (int i = 0; i < nodes.x * nodes.y * nodes.z; ++i) {
        volume.values.push_back(levels > 0 ? static_cast<float>(random.below(levels)) : static_cast<float>(random.uniform(-1, 1)));
    }
    return volume;
}

TEST(Contour, BallAcrossABorderHasTheAreaAndVolumeOfASphere)
{
    constexpr double radius = 0.23;
    const double area = 4.0 * pi * radius * radius;
    const double volume = 4.0 / 3.0 * pi * radius * radius * radius;
    std::array<double, 2> area_error{};
    std::array<double, 2> volume_error{};
    for (int fine = 0; fine < 2; ++fine) {
        const int n = 24 << fine;
        const Volume grid = sampled({n, n * 3 / 4, n / 2}, 0.5f, 0.75f, ball({0.03, 0.7, 0.25}, radius, 0.75));
        const Measures got = measured(grid.contour());
        area_error[fine] = std::abs(got.area / area - 1.0);
        volume_error[fine] = std::abs(got.volume / volume - 1.0);
    }
    EXPECT_LT(area_error[1], 0.005);
    EXPECT_LT(volume_error[1], 0.005);
    // Linear interpolation: of second order.
    EXPECT_LT(area_error[1], 0.3 * area_error[0]);
    EXPECT_LT(volume_error[1], 0.3 * volume_error[0]);
}

double gyroid(const glm::dvec3& p)
{
    const glm::dvec3 q = 2.0 * pi * p;
    return std::sin(q.x) * std::cos(q.y) + std::sin(q.y) * std::cos(q.z) + std::sin(q.z) * std::cos(q.x);
}

// Area of the gyroid in the unit cube: a line along x meets it twice or not at all, an element of area seen along an axis
// shrinks by that component of its normal, whose squares add up to 1, and the three axes are alike.
double gyroid_area()
{
    constexpr int n = 800;
    double sum = 0.0;
    for (int j = 0; j < n; ++j) {
        for (int k = 0; k < n; ++k) {
            const double y = 2.0 * pi * (j + 0.5) / n;
            const double z = 2.0 * pi * (k + 0.5) / n;
            // cos(y) sin(x) + sin(z) cos(x) = -sin(y) cos(z)
            const double reach = std::hypot(std::cos(y), std::sin(z));
            const double level = -std::sin(y) * std::cos(z) / reach;
            if (std::abs(level) >= 1.0) {
                continue;
            }
            for (const double root : {std::asin(level), pi - std::asin(level)}) {
                const double x = root - std::atan2(std::sin(z), std::cos(y));
                const glm::dvec3 gradient(std::cos(x) * std::cos(y) - std::sin(z) * std::sin(x),
                                          std::cos(y) * std::cos(z) - std::sin(x) * std::sin(y),
                                          std::cos(z) * std::cos(x) - std::sin(y) * std::sin(z));
                sum += std::abs(gradient.x) / glm::length(gradient);
            }
        }
    }
    return 3.0 * sum / (double(n) * n);
}

TEST(Contour, GyroidHalvesTheCubeWithTheAreaOfAQuadrature)
{
    const int n = 48;
    const Volume grid = sampled({n, n, n + 1}, 1.0f, 1.0f, gyroid);
    const Contour mesh = grid.contour();
    expect_closed(mesh, 1.0f);
    const Measures got = measured(mesh);
    EXPECT_NEAR(got.volume, 0.5, 1e-4);
    // At an end, sin x cos y + sin y only changes its sign where x and y do: each cap is half the square.
    EXPECT_NEAR(got.area - 1.0, gyroid_area(), 0.005 * got.area);
}

TEST(Contour, ColumnIsCappedAtBothEnds)
{
    constexpr double radius = 0.3;
    const Volume grid = sampled({64, 40, 9}, 0.4f, 0.8f, [](const glm::dvec3& p) {
        return radius - std::hypot(p.x - 0.5, p.y - 0.4);
    });
    const Contour mesh = grid.contour();
    expect_closed(mesh, 0.8f);
    const Measures got = measured(mesh);
    EXPECT_NEAR(got.volume, 0.4 * pi * radius * radius, 0.002 * got.volume);
    EXPECT_NEAR(got.area, 2.0 * pi * radius * (0.4 + radius), 0.003 * got.area);
}

TEST(Contour, FloorIsTwoSheets)
{
    const Volume grid = sampled({5, 4, 6}, 0.5f, 0.7f, [](const glm::dvec3& p) { return 0.33 - p.z; });
    const Measures got = measured(grid.contour());
    EXPECT_NEAR(got.area, 2.0 * 0.7, 1e-6);
    EXPECT_NEAR(got.volume, 0.33 * 0.7, 1e-6);
}

TEST(Contour, NoiseIsClosed)
{
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        Random random(seed);
        const glm::ivec3 nodes(2 + random.below(6), 2 + random.below(6), 2 + random.below(6));
        const Volume grid = noise(seed, nodes, 0);
        const Contour mesh = grid.contour();
        expect_closed(mesh, grid.aspect);
        // An independent judge: the signed distance field of the mesh is negative just where the values were above.
        Job job;
        const Sdf sdf = bake_sdf(Sample(mesh.positions, mesh.triangles, grid.height, grid.aspect), nodes, job);
        for (int z = 1; z + 1 < nodes.z; ++z) {
            for (std::size_t i = grid.index(0, 0, z); i < grid.index(0, 0, z + 1); ++i) {
                if (std::abs(grid.values[i]) > 1e-3f) {
                    EXPECT_EQ(sdf.values[i] < 0.0f, grid.values[i] > 0.0f) << "seed " << seed << ", node " << i;
                }
            }
        }
    }
}

TEST(Contour, NoiseWithNodesOnTheThresholdIsClosed)
{
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        const Volume grid = noise(seed, {5, 6, 4}, 3);
        const Contour mesh = grid.contour(1.0f);
        expect_closed(mesh, grid.aspect);
        EXPECT_TRUE(Sample(mesh.positions, mesh.triangles, grid.height, grid.aspect).winds_outward());
    }
}

TEST(Contour, VerticesAreSharedAndEveryEdgeHasTwoTriangles)
{
    // A ball that meets neither border nor end: closed by its indices alone, of Euler characteristic 2.
    const Contour mesh = sampled({20, 18, 14}, 0.6f, 0.9f, ball({0.5, 0.45, 0.3}, 0.21, 0.9)).contour();
    std::map<std::array<std::uint32_t, 2>, int> directed;
    for (const glm::uvec3& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            ++directed[{t[i], t[(i + 1) % 3]}];
        }
    }
    for (const auto& [edge, count] : directed) {
        EXPECT_EQ(count, 1);
        EXPECT_TRUE(directed.contains({edge[1], edge[0]}));
    }
    EXPECT_EQ(mesh.positions.size() + mesh.triangles.size(), directed.size() / 2 + 2);
}

TEST(Contour, SameBitsWhateverTheNumberOfThreads)
{
    const Volume grid = noise(7, {31, 23, 17}, 0);
    const Contour one = grid.contour(0.2f, 1);
    for (const int threads : {2, 5}) {
        const Contour many = grid.contour(0.2f, threads);
        EXPECT_EQ(one.positions, many.positions);
        EXPECT_EQ(one.triangles, many.triangles);
    }
}

TEST(Contour, ValuesWhoseDifferenceOverflowsAreInterpolated)
{
    Volume grid = noise(3, {4, 4, 4}, 2);
    for (float& value : grid.values) {
        value = value > 0.5f ? 3e38f : -3e38f;
    }
    const Contour mesh = grid.contour();
    for (const glm::vec3& p : mesh.positions) {
        ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
    }
    expect_closed(mesh, grid.aspect);
}

TEST(ContourInput, IsRefusedInASentence)
{
    Volume grid = noise(5, {4, 3, 2}, 0);
    const auto refuse = [&](std::initializer_list<const char*> words, float threshold = 0.0f) {
        expect_refusal<InvalidArgument>([&] { grid.contour(threshold); }, words);
    };
    refuse({"no value is above the threshold 2", "choose one between"}, 2.0f);
    refuse({"every value is above the threshold -2", "choose one between"}, -2.0f);
    refuse({"threshold", "not finite"}, std::numeric_limits<float>::quiet_NaN());
    grid.values[grid.index(3, 1, 1)] = std::numeric_limits<float>::quiet_NaN();
    refuse({"z, y, x = 1, 1, 3", "not finite"});
    grid.values[grid.index(3, 1, 1)] = std::numeric_limits<float>::infinity();
    refuse({"z, y, x = 1, 1, 3", "not finite"});
    grid.values.pop_back();
    refuse({"23 values"});
    grid = noise(5, {4, 3, 1}, 0);
    refuse({"1 nodes along z"});
    grid = noise(5, {4, 3, 2}, 0);
    grid.height = 0.0f;
    refuse({"height"});
    grid.height = 1.0f;
    grid.aspect = -1.0f;
    refuse({"aspect"});
}

TEST(ContourInput, CancelledBeforeTheStart)
{
    const Volume grid = noise(1, {4, 4, 4}, 0);
    Job job;
    job.cancel();
    EXPECT_THROW(contour(grid.values, grid.nodes, 0.0f, 1.0f, 1.0f, job), Cancelled);
}

}  // namespace
}  // namespace mesoshell
