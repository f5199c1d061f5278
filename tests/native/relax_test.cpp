// Relaxed tops: stretch falls, step by step; nothing turns over; what is in order stays.
#include <algorithm>
#include <cmath>
#include <map>

#include "check.h"
#include "mesoshell/seams.h"
#include "mesoshell/stretch.h"
#include "prism_stretch.h"
#include "relax.h"
#include "shell_shapes.h"

namespace mesoshell {
namespace {

Shell relaxed(Shell shell, int steps)
{
    Job job;
    relax_top_uvs(shell, steps, job);
    return shell;
}

struct Case {
    const char* name;
    Shell shell;
    double least_gain;  // of what the total is above 1
};

std::vector<Case> cases()
{
    std::vector<Case> all;
    all.push_back({"torus", torus(1.0f, 0.4f, 48, 24, 9.0f, 6.0f).shell(0.3f), 0.03});
    all.push_back({"ball", ball_zone(32, 16).shell(0.5f), 0.2});
    all.push_back({"vase", vase(48, 32).shell(0.1f), 0.1});
    SurfaceMesh octahedron = round_octahedron(3);
    octahedron.normals = octahedron.positions;
    all.push_back({"octahedron", octahedron.shell(0.3f), 0.5});
    return all;
}

// UVs keep their area at a thousand heights: by sampling, not by the extreme of a quadratic.
bool nothing_turns_over(const Shell& shell)
{
    if (shell.top_uvs.empty()) {
        return true;
    }
    const std::vector<glm::vec2>& base = shell.topology->uvs;
    for (const glm::uvec3& t : shell.topology->uv_triangles) {
        const auto area = [&](double w) {
            const auto at = [&](int i) { return glm::mix(glm::dvec2(base[t[i]]), glm::dvec2(shell.top_uvs[t[i]]), w); };
            const glm::dvec2 e1 = at(1) - at(0);
            const glm::dvec2 e2 = at(2) - at(0);
            return e1.x * e2.y - e1.y * e2.x;
        };
        if (area(0.0) == 0.0) {
            continue;
        }
        for (int k = 1; k <= 100; ++k) {
            if (!(area(k / 100.0) * area(0.0) > 0.0)) {
                return false;
            }
        }
    }
    return true;
}

TEST(Relax, TotalFallsStepByStep)
{
    for (const Case& shape : cases()) {
        const double first = stretch(shape.shell).total;
        double before = first;
        for (const int steps : {1, 2, 3, 5, 8, 13, 21, 50}) {
            const Shell shell = relaxed(shape.shell, steps);
            const double after = stretch(shell).total;
            // Fewer steps are the beginning of more.
            EXPECT_LE(after, before * (1.0 + 1e-9)) << shape.name << " after " << steps;
            ASSERT_TRUE(nothing_turns_over(shell)) << shape.name << " after " << steps;
            before = after;
        }
        EXPECT_LT(before - 1.0, (first - 1.0) * (1.0 - shape.least_gain)) << shape.name;
    }
}

TEST(Relax, FineShellsNeedNoMoreSteps)
{
    double gains[2];
    for (const int fineness : {1, 3}) {
        const Shell shell = vase(48 * fineness, 32 * fineness).shell(0.1f);
        gains[fineness / 3] = stretch(shell).total - stretch(relaxed(shell, 8)).total;
    }
    EXPECT_NEAR(gains[1], gains[0], 0.05 * gains[0]);
}

TEST(Relax, EndsWhereNoMoveGains)
{
    // Waves of many lengths and directions, small and large, all over the top: none lowers the total of a relaxed torus,
    // whose UVs go on around it. Its own total cannot tell less than 1e-7.
    const Shell end = relaxed(torus(1.0f, 0.4f, 24, 16, 9.0f, 6.0f).shell(0.3f), 100);
    const double least = stretch(end).total;
    ASSERT_LT(least, stretch(torus(1.0f, 0.4f, 24, 16, 9.0f, 6.0f).shell(0.3f)).total);
    Random random(6);
    for (int trial = 0; trial < 200; ++trial) {
        const int around = random.below(5);
        const int along = random.below(5);
        const double phase = random.uniform(0.0, 6.3);
        const double size = std::pow(10.0, random.uniform(-4.0, -1.0));
        const glm::dvec2 way = glm::dvec2(random.direction()) * size;
        Shell other = end;
        for (std::size_t i = 0; i < other.top_uvs.size(); ++i) {
            const glm::dvec2 uv(other.topology->uvs[i]);
            other.top_uvs[i] += glm::vec2(way * std::sin(6.283185307 * (around * uv.x / 9 + along * uv.y / 6) + phase));
        }
        ASSERT_GT(stretch(other).total, least - 1e-7) << "trial " << trial;
    }
}

TEST(Relax, SlopesAreDerivatives)
{
    SurfaceMesh mesh = one_triangle();
    mesh.uvs = {{0.125f, 0.25f}, {0.5f, 0.5f}, {0.75f, 1.0f}};
    mesh.normals = {{0.5f, 0.2f, 1.0f}, {-0.4f, 0.3f, 1.0f}, {-0.2f, -0.5f, 1.0f}};
    const Shell shell = mesh.shell(0.4f);
    const std::array<glm::vec2, 3> top{glm::vec2(0.125f, 0.375f), {0.5625f, 0.5f}, {0.75f, 1.125f}};
    const double inverse_aspect_2 = 0.7;
    const double inverse_height_2 = 4.0;
    const auto sums = [&](int corner, int axis, float by) {
        std::array<glm::vec2, 3> moved = top;
        moved[static_cast<std::size_t>(corner)][axis] += by;
        PrismStretch prism(shell, 0);
        prism.set_top(moved);
        const StretchIntegrals found = prism.integrals();
        return std::pair(found.u + found.v * inverse_aspect_2 + found.w * inverse_height_2, found.tiles);
    };
    PrismStretch prism(shell, 0);
    prism.set_top(top);
    const StretchSlope slope = prism.slope(inverse_aspect_2, inverse_height_2);
    constexpr float step = 0x1p-10f;
    for (int corner = 0; corner < 3; ++corner) {
        for (int axis = 0; axis < 2; ++axis) {
            const auto [sum_after, tiles_after] = sums(corner, axis, step);
            const auto [sum_before, tiles_before] = sums(corner, axis, -step);
            const std::size_t i = static_cast<std::size_t>(corner);
            EXPECT_NEAR(slope.sum[i][axis], (sum_after - sum_before) / (2 * step), 1e-3 * sum_after);
            EXPECT_NEAR(slope.tiles[i][axis], (tiles_after - tiles_before) / (2 * step), 1e-5);
        }
    }
}

TEST(Relax, FlatSurfaceStays)
{
    SurfaceMesh mesh = flat_grid(6, 5, 2.0f, 1.0f);
    EXPECT_TRUE(relaxed(mesh.shell(0.3f), 20).top_uvs.empty());
    for (glm::vec2& uv : mesh.uvs) {
        uv = {uv.x * 7.0f, uv.y * 2.0f};  // the placement's business
    }
    EXPECT_TRUE(relaxed(mesh.shell(0.3f), 20).top_uvs.empty());
    EXPECT_TRUE(relaxed(mesh.shell(0.3f, 2), 20).top_uvs.empty());
}

TEST(Relax, PatternGoesOnWhereItDid)
{
    // The torus is unwrapped with whole tiles: its two seams stay none, entry by entry.
    const Shell before = torus(1.0f, 0.4f, 24, 16, 9.0f, 6.0f).shell(0.3f);
    const Shell after = relaxed(before, 20);
    ASSERT_EQ(after.top_uvs.size(), after.topology->uvs.size());
    EXPECT_TRUE(find_seams(after).edges.empty());
    std::map<std::uint32_t, glm::vec2> moves;
    for (std::size_t p = 0; p < after.prisms.size(); ++p) {
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t entry = after.topology->uv_triangles[p][i];
            const glm::vec2 move = after.top_uvs[entry] - after.topology->uvs[entry];
            const glm::vec2 same = moves.try_emplace(after.topology->triangles[p][i], move).first->second;
            ASSERT_LT(glm::length(move - same), 2e-6f);  // UVs of up to 9 tiles in single precision
        }
    }
    // Cut by half a tile, both sides move for themselves, and the cut stays one.
    const Shell cut = relaxed(torus(1.0f, 0.4f, 24, 16, 9.5f, 6.0f).shell(0.3f), 20);
    EXPECT_EQ(find_seams(cut).edges.size(), 16u);
}

TEST(Relax, MirroredMeshMovesMirrored)
{
    // Mirrored in z, with v turned to match, a quad lists its corners the other way round, so that it still faces outward;
    // from the same corner, so that its diagonal is the same.
    const SurfaceMesh mesh = torus(1.0f, 0.4f, 24, 16, 9.0f, 6.0f);
    SurfaceMesh mirrored = mesh;
    for (glm::vec3& p : mirrored.positions) {
        p.z = -p.z;
    }
    for (glm::vec3& n : mirrored.normals) {
        n.z = -n.z;
    }
    for (glm::vec2& uv : mirrored.uvs) {
        uv.y = -uv.y;
    }
    for (std::size_t i = 0; i < mirrored.corners.size(); i += 4) {
        std::swap(mirrored.corners[i + 1], mirrored.corners[i + 3]);
        std::swap(mirrored.uvs[i + 1], mirrored.uvs[i + 3]);
    }
    const Shell a = relaxed(mesh.shell(0.3f), 15);
    const Shell b = relaxed(mirrored.shell(0.3f), 15);
    EXPECT_NEAR(stretch(a).total, stretch(b).total, 1e-5);
    std::map<std::uint32_t, glm::vec2> moves;
    for (std::size_t p = 0; p < a.prisms.size(); ++p) {
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t entry = a.topology->uv_triangles[p][i];
            moves[a.topology->triangles[p][i]] = a.top_uvs[entry] - a.topology->uvs[entry];
        }
    }
    float most = 0.0f;
    for (std::size_t p = 0; p < b.prisms.size(); ++p) {
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t entry = b.topology->uv_triangles[p][i];
            const glm::vec2 move = b.top_uvs[entry] - b.topology->uvs[entry];
            const glm::vec2 other = moves[b.topology->triangles[p][i]];
            ASSERT_LT(glm::length(move - glm::vec2(other.x, -other.y)), 1e-3f);
            most = std::max(most, glm::length(move));
        }
    }
    EXPECT_GT(most, 0.02f);
}

