// The prism table and the hull that is rasterized.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "check.h"
#include "meshes.h"

namespace mesoshell {
namespace {

TEST(Shell, PrismTableLayout)
{
    const Shell shell = one_triangle().shell(0.5f);
    ASSERT_EQ(shell.prisms.size(), 1u);
    const PrismTexels expected{{{0, 0, 0, 0.125f},
                                {1, 0, 0, 0.5f},
                                {0, 2, 0, 0.75f},
                                {0, 0, 0.5f, 0.125f},
                                {1, 0, 0.5f, 0.5f},
                                {0, 2, 0.5f, 0.75f},
                                {0.25f, 0.625f, 0.875f, 0.25f},
                                {0.625f, 0.875f, 0, 0}}};
    EXPECT_EQ(shell.prisms[0], expected);
    EXPECT_EQ(shell.lower, glm::vec3(0, 0, 0));
    EXPECT_EQ(shell.upper, glm::vec3(1, 2, 0.5f));
}

TEST(Shell, LevelZeroKeepsVerticesAndGivenNormals)
{
    const SurfaceMesh mesh = torus(1.0f, 0.4f, 6, 5, 3.0f, 2.0f);
    const Shell shell = mesh.shell(0.25f);
    ASSERT_EQ(shell.prisms.size(), 2u * 6 * 5);
    for (const PrismTexels& prism : shell.prisms) {
        for (int i = 0; i < 3; ++i) {
            const glm::vec3 base(prism[i]);
            const auto found = std::find(mesh.positions.begin(), mesh.positions.end(), base);
            ASSERT_NE(found, mesh.positions.end());
            const glm::vec3 normal = mesh.normals[static_cast<std::size_t>(found - mesh.positions.begin())];
            EXPECT_LT(glm::length(glm::vec3(prism[i + 3]) - base - 0.25f * normal), 4 * 0x1p-23f);
        }
    }
}

TEST(Shell, AngleWeightedNormalsIgnoreTriangulation)
{
    // Three right angles meet at a corner of a cube, however its quads are cut into triangles: the normal is the
    // diagonal.
    SurfaceMesh mesh = cube();
    SurfaceMesh triangles = mesh;
    triangles.face_sizes.assign(12, 3);
    triangles.corners.clear();
    triangles.uvs.clear();
    for (std::size_t face = 0; face < 6; ++face) {
        for (const std::size_t i : {0u, 1u, 2u, 0u, 2u, 3u}) {
            triangles.corners.push_back(mesh.corners[4 * face + i]);
            triangles.uvs.push_back(mesh.uvs[4 * face + i]);
        }
    }
    for (const SurfaceMesh* surface : {&mesh, &triangles}) {
        for (const PrismTexels& prism : surface->shell(0.1f).prisms) {
            for (int i = 0; i < 3; ++i) {
                const glm::vec3 base(prism[i]);
                const glm::vec3 expected = base * (1.0f + 0.1f / std::sqrt(3.0f));
                EXPECT_LT(glm::length(glm::vec3(prism[i + 3]) - expected), 4 * 0x1p-23f);
            }
        }
    }
}

TEST(Shell, UvIslandsShareVerticesButNotUvs)
{
    SurfaceMesh mesh = flat_grid(2, 1, 2.0f, 1.0f);
    for (std::size_t i = 4; i < 8; ++i) {
        mesh.uvs[i] += glm::vec2(3.0f, -5.0f);  // the right quad is an island of its own
    }
    for (const int levels : {0, 1, 2}) {
        for (const PrismTexels& prism : mesh.shell(0.1f, levels).prisms) {
            const float middle = (prism[0].x + prism[1].x + prism[2].x) / 3.0f;
            const glm::vec2 offset = middle > 1.0f ? glm::vec2(3.0f, -5.0f) : glm::vec2(0.0f);
            for (int i = 0; i < 3; ++i) {
                const glm::vec2 uv(prism[i].w, prism[6][i]);
                EXPECT_LT(glm::length(uv - offset - glm::vec2(prism[i])), 8 * 0x1p-23f * 5.0f) << levels << " levels";
            }
        }
    }
}

TEST(Shell, ShorterDiagonalSplitsAQuad)
{
    SurfaceMesh mesh = flat_grid(1, 1, 1.0f, 1.0f);
    // Now the diagonal between the corners 1 and 3 of the face is the shorter.
    mesh.positions[0] = {-1.0f, -1.0f, 0.0f};
    const Shell shell = mesh.shell(0.1f);
    ASSERT_EQ(shell.prisms.size(), 2u);
    int with_far_corner = 0;
    for (const PrismTexels& prism : shell.prisms) {
        for (int i = 0; i < 3; ++i) {
            with_far_corner += glm::vec3(prism[i]) == mesh.positions[0] ? 1 : 0;
        }
    }
    EXPECT_EQ(with_far_corner, 1);
}

// --- The hull ---

glm::dvec3 corner_of(const PrismTexels& prism, std::uint32_t i)
{
    return glm::dvec3(prism[i]);
}

glm::dvec3 map_of(const PrismTexels& prism, const glm::dvec3& q)
{
    glm::dvec3 sum(0.0);
    const double weights[3] = {1.0 - q.x - q.y, q.x, q.y};
    for (std::uint32_t i = 0; i < 3; ++i) {
        sum += weights[i] * glm::mix(corner_of(prism, i), corner_of(prism, i + 3), q.z);
    }
    return sum;
}

// How often a closed mesh winds around a point: its solid angle over 4 pi (Van Oosterom and Strackee 1983).
double winding_number(const PrismTexels& prism, const PrismIndices& indices, const glm::dvec3& p)
{
    double angle = 0.0;
    for (std::size_t k = 0; k < 24; k += 3) {
        const glm::dvec3 a = corner_of(prism, indices[k] % 6) - p;
        const glm::dvec3 b = corner_of(prism, indices[k + 1] % 6) - p;
        const glm::dvec3 c = corner_of(prism, indices[k + 2] % 6) - p;
        const double la = glm::length(a);
        const double lb = glm::length(b);
        const double lc = glm::length(c);
        angle += 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)),
                                  la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
    }
    return angle / (4.0 * std::numbers::pi);
}

