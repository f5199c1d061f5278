// What is open becomes the solid that the generalized winding number sees, or is left out where that encloses nothing.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "check.h"
#include "mesoshell/bake.h"
#include "meshes.h"
#include "tile_space.h"
#include "winding_oracle.h"

namespace mesoshell {
namespace {

constexpr float rounding = 1e-5f;

template <typename Kept>
Mesh kept_faces(Mesh mesh, const Kept& kept)
{
    std::vector<glm::uvec3> triangles;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::uvec3& t = mesh.triangles[i];
        if (kept(i, (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0f)) {
            triangles.push_back(t);
        }
    }
    mesh.triangles = std::move(triangles);
    return mesh;
}

// Outward faces of a box: two to a side, sides in the order -z, +z, -y, +y, -x, +x.
Mesh box(const glm::vec3& low, const glm::vec3& high)
{
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.positions.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

// Walls along an axis around a circle, or part of it, without ends.
Mesh tube(const glm::vec3& center, float radius, float length, int axis, double turn = 1.0)
{
    constexpr int around = 24;
    constexpr int along = 8;
    const bool closes = turn == 1.0;
    Mesh mesh;
    const int columns = closes ? around : around + 1;
    for (int j = 0; j <= along; ++j) {
        for (int i = 0; i < columns; ++i) {
            const double angle = std::numbers::pi * (1.0 + 2.0 * turn * i / around);
            glm::vec3 p = center;
            p[axis] += length * (static_cast<float>(j) / along - 0.5f);
            p[(axis + 1) % 3] += static_cast<float>(radius * std::cos(angle));
            p[(axis + 2) % 3] += static_cast<float>(radius * std::sin(angle));
            mesh.positions.push_back(p);
        }
    }
    for (int j = 0; j < along; ++j) {
        for (int i = 0; i < around; ++i) {
            const auto at = [&](int column, int row) {
                return static_cast<std::uint32_t>(row * columns + column % columns);
            };
            mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
            mesh.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
    return mesh;
}

// Every node whose number is clear agrees with the oracle, and both answers occur.
void expect_oracle(const Sample& sample, const Mesh& truth, int covering = 0, double unclear = 0.03)
{
    Job job;
    const glm::ivec3 nodes(13, 11, 9);
    const std::vector<std::uint8_t> inside = classify_inside(sample, nodes, job);
    int in = 0;
    int out = 0;
    for (std::size_t i = 0; i < inside.size(); ++i) {
        const std::size_t x = i % nodes.x;
        const std::size_t y = i / nodes.x % nodes.y;
        const std::size_t z = i / nodes.x / nodes.y;
        const glm::dvec3 p(double(x) / nodes.x, sample.aspect() * double(y) / nodes.y,
                           sample.height() * double(z) / (nodes.z - 1));
        const double sum = balanced_winding(truth.positions, truth.triangles, sample.aspect(), p, 2);
        const double winding = std::abs(sum + 0.5 * covering);
        if (std::abs(winding - 0.5) > unclear) {
            EXPECT_EQ(inside[i] != 0, winding > 0.5) << p.x << " " << p.y << " " << p.z << " winding " << winding;
            (winding > 0.5 ? in : out) += 1;
        }
    }
    EXPECT_GT(in, 0);
    EXPECT_GT(out, 0);
}

// The same distances, from every node and along every ray that does not graze an edge.
void expect_same_bake(const Sample& a, const Sample& b, float tolerance)
{
    Job job;
    const Sdf sdf_a = bake_sdf(a, {13, 12, 11}, job);
    const Sdf sdf_b = bake_sdf(b, {13, 12, 11}, job);
    for (std::size_t i = 0; i < sdf_a.values.size(); ++i) {
        ASSERT_NEAR(sdf_a.values[i], sdf_b.values[i], tolerance) << "node " << i;
    }
    GdmResolution resolution;
    resolution.nodes = glm::ivec3(11, 13, 7);
    resolution.ntheta = 6;
    resolution.nphi = 5;
    for (const Engine engine : {Engine::embree, Engine::slices}) {
        const Gdm gdm_a = bake_gdm(a, resolution, engine, job);
        const Gdm gdm_b = bake_gdm(b, resolution, engine, job);
        std::size_t differing = 0;
        for (std::size_t i = 0; i < gdm_a.values.size(); ++i) {
            differing += std::abs(gdm_a.values[i] - gdm_b.values[i]) > 10.0f * tolerance ? 1 : 0;
        }
        EXPECT_LE(differing, gdm_a.values.size() / 1000);
    }
}

bool has_notice(const Sample& sample, const std::string& words)
{
    return std::any_of(sample.notices().begin(), sample.notices().end(),
                       [&](const std::string& notice) { return notice.find(words) != std::string::npos; });
}

const Mesh ball = sphere({0.52f, 0.47f, 0.3f}, 0.23f, 16, 24);

TEST(Holes, BoxWithoutAFaceIsTheBox)
{
    const Mesh whole = box({0.21f, 0.23f, 0.13f}, {0.74f, 0.69f, 0.47f});
    for (std::size_t face = 0; face < 6; ++face) {
        const Mesh open = kept_faces(whole, [&](std::size_t i, const glm::vec3&) { return i / 2 != face; });
        const Sample sample = open.sample(0.6f, 0.9f);
        EXPECT_TRUE(has_notice(sample, "1 hole was closed.")) << face;
        expect_same_bake(sample, whole.sample(0.6f, 0.9f), rounding);
    }
}

TEST(Holes, DomeGetsAFlatFloor)
{
    // The floor of half a ball of 16 rings: a polygon of 24 sides.
    const Mesh dome = kept_faces(ball, [](std::size_t, const glm::vec3& middle) { return middle.z > 0.3f; });
    Mesh closed = dome;
    for (std::uint32_t i = 1; i + 1 < 24; ++i) {
        const std::uint32_t first = 1 + 7 * 24;
        closed.triangles.emplace_back(first, first + i + 1, first + i);
    }
    expect_same_bake(dome.sample(0.6f), closed.sample(0.6f), rounding);
}

TEST(Holes, ShallowDishIsALens)
{
    const Mesh dish = kept_faces(ball, [](std::size_t, const glm::vec3& middle) { return middle.z > 0.46f; });
    expect_oracle(dish.sample(0.6f), dish);
}

TEST(Holes, BallWithHoles)
{
    Random random(3);
    for (const double share : {0.05, 0.15, 0.3}) {
        const Mesh open = kept_faces(ball, [&](std::size_t, const glm::vec3&) { return random.uniform(0.0, 1.0) >= share; });
        const Sample sample = open.sample(0.6f, 0.9f);
        EXPECT_TRUE(has_notice(sample, "holes were closed."));
        expect_oracle(sample, open, 0, 0.1);
    }
}

TEST(Holes, BallWithAWideHole)
{
    const Mesh open = kept_faces(ball, [](std::size_t, const glm::vec3& m) { return m.x + 0.5f * m.z < 0.8f; });
    expect_oracle(open.sample(0.6f), open);
}

TEST(Holes, BoxWithoutTwoSidesThatMeet)
{
    // The rim is bent: no plane holds it.
    const Mesh whole = box({0.21f, 0.23f, 0.13f}, {0.74f, 0.69f, 0.47f});
    const Mesh open = kept_faces(whole, [](std::size_t i, const glm::vec3&) { return i / 2 != 1 && i / 2 != 5; });
    expect_oracle(open.sample(0.6f, 0.9f), open);
}

TEST(Holes, TubeOpenAtBothEnds)
{
    const Mesh open = tube({0.5f, 0.45f, 0.3f}, 0.13f, 0.7f, 0);
    const Sample sample = open.sample(0.6f, 0.9f);
    EXPECT_TRUE(has_notice(sample, "2 holes were closed."));
    expect_oracle(sample, open);
}

TEST(Holes, ShortTubeIsARing)
{
    // Flat caps would fill it; on its axis the number stays below one half, and nothing may stand there.
    for (const float length : {0.2f, 0.25f}) {
        const Mesh open = tube({0.5f, 0.45f, 0.3f}, 0.25f, length, 2);
        const Sample sample = open.sample(0.6f, 0.9f);
        expect_oracle(sample, open, 0, 0.02);
        Job job;
        const Sdf sdf = bake_sdf(sample, {8, 8, 9}, job);
        double inner = 0.0;  // radius of the ring
        while (balanced_winding(open.positions, open.triangles, 0.9f, {0.5 + inner, 0.45, 0.3}, 3) < 0.5) {
            inner += 0.001;
        }
        EXPECT_GT(inner, 0.1);
        EXPECT_NEAR(sdf.values[(4 * 8 + 4) * 8 + 4], inner, 0.02);  // at the center
    }
}

TEST(Holes, GutterGetsALid)
{
    // Half a tube along x, through every tile: its rims are open without end.
    const Mesh gutter = tube({0.5f, 0.45f, 0.4f}, 0.2f, 1.0f, 0, 0.5);
    const Sample sample = gutter.sample(0.6f, 0.9f);
    EXPECT_TRUE(has_notice(sample, "1 hole was closed."));
    Mesh closed = gutter;
    closed.triangles.insert(closed.triangles.end(), {{0, 8 * 25, 24}, {24, 8 * 25, 8 * 25 + 24}});
    expect_same_bake(sample, closed.sample(0.6f, 0.9f), rounding);
}

TEST(Holes, HoleAcrossTheBorders)
{
    const Mesh open = snapped(kept_faces(ball, [](std::size_t, const glm::vec3& m) { return m.z < 0.4f; }));
    const glm::vec3 to_corner(-0.5f, 0.5f, 0.0f);
    const Mesh at_corner = moved(open, to_corner);
    Mesh cut = at_corner;  // at the borders, each face in the tile of its middle
    for (glm::uvec3& t : cut.triangles) {
        const glm::vec3 middle = (at_corner.positions[t.x] + at_corner.positions[t.y] + at_corner.positions[t.z]) / 3.0f;
        const glm::vec3 home(std::floor(middle.x), std::floor(middle.y), 0.0f);
        const auto first = static_cast<std::uint32_t>(cut.positions.size());
        for (int i = 0; i < 3; ++i) {
            cut.positions.push_back(at_corner.positions[t[i]] - home);
        }
        t = {first, first + 1, first + 2};
    }
    EXPECT_TRUE(has_notice(cut.sample(0.6f), "1 hole was closed."));
    expect_oracle(cut.sample(0.6f), cut);
    expect_same_bake(cut.sample(0.6f), at_corner.sample(0.6f), 10.0f * rounding);
}

TEST(Holes, FlippedFacesAndHoles)
{
    Random random(5);
    const Mesh open = kept_faces(ball, [&](std::size_t, const glm::vec3&) { return random.uniform(0.0, 1.0) >= 0.1; });
    Mesh flipped = open;
    for (glm::uvec3& t : flipped.triangles) {
        if (random.below(2) == 0) {
            std::swap(t.y, t.z);
        }
    }
    expect_oracle(flipped.sample(0.6f, 0.9f), open, 0, 0.1);
}

TEST(Holes, TerrainWithHoles)
{
    // A roof over the tile: as far from solid above a hole as from empty below.
    Mesh roof = sawtooth(0.1f, 0.25f, 0.45f, 0.3f, 0.9f, 9, 8);
    roof.triangles.erase(roof.triangles.begin(), roof.triangles.begin() + 9 * 8 * 2);
    const Mesh open = kept_faces(roof, [](std::size_t i, const glm::vec3& m) {
        return glm::length(glm::vec2(m.x - 0.8f, m.y - 0.45f)) > 0.2f && i % 17 != 0;
    });
    expect_oracle(open.sample(0.6f, 0.9f), open, 1);
}

TEST(Holes, CracksAreClosed)
{
    // Every face has corners of its own, up to 0.0004 apart from its neighbors': by itself each of them encloses nothing.
    Random random(8);
    Mesh cracked;
    for (const glm::uvec3& t : ball.triangles) {
        const auto first = static_cast<std::uint32_t>(cracked.positions.size());
        for (int i = 0; i < 3; ++i) {
            cracked.positions.push_back(ball.positions[t[i]] + glm::vec3(random.direction() * 2e-4));
        }
        cracked.triangles.emplace_back(first, first + 1, first + 2);
    }
    const Sample sample = cracked.sample(0.6f);
    EXPECT_TRUE(has_notice(sample, "to close cracks."));
    EXPECT_FALSE(has_notice(sample, "hole"));
    EXPECT_EQ(sample.triangles().size(), ball.triangles.size());
    expect_oracle(sample, cracked, 0, 0.1);
}

TEST(Holes, TerrainThatDoesNotFitItsCopiesGetsWalls)
{
    // Heights of a patch over the tile, one value a corner: its left and right borders differ, and so do the others.
    constexpr int n = 6;
    Random random(4);
    double heights[n + 1][n + 1];
    Mesh mesh;
    for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i) {
            heights[j][i] = random.uniform(0.15, 0.45);
            mesh.positions.emplace_back(float(i) / n, 0.9f * float(j) / n, float(heights[j][i]));
        }
    }
    for (std::uint32_t j = 0; j < n; ++j) {
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i;
            mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, a + n + 2}, {a, a + n + 2, a + n + 1}});
        }
    }
    for (const Mesh& one : {mesh, flipped(mesh)}) {
        const Sample sample = one.sample(0.6f, 0.9f);
        EXPECT_TRUE(has_notice(sample, "does not fit its copies at 12 edges"));
        EXPECT_FALSE(has_notice(sample, "hole"));
        EXPECT_TRUE(sample.winds_outward());
        Job job;
        const glm::ivec3 nodes(7, 11, 13);
        const std::vector<std::uint8_t> inside = classify_inside(sample, nodes, job);
        for (std::size_t k = 0; k < inside.size(); ++k) {
            const double x = double(k % 7) / 7 * n;
            const double y = double(k / 7 % 11) / 11 * n;
            const double z = 0.6 * double(k / 77) / 12;
            if (k % 7 == 0 || k / 7 % 11 == 0) {
                continue;  // on a wall
            }
            const int i = static_cast<int>(x);
            const int j = static_cast<int>(y);
            const double u = x - i;
            const double v = y - j;
            const double diagonal = heights[j + 1][i + 1];
            const double surface = u > v ? heights[j][i] * (1 - u) + heights[j][i + 1] * (u - v) + diagonal * v
                                         : heights[j][i] * (1 - v) + heights[j + 1][i] * (v - u) + diagonal * u;
            if (std::abs(z - surface) > 1e-5) {
                ASSERT_EQ(inside[k] != 0, z < surface) << x << " " << y << " " << z;
            }
        }
    }
}

