// Creases, corners, boundaries and UV rules: closed forms, and one rule by means of another.
#include <algorithm>
#include <cmath>

#include "check.h"
#include "surface_builders.h"

namespace mesoshell {
namespace {

constexpr float rounding = 16 * 0x1p-23f;

float distance_to_cube(const glm::vec3& p)
{
    const glm::vec3 a = glm::abs(p);
    return std::abs(std::max({a.x, a.y, a.z}) - 1.0f);
}

TEST(LimitCrease, ACubeOfInfinitelySharpEdgesStaysACube)
{
    CreasedMesh mesh = cube();
    mesh.crease_all(10.0f);
    for (const Refinement& refinement : {to_level(1), to_level(3), to_length(0.3f)}) {
        const RefinedSurface surface = refined(mesh.surface(), refinement);
        bool has_corner = false;
        for (std::size_t i = 0; i < surface.positions.size(); ++i) {
            const glm::vec3 p = surface.positions[i];
            ASSERT_LT(distance_to_cube(p), rounding);
            // Sharp edges are cubic B-splines between corners that three sharp edges hold: straight. The normal there is
            // even.
            const glm::vec3 on = glm::vec3(glm::greaterThan(glm::abs(p), glm::vec3(1.0f - rounding)));
            const glm::vec3 expected = glm::normalize(glm::sign(p) * on);
            EXPECT_LT(glm::length(surface.normals[i] - expected), 64 * rounding) << p.x << " " << p.y << " " << p.z;
            has_corner = has_corner || on == glm::vec3(1.0f);
        }
        EXPECT_TRUE(has_corner);
    }
}

TEST(LimitCrease, AClosedLoopOfSharpEdgesIsItsOwnSpline)
{
    // The four edges around a cube's top, infinitely sharp: a closed uniform cubic B-spline, so that a vertex goes to
    // (1 + 4 + 1) / 6 of itself and its neighbors in the loop, whatever else is attached.
    CreasedMesh mesh = cube();
    const int top[] = {4, 5, 7, 6};
    for (int i = 0; i < 4; ++i) {
        mesh.crease(top[i], top[(i + 1) % 4], 10.0f);
    }
    const glm::vec3 expected(2.0f / 3.0f, 2.0f / 3.0f, 1.0f);
    for (const Refinement& refinement : {to_level(1), to_level(2), to_length(0.3f)}) {
        const RefinedSurface surface = refined(mesh.surface(), refinement);
        const bool found = std::any_of(surface.positions.begin(), surface.positions.end(),
                                       [&](const glm::vec3& p) { return glm::length(p - expected) < rounding; });
        EXPECT_TRUE(found);
    }
}

TEST(LimitCrease, ASharpCornerStaysWhereItIs)
{
    CreasedMesh mesh = cube();
    mesh.corner(7, 10.0f);
    for (const Refinement& refinement : {to_level(1), to_level(3), to_length(0.3f)}) {
        const RefinedSurface surface = refined(mesh.surface(), refinement);
        const auto found = std::find_if(surface.positions.begin(), surface.positions.end(),
                                        [](const glm::vec3& p) { return glm::length(p - glm::vec3(1.0f)) < rounding; });
        ASSERT_NE(found, surface.positions.end());
        const glm::vec3 normal = surface.normals[static_cast<std::size_t>(found - surface.positions.begin())];
        EXPECT_LT(glm::length(normal - glm::vec3(1.0f / std::sqrt(3.0f))), 64 * rounding);
    }
}

TEST(LimitCrease, SharpnessZeroAndLooseEdgesChangeNothing)
{
    CreasedMesh mesh = cube();
    mesh.positions.emplace_back(5.0f, 0.0f, 0.0f);  // a loose edge from here
    const RefinedSurface plain = refined(mesh.surface(), to_level(2));
    mesh.crease_all(0.0f);
    mesh.crease(0, 8, 10.0f);
    mesh.crease(0, 7, 10.0f);  // through the cube
    const RefinedSurface creased = refined(mesh.surface(), to_level(2));
    EXPECT_EQ(plain.positions, creased.positions);
    EXPECT_EQ(plain.normals, creased.normals);
}

TEST(LimitCrease, TheLastOfSeveralSharpnessesCountsWhateverTheDirection)
{
    CreasedMesh once = cube();
    once.crease(0, 2, 3.0f);
    CreasedMesh twice = cube();
    twice.crease(2, 0, 10.0f);
    twice.crease(0, 2, 3.0f);
    EXPECT_EQ(refined(once.surface(), to_level(2)).positions, refined(twice.surface(), to_level(2)).positions);
    CreasedMesh sharper = cube();
    sharper.crease(0, 2, 50.0f);
    CreasedMesh sharp = cube();
    sharp.crease(0, 2, 10.0f);
    EXPECT_EQ(refined(sharp.surface(), to_level(2)).positions, refined(sharper.surface(), to_level(2)).positions);
}

TEST(LimitCrease, SharpnessThatIsRefused)
{
    const auto expect = [](const CreasedMesh& mesh, std::initializer_list<const char*> words) {
        expect_refusal<InvalidArgument>([&] { shell_of(mesh.surface(), to_level(1)); }, words);
    };
    CreasedMesh mesh = cube();
    mesh.crease(0, 8, 1.0f);
    expect(mesh, {"creased edge 0", "vertex 8", "8 vertices"});
    mesh = cube();
    mesh.crease(0, -1, 1.0f);
    expect(mesh, {"creased edge 0", "vertex -1"});
    mesh = cube();
    mesh.crease(3, 3, 1.0f);
    expect(mesh, {"creased edge 0", "both ends"});
    for (const float bad : {-1.0f, std::nanf(""), INFINITY}) {
        mesh = cube();
        mesh.crease(0, 1, bad);
        expect(mesh, {"sharpness", "creased edge 0", "0 (smooth) to 10 (sharp)"});
        mesh = cube();
        mesh.corner(1, bad);
        expect(mesh, {"sharpness", "sharp corner 0"});
    }
    mesh = cube();
    mesh.corner(8, 1.0f);
    expect(mesh, {"sharp corner 0", "vertex 8"});
    mesh = cube();
    mesh.crease_sharpness.push_back(1.0f);
    expect(mesh, {"1 sharpnesses", "0 creased edges"});
    mesh = cube();
    mesh.corner_sharpness.push_back(1.0f);
    expect(mesh, {"1 sharpnesses", "0 sharp corners"});
}

TEST(LimitBoundary, CornersOfOneFaceAreKeptOrRounded)
{
    // A boundary is a cubic B-spline: a rounded corner goes to (1 + 4 + 1) / 6 of itself and its two neighbors.
    const SurfaceMesh mesh = flat_grid(3, 3, 3.0f, 3.0f);
    for (const bool adaptive : {false, true}) {
        for (const Boundary boundary : {Boundary::edges_and_corners, Boundary::edges}) {
            Refinement refinement = adaptive ? to_length(0.4f) : to_level(2);
            refinement.boundary = boundary;
            const RefinedSurface surface = refined(mesh.surface(), refinement);
            float least = 10.0f;
            for (const glm::vec3& p : surface.positions) {
                least = std::min(least, p.x + p.y);
            }
            EXPECT_NEAR(least, boundary == Boundary::edges ? 2.0f / 6.0f : 0.0f, rounding);
        }
    }
}

// A sheet of quads whose UVs are one island, bent so that every rule shows.
SurfaceMesh bent_sheet()
{
    SurfaceMesh mesh = flat_grid(3, 3, 3.0f, 3.0f);
    for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
        const glm::vec3 p = mesh.positions[mesh.corners[i]];
        mesh.uvs[i] = {p.x + 0.3f * std::sin(2.0f * p.y), p.y + 0.2f * std::cos(3.0f * p.x)};
    }
    return mesh;
}

// The sheet with its UVs as positions.
CreasedMesh unrolled(const SurfaceMesh& mesh)
{
    CreasedMesh flat = mesh;
    for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
        flat.positions[mesh.corners[i]] = glm::vec3(mesh.uvs[i], 0.0f);
    }
    return flat;
}

