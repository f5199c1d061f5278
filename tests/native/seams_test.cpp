// Where a pattern is cut.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "check.h"
#include "mesoshell/seams.h"
#include "meshes.h"

namespace mesoshell {
namespace {

// A cylinder about the z axis, open at both ends, unwrapped to `tiles` around.
SurfaceMesh cylinder(int around, float tiles)
{
    SurfaceMesh mesh = flat_grid(around, 2, tiles, 1.0f);
    for (std::int32_t& corner : mesh.corners) {
        const int column = corner % (around + 1);
        corner = corner / (around + 1) * around + column % around;
    }
    mesh.positions.clear();
    for (int j = 0; j <= 2; ++j) {
        for (int i = 0; i < around; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / around;
            mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.5 * j);
        }
    }
    return mesh;
}

std::size_t seams_of(const Shell& shell)
{
    const Seams seams = find_seams(shell);
    EXPECT_EQ(seams.tops.size(), seams.edges.size());
    return seams.edges.size();
}

TEST(Seams, CylinderOfWholeTilesHasNone)
{
    for (const float tiles : {1.0f, 3.0f, -2.0f, 100.0f}) {
        EXPECT_EQ(seams_of(cylinder(12, tiles).shell(0.1f)), 0u) << tiles;
        EXPECT_EQ(seams_of(cylinder(12, tiles).shell(0.1f, 1)), 0u) << tiles;
    }
    EXPECT_EQ(seams_of(torus(1.0f, 0.4f, 9, 7, 4.0f, 3.0f).shell(0.1f, 2)), 0u);
}

TEST(Seams, CylinderOfOtherTilesIsCutAlongItsLength)
{
    for (const float tiles : {1.5f, 3.01f, 2.998f}) {
        const Shell shell = cylinder(12, tiles).shell(0.1f);
        const Seams seams = find_seams(shell);
        ASSERT_EQ(seams.edges.size(), 2u) << tiles;
        for (std::size_t i = 0; i < 2; ++i) {
            for (int k = 0; k < 2; ++k) {
                EXPECT_EQ(seams.edges[i][k].y, 0.0f);  // where the unwrapping begins and ends
                EXPECT_EQ(seams.edges[i][k].x, 1.0f);
                EXPECT_LT(glm::length(seams.tops[i][k] - seams.edges[i][k] - glm::vec3(0.1f, 0.0f, 0.0f)), 1e-6f);
            }
        }
        EXPECT_EQ(seams_of(cylinder(12, tiles).shell(0.1f, 2)), 8u);
    }
    EXPECT_EQ(seams_of(cylinder(12, 2.9995f).shell(0.1f)), 0u);  // within the tolerance
}

TEST(Seams, PlacementDecides)
{
    ShellOptions options;
    const SurfaceMesh mesh = cylinder(12, 3.0f);
    options.placement.scale = {0.5f, 1.0f};
    EXPECT_EQ(seams_of(build_shell(mesh.surface(), options)), 2u);
    options.placement.scale = {2.0f, 0.3f};
    options.placement.offset = {0.3f, 0.4f};
    EXPECT_EQ(seams_of(build_shell(mesh.surface(), options)), 0u);
    options.placement.rotation = 0.5f * std::numbers::pi_v<float>;
    EXPECT_EQ(seams_of(build_shell(mesh.surface(), options)), 0u);
    options.placement.rotation = 0.1f;
    EXPECT_EQ(seams_of(build_shell(mesh.surface(), options)), 2u);
}

TEST(Seams, OnlyOneEndApart)
{
    SurfaceMesh mesh = flat_grid(2, 1, 2.0f, 1.0f);
    EXPECT_EQ(seams_of(mesh.shell(0.1f)), 0u);
    mesh.uvs[4] += glm::vec2(1.0f, 0.0f);  // the corner at (1, 0) of the right quad: whole tiles, but not so at (1, 1)
    EXPECT_EQ(seams_of(mesh.shell(0.1f)), 1u);
    mesh.uvs[7] += glm::vec2(1.0f, 0.0f);
    EXPECT_EQ(seams_of(mesh.shell(0.1f)), 0u);
}

TEST(Seams, MirroredIslandsCount)
{
    SurfaceMesh mesh = flat_grid(2, 1, 2.0f, 1.0f);
    for (std::size_t i = 4; i < 8; ++i) {
        mesh.uvs[i].x = 2.0f - mesh.uvs[i].x;  // folded over at u = 1, where both quads have the same UVs
    }
    EXPECT_EQ(seams_of(mesh.shell(0.1f)), 1u);
    for (std::size_t i = 4; i < 8; ++i) {
        mesh.uvs[i] = {mesh.uvs[i].x, 1.0f - mesh.uvs[i].y};  // turned by half a turn: it winds alike, but lies elsewhere
    }
    EXPECT_EQ(seams_of(mesh.shell(0.1f)), 1u);
}

TEST(Seams, FaceTurnedOverStillContinues)
{
    // Two triangles of one square, the second listed clockwise: its UVs wind the other way because its corners do.
    SurfaceMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.normals.assign(4, glm::vec3(0, 0, 1));
    mesh.face_sizes = {3, 3};
    mesh.corners = {0, 1, 2, 0, 3, 2};
    for (const std::int32_t corner : mesh.corners) {
        mesh.uvs.emplace_back(mesh.positions[static_cast<std::size_t>(corner)]);
    }
    EXPECT_EQ(seams_of(mesh.shell(0.1f)), 0u);
    mesh.uvs[4] = {1.0f, 0.0f};  // folded over at the diagonal
    EXPECT_EQ(seams_of(mesh.shell(0.1f)), 1u);
}

TEST(Seams, BordersDoNotCount)
{
    const SurfaceMesh mesh = cylinder(12, 1.5f);
    std::vector<std::uint8_t> covered(mesh.face_sizes.size(), 1);
    covered[0] = 0;  // one of the faces at the cut
    ShellOptions options;
    options.covered = covered;
    EXPECT_EQ(seams_of(build_shell(mesh.surface(), options)), 1u);
}

TEST(Seams, TopsThatPartCount)
{
    Shell shell = cylinder(12, 3.0f).shell(0.1f);
    shell.top_uvs = shell.topology->uvs;
    EXPECT_EQ(seams_of(shell), 0u);
    for (glm::vec2& uv : shell.top_uvs) {
        uv.y += uv.x > 2.99f ? 0.25f : 0.0f;
    }
    EXPECT_EQ(seams_of(shell), 2u);
}

TEST(Seams, EveryEdgeOfTwoPrismsIsSharedOnce)
{
    // On a closed surface of triangles 3 f / 2 edges; both sides name the same vertices.
    const Shell shell = torus(1.0f, 0.4f, 9, 7, 4.0f, 3.0f).shell(0.1f, 1);
    const std::vector<SharedEdge> edges = shared_edges(*shell.topology);
    EXPECT_EQ(edges.size(), 3 * shell.prisms.size() / 2);
    for (const SharedEdge& edge : edges) {
        ASSERT_NE(edge.prism, edge.other);
        for (int k = 0; k < 2; ++k) {
            ASSERT_EQ(shell.topology->triangles[edge.prism][edge.ends[k]],
                      shell.topology->triangles[edge.other][edge.other_ends[k]]);
        }
    }
}

}  // namespace
}  // namespace mesoshell