TEST(Holes, SheetBesideASolidIsLeftOut)
{
    Mesh sheet;
    sheet.positions = {{0.05f, 0.05f, 0.2f}, {0.25f, 0.05f, 0.2f}, {0.25f, 0.2f, 0.3f}, {0.05f, 0.2f, 0.3f}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    const Sample sample = merged(ball, sheet).sample(0.6f);
    EXPECT_TRUE(has_notice(sample, "2 faces enclose nothing and were left out; give a thickness"));
    EXPECT_FALSE(has_notice(sample, "closed"));
    EXPECT_EQ(sample.triangles(), ball.triangles);
    expect_refusal<InvalidArgument>([&] { sheet.sample(0.6f); }, {"open and encloses nothing", "thickness"});
}

TEST(Holes, FinOnASolidIsLeftOut)
{
    Mesh mesh = ball;
    mesh.positions.emplace_back(0.9f, 0.5f, 0.35f);
    mesh.triangles.emplace_back(50u, 51u, static_cast<std::uint32_t>(mesh.positions.size() - 1));
    const Sample sample = mesh.sample(0.6f);
    EXPECT_TRUE(has_notice(sample, "1 face encloses nothing and was left out"));
    EXPECT_EQ(sample.triangles(), ball.triangles);
}

TEST(Holes, ClosedMeshHasNone)
{
    const Sample sample = ball.sample(0.6f);
    EXPECT_TRUE(sample.notices().empty());
    EXPECT_EQ(sample.positions(), ball.positions);
    EXPECT_EQ(sample.triangles(), ball.triangles);
}

TEST(Holes, ManyThreadsAndOneGiveTheSame)
{
    const Mesh open = kept_faces(ball, [](std::size_t i, const glm::vec3& m) { return m.z < 0.4f && i % 7 != 0; });
    EXPECT_EQ(open.sample(0.6f).positions(), open.sample(0.6f).positions());
}

}  // namespace
}  // namespace mesoshell
