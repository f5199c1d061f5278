// Subdivision surfaces against closed forms of their limits, which hold at every level.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "check.h"
#include "meshes.h"

namespace mesoshell {
namespace {

// Weighted sums of coordinates of about 1, a dozen a level.
constexpr float rounding = 16 * 0x1p-23f;

struct Vertex {
    glm::vec3 base;
    glm::vec3 normal;
    glm::vec2 uv;
};

std::vector<Vertex> vertices_of(const Shell& shell, float thickness)
{
    std::vector<Vertex> vertices;
    for (const PrismTexels& prism : shell.prisms) {
        for (int i = 0; i < 3; ++i) {
            const glm::vec3 base(prism[i]);
            vertices.push_back({base, (glm::vec3(prism[i + 3]) - base) / thickness, {prism[i].w, prism[6][i]}});
        }
    }
    return vertices;
}

// The vertex that lies in a direction, seen from the middle of a closed surface.
Vertex toward(const std::vector<Vertex>& vertices, const glm::vec3& dir)
{
    return *std::max_element(vertices.begin(), vertices.end(), [&](const Vertex& a, const Vertex& b) {
        return glm::dot(glm::normalize(a.base), dir) < glm::dot(glm::normalize(b.base), dir);
    });
}

TEST(LimitSurface, FlatGridStaysFlatWithExactUvsAndNormals)
{
    const SurfaceMesh mesh = flat_grid(3, 2, 3.0f, 2.0f);
    for (const Scheme scheme : {Scheme::catmark, Scheme::bilinear}) {
        for (const int levels : {0, 1, 2, 3}) {
            const Shell shell = mesh.shell(0.5f, levels, scheme);
            const int split = 1 << levels;
            ASSERT_EQ(shell.prisms.size(), 2u * 6u * static_cast<std::size_t>(split * split));
            for (const Vertex& v : vertices_of(shell, 0.5f)) {
                EXPECT_EQ(v.base.z, 0.0f);
                EXPECT_LT(glm::length(v.normal - glm::vec3(0, 0, 1)), rounding);
                // Regular subdivision reproduces linear functions: vertices lie on the finer grid, and UVs are (x, y).
                EXPECT_LT(glm::length(v.base * float(split) - glm::round(v.base * float(split))),
                          rounding * float(split));
                EXPECT_LT(glm::length(v.uv - glm::vec2(v.base)), 3.0f * rounding);
            }
            EXPECT_LT(glm::length(shell.lower - glm::vec3(0.0f)), rounding);
            EXPECT_LT(glm::length(shell.upper - glm::vec3(3.0f, 2.0f, 0.5f)), 3.0f * rounding);
        }
    }
}

TEST(LimitSurface, FlatTrianglesStayFlatUnderLoop)
{
    SurfaceMesh mesh = flat_grid(2, 2, 2.0f, 2.0f);
    SurfaceMesh triangles;
    triangles.positions = mesh.positions;
    triangles.face_sizes.assign(8, 3);
    for (std::size_t face = 0; face < 4; ++face) {
        for (const std::size_t i : {0u, 1u, 2u, 0u, 2u, 3u}) {
            triangles.corners.push_back(mesh.corners[4 * face + i]);
            triangles.uvs.push_back(mesh.uvs[4 * face + i]);
        }
    }
    for (const Vertex& v : vertices_of(triangles.shell(0.5f, 2, Scheme::loop), 0.5f)) {
        EXPECT_EQ(v.base.z, 0.0f);
        EXPECT_LT(glm::length(v.normal - glm::vec3(0, 0, 1)), rounding);
    }
}

TEST(LimitSurface, CornerOfACubeUnderCatmullClark)
{
    // Halstead, Kass and DeRose 1993: a vertex V of valence n among quads goes to (n^2 V + 4 E + F) / (n (n + 5)), E
    // the sum of its neighbors along edges, F of those across faces. At (1, 1, 1) n is 3, E = (1, 1, 1), F = (-1, -1,
    // -1).
    const float limit = (9.0f + 4.0f - 1.0f) / 24.0f;
    for (const int levels : {1, 2, 3, 4}) {
        const std::vector<Vertex> vertices = vertices_of(cube().shell(0.25f, levels), 0.25f);
        for (const glm::vec3 corner : {glm::vec3(1, 1, 1), {-1, 1, 1}, {1, -1, -1}, {-1, -1, -1}}) {
            const Vertex v = toward(vertices, corner);
            EXPECT_LT(glm::length(v.base - limit * corner), rounding) << levels << " levels";
            EXPECT_LT(glm::length(v.normal - corner / std::sqrt(3.0f)), 4 * rounding) << levels << " levels";
        }
    }
}

TEST(LimitSurface, MiddleOfACubesFaceUnderCatmullClark)
{
    // After one level the face point is a vertex of valence 4. In units of the cube: V = 1; E: the four edge points,
    // (1 + 1 + 1 + 0) / 4 = 3/4 each; F: the four moved corners, 5/9 each. So (16 + 4 * 4 * 3/4 + 4 * 5/9) / 36.
    const float limit = (16.0f + 12.0f + 20.0f / 9.0f) / 36.0f;
    for (const int levels : {1, 2, 3}) {
        const std::vector<Vertex> vertices = vertices_of(cube().shell(0.25f, levels), 0.25f);
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 dir(0.0f);
            dir[axis] = -1.0f;
            const Vertex v = toward(vertices, dir);
            EXPECT_LT(glm::length(v.base - limit * dir), rounding) << levels << " levels";
            EXPECT_LT(glm::length(v.normal - dir), 4 * rounding) << levels << " levels";
            EXPECT_LT(glm::length(v.uv - glm::vec2(0.5f)), rounding) << levels << " levels";
        }
    }
}

TEST(LimitSurface, TipOfAnOctahedronUnderLoop)
{
    // Loop 1987: V goes to (1 - n c) V + c times the sum of its n neighbors, c = 1 / (3 / (8 b) + n),
    // b = (5/8 - (3/8 + cos(2 pi / n) / 4)^2) / n. At a tip n is 4 and the neighbors cancel.
    const double b = (0.625 - 0.375 * 0.375) / 4.0;
    const float limit = static_cast<float>(1.0 - 4.0 / (3.0 / (8.0 * b) + 4.0));
    for (const int levels : {1, 2, 3}) {
        const std::vector<Vertex> vertices = vertices_of(octahedron().shell(0.25f, levels, Scheme::loop), 0.25f);
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 dir(0.0f);
            dir[axis] = 1.0f;
            const Vertex v = toward(vertices, dir);
            EXPECT_LT(glm::length(v.base - limit * dir), rounding) << levels << " levels";
            EXPECT_LT(glm::length(v.normal - dir), 4 * rounding) << levels << " levels";
        }
    }
}