void check_hulls(const Shell& shell, Random& random)
{
    ASSERT_EQ(shell.indices.size(), shell.prisms.size());
    for (std::uint32_t p = 0; p < shell.prisms.size(); ++p) {
        const PrismTexels& prism = shell.prisms[p];
        const PrismIndices& indices = shell.indices[p];
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
        for (std::size_t k = 0; k < 24; ++k) {
            ASSERT_EQ(indices[k] / 6, p);
            edges[{indices[k], indices[k / 3 * 3 + (k + 1) % 3]}] += 1;
        }
        for (const auto& [edge, uses] : edges) {
            ASSERT_EQ(uses, 1);
            ASSERT_EQ(edges.count({edge.second, edge.first}), 1u);  // closed, and wound alike everywhere
        }
        // A fin that is as good as flat may have either diagonal: which, is decided in single precision, with errors of
        // some ulps of the product of three edges.
        for (std::size_t k = 6; k < 24; k += 3) {
            const glm::dvec3 a = corner_of(prism, indices[k] % 6);
            const glm::dvec3 normal =
                glm::cross(corner_of(prism, indices[k + 1] % 6) - a, corner_of(prism, indices[k + 2] % 6) - a);
            const std::size_t fin = (k - 6) / 6;
            const double rounding =
                16 * 0x1p-24 * glm::length(normal) * glm::length(corner_of(prism, indices[k + 1] % 6) - a);
            for (int sample = 0; sample < 64; ++sample) {
                const double along = random.uniform(0.0, 1.0);
                const double w = random.uniform(0.0, 1.0);
                const double q1 = fin == 0 ? along : fin == 1 ? 1.0 - along : 0.0;
                const double q2 = fin == 0 ? 0.0 : fin == 1 ? along : 1.0 - along;
                ASSERT_LE(glm::dot(normal, map_of(prism, {q1, q2, w}) - a), rounding) << "fin " << fin << " bulges out";
            }
        }
        for (int sample = 0; sample < 64; ++sample) {
            double q1 = random.uniform(0.01, 0.99);
            double q2 = random.uniform(0.01, 0.99);
            if (q1 + q2 > 0.99) {
                q1 = 1.0 - q1;
                q2 = 1.0 - q2;
            }
            if (q1 + q2 < 0.99) {
                const glm::dvec3 inside = map_of(prism, {q1, q2, random.uniform(0.01, 0.99)});
                ASSERT_NEAR(winding_number(prism, indices, inside), 1.0, 1e-6);
            }
        }
    }
}

TEST(ShellHull, HoldsThePrismsOfATorus)
{
    Random random(1);
    check_hulls(torus(1.0f, 0.4f, 9, 7, 1.0f, 1.0f).shell(0.15f), random);
    check_hulls(torus(1.0f, 0.4f, 4, 4, 1.0f, 1.0f).shell(0.2f, 1), random);
}

TEST(ShellHull, HoldsTwistedPrisms)
{
    Random random(2);
    for (int i = 0; i < 300; ++i) {
        SurfaceMesh mesh = one_triangle();
        for (glm::vec3& normal : mesh.normals) {
            normal = glm::vec3(random.in_box({-0.5, -0.5, 0.8}, {0.5, 0.5, 1.0}));
        }
        check_hulls(mesh.shell(static_cast<float>(random.uniform(0.05, 0.5))), random);
    }
}

}  // namespace
}  // namespace mesoshell
