// Adaptive refinement: without cracks, no finer than asked but for the cap, and the same for every number of threads.
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "check.h"
#include "edge_measure.h"
#include "surface_builders.h"

namespace mesoshell {
namespace {

std::vector<SurfaceMesh> closed_meshes()
{
    return {cube(), octahedron(), cone(7), torus(1.0f, 0.4f, 6, 5, 2.0f, 1.0f), round_octahedron(1)};
}

TEST(AdaptiveSurface, EveryEdgeIsUsedOnceEachWay)
{
    for (const SurfaceMesh& mesh : closed_meshes()) {
        for (const float length : {3.0f, 0.5f, 0.17f}) {
            // A length that varies over the surface makes neighbors of different rates.
            SurfaceMesh bent = mesh;
            bent.positions[0] *= 3.0f;
            const RefinedSurface surface = refined(bent.surface(), to_length(length));
            std::set<std::int32_t> used(surface.corners.begin(), surface.corners.end());
            EXPECT_EQ(used.size(), surface.positions.size());  // no point of an edge is passed by: no T-junctions
            for (const auto& [edge, count] : directed_edges(surface)) {
                ASSERT_EQ(count, 1);
                ASSERT_TRUE(directed_edges(surface).contains({edge.second, edge.first}));
                if (surface.positions.size() > 200) {
                    break;  // the look-up above is slow; the sum below covers all
                }
            }
            const auto edges = directed_edges(surface);
            for (const auto& [edge, count] : edges) {
                ASSERT_EQ(count, 1);
                ASSERT_TRUE(edges.contains({edge.second, edge.first}));
            }
        }
    }
}

// Points of the refined surface on an edge of the mesh: with a tile a face, those whose UV is on its border, in order.
std::vector<std::vector<glm::vec3>> edges_of_quads(const RefinedSurface& surface, int faces)
{
    std::vector<std::map<float, glm::vec3>> bottoms(static_cast<std::size_t>(faces));
    std::size_t first = 0;
    for (std::size_t face = 0; face < surface.face_sizes.size(); ++face) {
        for (std::int32_t i = 0; i < surface.face_sizes[face]; ++i, ++first) {
            const glm::vec2 uv = surface.uvs[surface.uv_corners[first]];
            if (uv.y == 0.0f) {
                bottoms[surface.faces[face]][uv.x] = surface.positions[surface.corners[first]];
            }
        }
    }
    std::vector<std::vector<glm::vec3>> lines;
    for (const auto& bottom : bottoms) {
        lines.emplace_back();
        for (const auto& [u, position] : bottom) {
            lines.back().push_back(position);
        }
    }
    return lines;
}

TEST(AdaptiveSurface, PartsOfEdgesAreAsLongAsAskedOrAtTheCap)
{
    SurfaceMesh mesh = cube();
    mesh.positions[7] *= 4.0f;
    for (const float length : {1.5f, 0.4f, 0.1f, 0.03f}) {
        for (const int levels : {0, 3}) {
            const int cap = 1 << (levels > 0 ? levels : 6);
            const auto lines = edges_of_quads(refined(mesh.surface(), to_length(length, levels)), 6);
            for (const std::vector<glm::vec3>& line : lines) {
                const int parts = static_cast<int>(line.size()) - 1;
                ASSERT_GE(parts, 1);
                ASSERT_LE(parts, cap);
                float longest = 0.0f;
                float whole = 0.0f;
                for (std::size_t i = 1; i < line.size(); ++i) {
                    longest = std::max(longest, glm::distance(line[i - 1], line[i]));
                    whole += glm::distance(line[i - 1], line[i]);
                }
                EXPECT_TRUE(longest <= length * 1.0001f || parts == cap) << longest << " of " << parts << " parts";
                // And not many more than needed: the parts of an edge differ in length, here at most by a factor 4.
                EXPECT_LE(parts, std::max(1.0f, 4.0f * std::ceil(whole / length)));
            }
        }
    }
}

TEST(AdaptiveSurface, ScreenAsksForMoreWhereTheCameraIsNear)
{
    // A camera at the origin that looks along -z, 90 degrees wide: clip = (x, y, ., -z), 100 pixels a unit at distance 1.
    Refinement refinement;
    refinement.edge_pixels = 10.0f;
    refinement.screen = {200, 200};
    refinement.clip_from_object = glm::dmat4(0.0);
    refinement.clip_from_object[0][0] = refinement.clip_from_object[1][1] = 1.0;
    refinement.clip_from_object[2][2] = refinement.clip_from_object[2][3] = -1.0;
    const EdgeMeasure measure(refinement);
    EXPECT_NEAR(measure({0, 0, -1}, {0.5f, 0, -1}), 5.0f, 1e-4f);
    EXPECT_NEAR(measure({0, 0, -10}, {0.5f, 0, -10}), 0.5f, 1e-5f);
    EXPECT_EQ(measure({0, 0, 1}, {0.5f, 0, 1}), 0.0f);     // behind
    EXPECT_EQ(measure({5, 0, -1}, {5.5f, 0, -1}), 0.0f);   // beside
    // Through the camera's plane: what is in front, up to twice the screen's half width.
    const float through = measure({1, 0, -1}, {1, 0, 1});
    EXPECT_NEAR(through, 10.0f, 1e-3f);
    EXPECT_EQ(through, measure({1, 0, 1}, {1, 0, -1}));
}

TEST(AdaptiveSurface, ThreadsDoNotMatter)
{
    const SurfaceMesh mesh = torus(1.0f, 0.4f, 11, 7, 2.0f, 1.0f);
    const Shell one = shell_of(mesh.surface(), to_length(0.1f), 1);
    const Shell two = shell_of(mesh.surface(), to_length(0.1f), 2);
    EXPECT_EQ(one.prisms, two.prisms);
    EXPECT_EQ(one.indices, two.indices);
}

TEST(AdaptiveSurface, IslandsShareUvsAcrossTheirOwnEdgesOnly)
{
    // A torus has one seam each way: unrolled, its UVs are a grid with one more row and column of points than its vertices
    // have.
    const RefinedSurface surface = refined(torus(1.0f, 0.4f, 6, 5, 1.0f, 1.0f).surface(), to_length(100.0f));
    EXPECT_EQ(surface.positions.size(), 30u);
    EXPECT_EQ(surface.uvs.size(), 42u);
    const RefinedSurface cut = refined(cube().surface(), to_length(100.0f));
    EXPECT_EQ(cut.positions.size(), 8u);
    std::set<std::int32_t> uvs(cut.uv_corners.begin(), cut.uv_corners.end());
    EXPECT_EQ(uvs.size(), cut.uvs.size());
}

TEST(AdaptiveSurface, MoreThanMayBeIsRefused)
{
    const SurfaceMesh mesh = flat_grid(40, 40, 1.0f, 1.0f);
    expect_refusal<InvalidArgument>([&] { shell_of(mesh.surface(), to_length(1e-5f, 8)); },
                                    {"4194304 prisms", "longer edges"});
}

TEST(AdaptiveSurface, LengthsThatAreNone)
{
    for (const float bad : {-1.0f, std::nanf(""), INFINITY}) {
        expect_refusal<InvalidArgument>([&] { shell_of(cube().surface(), to_length(bad)); }, {"edge_length", "positive"});
    }
    Refinement refinement;
    refinement.edge_pixels = 4.0f;
    expect_refusal<InvalidArgument>([&] { shell_of(cube().surface(), refinement); }, {"screen", "width and height"});
}

}  // namespace
}  // namespace mesoshell
