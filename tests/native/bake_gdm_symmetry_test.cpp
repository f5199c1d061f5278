// What must not change a baked GDM, or change it in a known way: whole periods, whole nodes, the winding, the threads.
//
// Vertices, nodes and periods are multiples of 2^-12 here, so moving them is exact, and so are differences of a vertex
// and a ray's origin; only the order in which triangles are met may differ. One ulp of a distance below 16 is 2^-20.
#include <algorithm>
#include <cmath>

#include "check.h"
#include "mesoshell/bake.h"
#include "meshes.h"

namespace mesoshell {
namespace {

constexpr float ulp = 0x1p-20f;

GdmResolution small_grid()
{
    GdmResolution r;
    r.nodes = glm::ivec3(8, 4, 5);
    r.ntheta = 6;
    r.nphi = 7;
    return r;
}

Gdm bake(const Mesh& mesh, float aspect = 0.5f, int threads = 0)
{
    Job job(threads);
    return bake_gdm(mesh.sample(0.625f, aspect), small_grid(), job);
}

// Off the nodes, so that no ray starts on the surface.
Mesh odd_ball()
{
    return snapped(sphere({0.37f, 0.19f, 0.33f}, 0.21f, 12, 16));
}

void expect_same(const Gdm& a, const Gdm& b)
{
    ASSERT_EQ(a.values.size(), b.values.size());
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        ASSERT_NEAR(a.values[i], b.values[i], ulp) << "value " << i;
    }
}

TEST(GdmSymmetry, MovedByNodesRollsTheArray)
{
    const Gdm still = bake(odd_ball());
    const glm::ivec3 n = small_grid().nodes;
    for (const glm::ivec2 nodes : {glm::ivec2(1, 0), {0, 1}, {3, 2}, {-5, 7}}) {
        const Gdm rolled =
            bake(moved(odd_ball(), {static_cast<float>(nodes.x) / 8.0f, static_cast<float>(nodes.y) / 8.0f, 0.0f}));
        for (int phi = 0; phi < 7; ++phi) {
            for (int y = 0; y < n.y; ++y) {
                for (int x = 0; x < n.x; ++x) {
                    const int from_x = ((x - nodes.x) % n.x + n.x) % n.x;
                    const int from_y = ((y - nodes.y) % n.y + n.y) % n.y;
                    for (int i = 0; i < 6 * n.z; ++i) {
                        ASSERT_NEAR(rolled.values[rolled.index(phi, y, x, 0, 0) + i],
                                    still.values[still.index(phi, from_y, from_x, 0, 0) + i], ulp);
                    }
                }
            }
        }
    }
}

TEST(GdmSymmetry, MovedByPeriodsIsTheSame)
{
    const Gdm still = bake(odd_ball());
    expect_same(bake(moved(odd_ball(), {1.0f, -0.5f, 0.0f})), still);
    expect_same(bake(moved(odd_ball(), {-7.0f, 4.0f, 0.0f})), still);
}

TEST(GdmSymmetry, BorderCrossingObjectEqualsItsWrappedTwin)
{
    const Mesh whole = snapped(sphere({0.02f, 0.49f, 0.33f}, 0.21f, 12, 16));
    Mesh wrapped = {};
    for (const glm::uvec3& t : whole.triangles) {
        // As a modeler would cut it: every triangle where its first corner lies in the unit tile.
        const glm::vec3 first = whole.positions[t.x];
        const glm::vec3 offset(-std::floor(first.x), -0.5f * std::floor(first.y / 0.5f), 0.0f);
        const auto index = static_cast<std::uint32_t>(wrapped.positions.size());
        for (int i = 0; i < 3; ++i) {
            wrapped.positions.push_back(whole.positions[t[i]] + offset);
        }
        wrapped.triangles.emplace_back(index, index + 1, index + 2);
    }
    expect_same(bake(wrapped), bake(whole));
}

TEST(GdmSymmetry, FlippedWindingChangesNothing)
{
    expect_same(bake(flipped(odd_ball())), bake(odd_ball()));
}

TEST(GdmSymmetry, OneFlippedTriangleChangesNothing)
{
    for (const std::size_t i : {std::size_t(0), std::size_t(100), odd_ball().triangles.size() - 1}) {
        Mesh mesh = odd_ball();
        std::swap(mesh.triangles[i].y, mesh.triangles[i].z);
        expect_same(bake(mesh), bake(odd_ball()));
    }
}

TEST(GdmSymmetry, HalfFlippedChangesNothing)
{
    Mesh mesh = odd_ball();
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 2) {
        std::swap(mesh.triangles[i].y, mesh.triangles[i].z);
    }
    expect_same(bake(mesh), bake(odd_ball()));
}

TEST(GdmSymmetry, OverlappingSolidsAreOneSolid)
{
    const Mesh a = snapped(sphere({0.45f, 0.3f, 0.33f}, 0.21f, 12, 16));
    const Mesh b = snapped(sphere({0.59f, 0.25f, 0.29f}, 0.19f, 12, 16));
    const Gdm both = bake(merged(a, b), 1.0f);
    const Gdm only_a = bake(a, 1.0f);
    const Gdm only_b = bake(b, 1.0f);
    // The first hit of a union is the first of both hits.
    int in_both = 0;
    for (std::size_t i = 0; i < both.values.size(); ++i) {
        ASSERT_NEAR(both.values[i], std::min(only_a.values[i], only_b.values[i]), ulp);
        const bool between_planes = i % 5 != 0 && i % 5 != 4;
        in_both += between_planes && only_a.values[i] == 0.0f && only_b.values[i] == 0.0f ? 1 : 0;
    }
    EXPECT_GT(in_both, 0);  // parity would call what lies in both outside
}

TEST(GdmSymmetry, ThreadsChangeNothing)
{
    const Gdm one = bake(odd_ball(), 0.5f, 1);
    const Gdm two = bake(odd_ball(), 0.5f, 2);
    EXPECT_EQ(one.values, two.values);
    EXPECT_EQ(one.ray_count, two.ray_count);
}

TEST(GdmSymmetry, ScaledTileScalesDistances)
{
    // Half the tile, tiled twice each way, is the same field at half the length wherever a ray has not been cut.
    Mesh four;
    for (const glm::vec3 offset : {glm::vec3(0.0f), {0.5f, 0.0f, 0.0f}, {0.0f, 0.5f, 0.0f}, {0.5f, 0.5f, 0.0f}}) {
        Mesh part = odd_ball();
        for (glm::vec3& p : part.positions) {
            p = 0.5f * p + offset;
        }
        four = merged(four, part);
    }
    GdmResolution fine = small_grid();
    fine.nodes = glm::ivec3(16, 16, 5);
    GdmResolution coarse = small_grid();
    coarse.nodes = glm::ivec3(8, 8, 5);
    Job job;
    const Gdm small = bake_gdm(four.sample(0.3125f, 1.0f), fine, job);
    const Gdm large = bake_gdm(odd_ball().sample(0.625f, 1.0f), coarse, job);
    for (int phi = 0; phi < 7; ++phi) {
        for (int y = 0; y < 16; ++y) {
            for (int x = 0; x < 16; ++x) {
                for (int i = 0; i < 6 * 5; ++i) {
                    ASSERT_NEAR(2.0f * small.values[small.index(phi, y, x, 0, 0) + i],
                                large.values[large.index(phi, y % 8, x % 8, 0, 0) + i], 2.0f * ulp);
                }
            }
        }
    }
}

}  // namespace
}  // namespace mesoshell
