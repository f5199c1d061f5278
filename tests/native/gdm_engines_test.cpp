// The two engines of a GDM bake share no code past the directions: each is the other's judge, and a loop over all triangles is
// that of both.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "mesoshell/bake.h"
#include "meshes.h"

namespace mesoshell {
namespace {

Gdm bake(const Sample& sample, const GdmResolution& resolution, Engine engine, int threads = 0)
{
    Job job(threads);
    return bake_gdm(sample, resolution, engine, job);
}

GdmResolution grid(const glm::ivec3& nodes, int ntheta, int nphi)
{
    GdmResolution resolution;
    resolution.nodes = nodes;
    resolution.ntheta = ntheta;
    resolution.nphi = nphi;
    return resolution;
}

// Share of the values that differ by more than a tenth of a voxel: rays that graze a silhouette within rounding.
double share_apart(const Gdm& a, const Gdm& b)
{
    EXPECT_EQ(a.values.size(), b.values.size());
    EXPECT_EQ(a.ray_count, b.ray_count);
    const float tolerance = 0.1f / static_cast<float>(a.resolution.nodes.x);
    std::size_t apart = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        apart += std::abs(a.values[i] - b.values[i]) > tolerance ? 1 : 0;
    }
    return static_cast<double>(apart) / static_cast<double>(a.values.size());
}

void expect_engines_agree(const Sample& sample, const GdmResolution& resolution, double most_apart)
{
    const double apart = share_apart(bake(sample, resolution, Engine::embree), bake(sample, resolution, Engine::slices));
    std::printf("%zu triangles: %.5f %% of the rays apart\n", sample.triangles().size(), 100.0 * apart);
    EXPECT_LE(apart, most_apart);
}

// Spheres and boxes of all sizes, closed, overlapping, across every border.
Mesh random_solids(unsigned seed, int count, float aspect)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    Mesh mesh;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 center(3.0f * unit(random) - 1.0f, aspect * (3.0f * unit(random) - 1.0f), 0.6f * unit(random) - 0.05f);
        const int segments = 3 + static_cast<int>(20.0f * unit(random));
        mesh = merged(mesh, sphere(center, 0.02f + 0.2f * unit(random) * unit(random), 2 + segments / 2, segments));
    }
    return mesh;
}

TEST(GdmEngines, AgreeOnManySmallTriangles)
{
    expect_engines_agree(random_solids(1, 40, 1.0f).sample(0.5f), grid({32, 32, 16}, 8, 8), 1e-4);
}

TEST(GdmEngines, AgreeWithAnAspectAndOddNumbersOfNodes)
{
    expect_engines_agree(random_solids(2, 20, 0.7f).sample(0.45f, 0.7f), grid({27, 13, 19}, 6, 7), 1e-4);
}

TEST(GdmEngines, AgreeOnTrianglesLargerThanTheLatticeOfSmallOnes)
{
    expect_engines_agree(sphere({0.31f, 0.77f, 0.26f}, 0.23f, 3, 4).sample(0.5f), grid({64, 64, 9}, 10, 9), 1e-4);
    expect_engines_agree(sawtooth(0.11f, 0.17f, 0.41f, 0.23f, 1.0f, 1, 1).sample(0.5f), grid({48, 40, 11}, 8, 6), 1e-4);
}

TEST(GdmEngines, AgreeOnTrianglesOfSeveralPeriods)
{
    // Two sheets over one period, scaled up: every border is crossed many times.
    Mesh mesh = sphere({1.3f, 0.9f, 0.25f}, 1.9f, 5, 7);
    for (glm::vec3& p : mesh.positions) {
        p.z = 0.25f + 0.06f * (p.z - 0.25f);
    }
    expect_engines_agree(mesh.sample(0.5f), grid({20, 24, 12}, 8, 8), 1e-4);
}

TEST(GdmEngines, AgreeNearTheHorizon)
{
    // 64 polar nodes: the flattest is 1.4 degrees from the horizon. An odd number has one on it.
    const Sample sample = random_solids(3, 6, 1.0f).sample(0.5f);
    expect_engines_agree(sample, grid({16, 16, 8}, 64, 5), 3e-4);
    expect_engines_agree(sample, grid({16, 16, 8}, 7, 5), 1e-4);
}

TEST(GdmEngines, AgreeOnSolidsThatOverlapAndAreClipped)
{
    Mesh mesh = merged(sphere({0.4f, 0.4f, 0.0f}, 0.3f, 12, 17), sphere({0.6f, 0.5f, 0.45f}, 0.25f, 14, 15));
    expect_engines_agree(mesh.sample(0.5f), grid({32, 32, 16}, 8, 12), 1e-4);
}

