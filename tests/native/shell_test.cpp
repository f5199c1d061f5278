// The prism table, the hull that is rasterized, and what surfaces are refused.
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "check.h"
#include "meshes.h"

namespace mesoshell {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

SurfaceMesh one_triangle()
{
    SurfaceMesh mesh;
    mesh.positions = {{1, 0, 0}, {0, 2, 0}, {0, 0, 0}};
    mesh.face_sizes = {3};
    mesh.corners = {2, 0, 1};
    mesh.uvs = {{0.125f, 0.25f}, {0.5f, 0.625f}, {0.75f, 0.875f}};
    mesh.normals = {{0, 0, 2}, {0, 0, 1}, {0, 0, 0.5f}};
    return mesh;
}

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
    // Three right angles meet at a corner of a cube, however its quads are cut into triangles: the normal is the diagonal.
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
    mesh.positions[0] = {-1.0f, -1.0f, 0.0f};  // now the diagonal between the corners 1 and 3 of the face is the shorter
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
        // Coordinates are below 4; products of three of them in double.
        for (std::size_t k = 6; k < 24; k += 3) {
            const glm::dvec3 a = corner_of(prism, indices[k] % 6);
            const glm::dvec3 normal = glm::cross(corner_of(prism, indices[k + 1] % 6) - a, corner_of(prism, indices[k + 2] % 6) - a);
            const std::size_t fin = (k - 6) / 6;
            for (int sample = 0; sample < 64; ++sample) {
                const double along = random.uniform(0.0, 1.0);
                const double w = random.uniform(0.0, 1.0);
                const double q1 = fin == 0 ? along : fin == 1 ? 1.0 - along : 0.0;
                const double q2 = fin == 0 ? 0.0 : fin == 1 ? along : 1.0 - along;
                ASSERT_LE(glm::dot(normal, map_of(prism, {q1, q2, w}) - a), 1e-12) << "fin " << fin << " bulges out";
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

// --- Surfaces that cannot be meant ---

void expect_refused(const SurfaceMesh& mesh, std::initializer_list<const char*> words, int levels = 0)
{
    expect_refusal<InvalidArgument>([&] { mesh.shell(0.1f, levels); }, words);
}

TEST(ShellInput, NumbersThatAreNotFinite)
{
    for (const float bad : {nan, std::numeric_limits<float>::infinity()}) {
        SurfaceMesh mesh = flat_grid(2, 2, 1.0f, 1.0f);
        mesh.positions[4].y = bad;
        expect_refused(mesh, {"vertex 4", "not finite"});
        expect_refused(mesh, {"vertex 4", "not finite"}, 1);
        mesh = flat_grid(2, 2, 1.0f, 1.0f);
        mesh.uvs[7].x = bad;
        expect_refused(mesh, {"UV of corner 7", "not finite"});
        mesh = torus(1.0f, 0.4f, 4, 4, 1.0f, 1.0f);
        mesh.normals[2].z = bad;
        expect_refused(mesh, {"normal of vertex 2", "not finite"});
    }
}

TEST(ShellInput, IndexOutOfRange)
{
    for (const std::int32_t bad : {9, -1, std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()}) {
        SurfaceMesh mesh = flat_grid(2, 2, 1.0f, 1.0f);
        mesh.corners[5] = bad;
        expect_refused(mesh, {"corner 5", std::to_string(bad).c_str(), "9 vertices"});
    }
}

TEST(ShellInput, CountsThatDoNotFit)
{
    SurfaceMesh mesh = flat_grid(2, 2, 1.0f, 1.0f);
    mesh.face_sizes[1] = 3;
    expect_refused(mesh, {"15 corners", "16"});
    for (const std::int32_t bad : {2, 0, -4}) {
        mesh.face_sizes[1] = bad;
        expect_refused(mesh, {"face 1", "at least 3"});
    }
    mesh = torus(1.0f, 0.4f, 4, 4, 1.0f, 1.0f);
    mesh.normals.pop_back();
    expect_refused(mesh, {"15 normals", "16 vertices"});
}

TEST(ShellInput, NoFaces)
{
    SurfaceMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    expect_refused(mesh, {"no faces"});
    expect_refused(SurfaceMesh{}, {"no faces"}, 2);
}

TEST(ShellInput, NoUvs)
{
    SurfaceMesh mesh = flat_grid(2, 2, 1.0f, 1.0f);
    mesh.uvs.clear();
    expect_refused(mesh, {"0 UVs", "unwrap"});
    mesh.uvs.resize(15);
    expect_refused(mesh, {"15 UVs", "16 corners"});
}

TEST(ShellInput, ThicknessThatIsNotPositive)
{
    for (const float bad : {0.0f, -0.1f, nan, std::numeric_limits<float>::infinity()}) {
        expect_refusal<InvalidArgument>([&] { one_triangle().shell(bad); }, {"thickness", "positive"});
    }
}

TEST(ShellInput, LevelsOutOfRange)
{
    for (const int bad : {-1, 9, 1000}) {
        expect_refusal<InvalidArgument>([&] { cube().shell(0.1f, bad); }, {"levels", "0 to 8"});
    }
}

SurfaceMesh pentagon()
{
    SurfaceMesh mesh;
    for (int i = 0; i < 5; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 5;
        mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
        mesh.corners.push_back(i);
        mesh.uvs.emplace_back(mesh.positions.back());
    }
    mesh.face_sizes = {5};
    return mesh;
}

TEST(ShellInput, FaceOfFiveCorners)
{
    expect_refusal<Error>([] { pentagon().shell(0.1f); }, {"face 0", "5 corners", "levels"});
    EXPECT_EQ(pentagon().shell(0.1f, 1).prisms.size(), 10u);
}

TEST(ShellInput, LoopNeedsTriangles)
{
    expect_refusal<Error>([] { cube().shell(0.1f, 1, Scheme::loop); }, {"Loop", "triangles"});
    EXPECT_EQ(octahedron().shell(0.1f, 1, Scheme::loop).prisms.size(), 32u);
}

TEST(ShellInput, FacesOfZeroArea)
{
    SurfaceMesh mesh = one_triangle();
    mesh.normals.clear();
    mesh.face_sizes.push_back(3);
    mesh.corners.insert(mesh.corners.end(), {0, 0, 1});
    mesh.uvs.resize(6);
    EXPECT_EQ(mesh.shell(0.1f).prisms.size(), 1u);  // the other face is left
    mesh.positions[1] = mesh.positions[0];
    expect_refusal<Error>([&] { mesh.shell(0.1f); }, {"zero area"});
}

TEST(ShellInput, FoldedFacesHaveNoNormal)
{
    SurfaceMesh mesh = one_triangle();
    mesh.normals.clear();
    mesh.face_sizes.push_back(3);
    mesh.corners.insert(mesh.corners.end(), {2, 1, 0});
    mesh.uvs.resize(6);
    expect_refusal<Error>([&] { mesh.shell(0.1f); }, {"vertex", "no normal"});
}

TEST(ShellInput, GivenNormalOfZeroLength)
{
    SurfaceMesh mesh = one_triangle();
    mesh.normals[1] = glm::vec3(0.0f);
    expect_refusal<Error>([&] { mesh.shell(0.1f); }, {"vertex 1", "no normal"});
}

TEST(ShellInput, HugeCoordinatesGiveFinitePrismsOrAreRefused)
{
    SurfaceMesh mesh = flat_grid(2, 2, 1e25f, 1e25f);
    for (const int levels : {0, 1}) {
        try {
            for (const PrismTexels& prism : mesh.shell(0.1f, levels).prisms) {
                for (const glm::vec4& texel : prism) {
                    ASSERT_TRUE(std::isfinite(texel.x) && std::isfinite(texel.y) && std::isfinite(texel.z));
                }
            }
        } catch (const std::exception&) {
        }
    }
}

}  // namespace
}  // namespace mesoshell