TEST(LimitSurface, LimitsDoNotDependOnTheLevel)
{
    const SurfaceMesh mesh = torus(1.0f, 0.5f, 5, 4, 1.0f, 1.0f);
    const std::vector<Vertex> coarse = vertices_of(mesh.shell(0.1f, 1), 0.1f);
    const std::vector<Vertex> fine = vertices_of(mesh.shell(0.1f, 2), 0.1f);
    for (const Vertex& v : coarse) {
        const auto found = std::min_element(fine.begin(), fine.end(), [&](const Vertex& a, const Vertex& b) {
            return glm::length(a.base - v.base) < glm::length(b.base - v.base);
        });
        EXPECT_LT(glm::length(found->base - v.base), 2 * rounding);
        EXPECT_LT(glm::length(found->normal - v.normal), 16 * rounding);  // divided by the thickness
    }
}

TEST(LimitSurface, BilinearSchemeReproducesABilinearPatch)
{
    SurfaceMesh mesh = flat_grid(1, 1, 1.0f, 1.0f);
    mesh.positions[3].z = 1.0f;  // the corner (1, 1): z = x y
    for (const int levels : {1, 2, 3}) {
        const Shell shell = mesh.shell(0.25f, levels, Scheme::bilinear);
        for (const Vertex& v : vertices_of(shell, 0.25f)) {
            EXPECT_NEAR(v.base.z, v.base.x * v.base.y, rounding);
            EXPECT_LT(glm::length(v.uv - glm::vec2(v.base)), rounding);
            const float steps = static_cast<float>(1 << levels);
            EXPECT_NEAR(v.base.x * steps, std::round(v.base.x * steps), rounding * steps);
        }
    }
}

TEST(LimitSurface, ClosedSurfaceHasOutwardNormals)
{
    for (const Scheme scheme : {Scheme::catmark, Scheme::bilinear}) {
        for (const Vertex& v : vertices_of(cube().shell(0.1f, 2, scheme), 0.1f)) {
            EXPECT_NEAR(glm::length(v.normal), 1.0f, 10 * rounding);
            EXPECT_GT(glm::dot(v.normal, v.base), 0.0f);
        }
    }
}

}  // namespace
}  // namespace mesoshell