// The first surface ahead by the formula of Moller and Trumbore in double precision, over all copies that a ray can reach.
double nearest_of_all(const Mesh& mesh, float aspect, const glm::dvec3& origin, const glm::dvec3& dir, double limit)
{
    const int reach = static_cast<int>(std::ceil(limit)) + 2;
    double nearest = limit;
    for (int j = -reach; j <= reach; ++j) {
        for (int i = -reach; i <= reach; ++i) {
            const glm::dvec3 from = origin - glm::dvec3(i, j * aspect, 0.0);
            for (const glm::uvec3& t : mesh.triangles) {
                const glm::dvec3 a(mesh.positions[t.x]);
                const glm::dvec3 ab = glm::dvec3(mesh.positions[t.y]) - a;
                const glm::dvec3 ac = glm::dvec3(mesh.positions[t.z]) - a;
                const glm::dvec3 p = glm::cross(dir, ac);
                const double determinant = glm::dot(ab, p);
                if (determinant == 0.0) {
                    continue;
                }
                const double u = glm::dot(from - a, p) / determinant;
                const glm::dvec3 q = glm::cross(from - a, ab);
                const double v = glm::dot(dir, q) / determinant;
                const double distance = glm::dot(ac, q) / determinant;
                if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance >= 0.0) {
                    nearest = std::min(nearest, distance);
                }
            }
        }
    }
    return nearest;
}

TEST(GdmEngines, AgreeWithALoopOverAllTriangles)
{
    for (const Engine engine : {Engine::embree, Engine::slices}) {
        std::mt19937 random(11);
        int checked = 0;
        int apart = 0;
        for (unsigned seed = 20; seed < 26; ++seed) {
            const float aspect = seed % 2 == 0 ? 1.0f : 1.3f;
            const Mesh mesh = random_solids(seed, 4, aspect);
            const GdmResolution r = grid({11, 9, 7}, 6, 8);
            const Sample sample = mesh.sample(0.5f, aspect);
            const Gdm gdm = bake(sample, r, engine);
            for (int ray = 0; ray < 400; ++ray) {
                const int x = static_cast<int>(random() % 11u);
                const int y = static_cast<int>(random() % 9u);
                const int z = static_cast<int>(random() % 7u);
                const int theta = static_cast<int>(random() % 6u);
                const int phi = static_cast<int>(random() % 8u);
                const double value = gdm.values[gdm.index(phi, y, x, theta, z)];
                const glm::dvec3 dir = gdm_direction(r, theta, phi);
                const glm::dvec3 origin(x / 11.0, aspect * y / 9.0, 0.5 * z / 6.0);
                const double limit = dir.z > 0.0 ? (0.5 - origin.z) / dir.z : -origin.z / dir.z;
                if (value == 0.0 || limit <= 0.0) {
                    continue;
                }
                ++checked;
                apart += std::abs(nearest_of_all(mesh, aspect, origin, dir, limit) - value) > 1e-4 ? 1 : 0;
            }
        }
        EXPECT_GT(checked, 1500);
        EXPECT_EQ(apart, 0) << "engine " << static_cast<int>(engine);
    }
}

TEST(GdmEngines, ThreadsChangeNoBit)
{
    const Sample sample = random_solids(5, 12, 1.0f).sample(0.5f);
    for (const Engine engine : {Engine::embree, Engine::slices}) {
        const Gdm one = bake(sample, grid({24, 20, 10}, 6, 8), engine, 1);
        EXPECT_EQ(one.values, bake(sample, grid({24, 20, 10}, 6, 8), engine, 2).values);
        EXPECT_EQ(one.values, bake(sample, grid({24, 20, 10}, 6, 8), engine, 7).values);
    }
}

TEST(GdmEngines, NoRayPassesBetweenTwoTriangles)
{
    // A closed sheet of long thin triangles all through the tile and across its borders: no ray from above reaches below it.
    Mesh mesh = slab(0.1f, 0.25f, 1.0f, 37, 3);
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    // The same offset for all vertices at one place modulo the periods keeps it closed.
    std::vector<float> offset(37 * 3);
    for (float& o : offset) {
        o = 0.04f * unit(random);
    }
    for (glm::vec3& p : mesh.positions) {
        const int i = static_cast<int>(std::lround(p.x * 37.0f)) % 37;
        const int j = static_cast<int>(std::lround(p.y * 3.0f)) % 3;
        p.z += offset[static_cast<std::size_t>(j * 37 + i)];
    }
    const GdmResolution r = grid({61, 67, 8}, 16, 16);
    const Gdm gdm = bake(mesh.sample(0.5f), r, Engine::slices);
    for (int phi = 0; phi < r.nphi; ++phi) {
        for (int theta = r.ntheta / 2; theta < r.ntheta; ++theta) {
            const float dir_z = static_cast<float>(gdm_direction(r, theta, phi).z);
            for (int y = 0; y < r.nodes.y; ++y) {
                for (int x = 0; x < r.nodes.x; ++x) {
                    const float distance = gdm.values[gdm.index(phi, y, x, theta, 7)];
                    ASSERT_GE(0.5f + distance * dir_z, 0.2f) << phi << " " << theta << " " << y << " " << x;
                }
            }
        }
    }
}

}  // namespace
}  // namespace mesoshell