void expect_uvs(const SurfaceMesh& mesh, UvRule rule, const CreasedMesh& expected, Boundary boundary,
                Scheme scheme = Scheme::catmark)
{
    for (const bool adaptive : {false, true}) {
        // at the cap everywhere: the same places in both
        Refinement refinement = adaptive ? to_length(0.01f, 2) : to_level(2);
        refinement.uv_rule = rule;
        refinement.boundary = boundary;  // corners that positions keep are kept in UVs too
        const RefinedSurface surface = refined(mesh.surface(), refinement);
        refinement.scheme = scheme;
        if (adaptive) {
            refinement.edge_length = 1e-5f;
        }
        const RefinedSurface truth = refined(expected.surface(), refinement);
        ASSERT_EQ(surface.corners, truth.corners);
        for (std::size_t i = 0; i < surface.corners.size(); ++i) {
            const glm::vec2 uv = surface.uvs[surface.uv_corners[i]];
            ASSERT_LT(glm::length(uv - glm::vec2(truth.positions[truth.corners[i]])), 4 * rounding)
                << (adaptive ? "adaptive" : "uniform") << ", rule " << static_cast<int>(rule);
        }
    }
}

TEST(UvRules, OneIslandFollowsTheRulesOfPositions)
{
    const SurfaceMesh mesh = bent_sheet();
    expect_uvs(mesh, UvRule::smooth, unrolled(mesh), Boundary::edges);
    expect_uvs(mesh, UvRule::corners, unrolled(mesh), Boundary::edges_and_corners);
    expect_uvs(mesh, UvRule::corners_and_junctions, unrolled(mesh), Boundary::edges_and_corners);
    expect_uvs(mesh, UvRule::corners_junctions_and_concave, unrolled(mesh), Boundary::edges_and_corners);
    // Linear boundaries are those whose vertices are all sharp corners.
    CreasedMesh sharp = unrolled(mesh);
    for (std::int32_t i = 0; i < 16; ++i) {
        if (i % 4 == 0 || i % 4 == 3 || i < 4 || i >= 12) {
            sharp.corner(i, 10.0f);
        }
    }
    expect_uvs(mesh, UvRule::boundaries, sharp, Boundary::edges_and_corners);
    expect_uvs(mesh, UvRule::linear, unrolled(mesh), Boundary::edges_and_corners, Scheme::bilinear);
}