TEST(Relax, PrismsWithoutTextureStay)
{
    SurfaceMesh mesh = vase(24, 16);
    for (std::size_t i = 0; i < 4; ++i) {
        mesh.uvs[i] = {0.1f, 0.1f};
    }
    const Shell before = mesh.shell(0.1f);
    const Shell after = relaxed(before, 20);
    EXPECT_EQ(stretch(after).infinite, stretch(before).infinite);
    EXPECT_LT(stretch(after).total, stretch(before).total);
    for (const std::uint32_t entry : {after.topology->uv_triangles[0].x, after.topology->uv_triangles[1].y}) {
        EXPECT_EQ(after.top_uvs[entry], after.topology->uvs[entry]);
    }
}

TEST(Relax, BuildRelaxesTheTable)
{
    const SurfaceMesh mesh = vase(24, 16);
    ShellOptions options;
    options.thickness = 0.1f;
    options.relax_steps = 10;
    RecycledVector<PrismTexels> prisms;
    for (const int threads : {1, 2, 3}) {
        Job job(threads);
        const Shell shell = build_shell(mesh.surface(), options, job);
        ASSERT_EQ(shell.top_uvs.size(), shell.topology->uvs.size());
        for (std::size_t p = 0; p < shell.prisms.size(); ++p) {
            const glm::uvec3& t = shell.topology->uv_triangles[p];
            for (int i = 0; i < 3; ++i) {
                ASSERT_EQ(shell.prisms[p][i + 3].w, shell.top_uvs[t[i]].x);
                ASSERT_EQ(shell.prisms[p][i].w, shell.topology->uvs[t[i]].x);
            }
        }
        if (prisms.empty()) {
            prisms = shell.prisms;
        }
        EXPECT_EQ(shell.prisms, prisms);
    }
}

}  // namespace
}  // namespace mesoshell