// Whether the UV of the middle vertex of a 2 x 2 grid stays where it is in the island of face 3.
bool keeps_middle(std::initializer_list<int> islands, UvRule rule)
{
    SurfaceMesh mesh = flat_grid(2, 2, 2.0f, 2.0f);
    const std::vector<int> island(islands);
    for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
        mesh.uvs[i] += glm::vec2(10.0f * static_cast<float>(island[i / 4]), 0.0f);
        if (mesh.corners[i] == 4) {
            mesh.uvs[i] += glm::vec2(0.3f, 0.2f);
        }
    }
    Refinement refinement = to_level(1);
    refinement.uv_rule = rule;
    const RefinedSurface surface = refined(mesh.surface(), refinement);
    const glm::vec2 middle(1.3f + 10.0f * static_cast<float>(island[3]), 1.2f);
    return std::any_of(surface.uvs.begin(), surface.uvs.end(),
                       [&](const glm::vec2& uv) { return glm::length(uv - middle) < 1e-5f; });
}

TEST(UvRules, JunctionsAndConcaveCornersOfIslands)
{
    // Three islands that meet, seen from the one of two faces.
    EXPECT_FALSE(keeps_middle({0, 1, 2, 2}, UvRule::corners));
    EXPECT_TRUE(keeps_middle({0, 1, 2, 2}, UvRule::corners_and_junctions));
    EXPECT_TRUE(keeps_middle({0, 1, 2, 2}, UvRule::boundaries));
    // An island of one face in another, seen from the other.
    EXPECT_FALSE(keeps_middle({0, 1, 1, 1}, UvRule::corners));
    EXPECT_FALSE(keeps_middle({0, 1, 1, 1}, UvRule::corners_and_junctions));
    EXPECT_TRUE(keeps_middle({0, 1, 1, 1}, UvRule::corners_junctions_and_concave));
    EXPECT_TRUE(keeps_middle({0, 1, 1, 1}, UvRule::boundaries));
    // No rule but the linear one keeps what is inside an island.
    EXPECT_FALSE(keeps_middle({0, 0, 0, 0}, UvRule::boundaries));
    EXPECT_TRUE(keeps_middle({0, 0, 0, 0}, UvRule::linear));
}

}  // namespace
}  // namespace mesoshell
