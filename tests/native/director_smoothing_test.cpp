// Smoothed directors: what they leave alone, what they make smoother, and that none turns behind a face.
#include <algorithm>
#include <cmath>
#include <map>

#include "check.h"
#include "meshes.h"

namespace mesoshell {
namespace {

Shell smoothed(const SurfaceMesh& mesh, int steps, int levels = 0)
{
    ShellOptions options;
    options.director_smoothing = steps;
    options.refinement.levels = levels;
    return build_shell(mesh.surface(), options);
}

// Mean square of the difference of directors over the edges of prisms.
double roughness(const Shell& shell)
{
    double sum = 0.0;
    for (const glm::uvec3& t : shell.topology->triangles) {
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 d(shell.directors[t[i]] - shell.directors[t[(i + 1) % 3]]);
            sum += glm::dot(d, d);
        }
    }
    return sum / static_cast<double>(3 * shell.topology->triangles.size());
}

// The plane z = -|x| over [-2, 2] x [0, 2]: a sharp ridge along y.
SurfaceMesh ridge()
{
    SurfaceMesh mesh = flat_grid(8, 4, 4.0f, 2.0f);
    for (glm::vec3& p : mesh.positions) {
        p.x -= 2.0f;
        p.z = -2.0f * std::abs(p.x);
    }
    return mesh;
}

TEST(DirectorSmoothing, SphereStays)
{
    // The mean over neighbors is the director itself up to the square of an edge.
    double worst[2];
    for (const int levels : {3, 4}) {
        SurfaceMesh mesh = round_octahedron(levels);
        mesh.normals = mesh.positions;
        const Shell shell = smoothed(mesh, 10);
        double most = 0.0;
        for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
            most = std::max(most, static_cast<double>(glm::length(shell.directors[v] - mesh.positions[v])));
        }
        worst[levels - 3] = most;
    }
    EXPECT_LT(worst[0], 0.02);
    EXPECT_LT(worst[1], 0.5 * worst[0]);
}

TEST(DirectorSmoothing, FlatSurfaceStaysBitForBit)
{
    const SurfaceMesh mesh = flat_grid(5, 4, 1.0f, 1.0f);
    EXPECT_EQ(smoothed(mesh, 7).directors, smoothed(mesh, 0).directors);
}

TEST(DirectorSmoothing, RidgeBecomesSmootherStepByStep)
{
    double before = roughness(smoothed(ridge(), 0));
    for (int steps = 5; steps <= 30; steps += 5) {
        const Shell shell = smoothed(ridge(), steps);
        const double after = roughness(shell);
        EXPECT_LT(after, before) << steps << " steps";
        before = after;
        for (const glm::vec3& director : shell.directors) {
            ASSERT_NEAR(glm::length(director), 1.0f, 4 * 0x1p-23f);
        }
    }
    // A jump that spreads over sigma edges, sigma^2 growing by 1/12 a step on faces this long, has 0.56 / sigma of its
    // roughness.
    EXPECT_LT(before, 0.5 * roughness(smoothed(ridge(), 0)));
}

TEST(DirectorSmoothing, MirroredMeshHasMirroredDirectors)
{
    // A ridge with a lopsided bump is mirrored in x; corners are listed the other way round then, and quads split elsewhere.
    SurfaceMesh mesh = ridge();
    Random random(4);
    for (glm::vec3& p : mesh.positions) {
        p += glm::vec3(random.in_box({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}));
    }
    SurfaceMesh mirrored = mesh;
    for (glm::vec3& p : mirrored.positions) {
        p.x = -p.x;
    }
    std::reverse(mirrored.corners.begin(), mirrored.corners.end());
    std::reverse(mirrored.uvs.begin(), mirrored.uvs.end());
    const Shell a = smoothed(mesh, 8);
    const Shell b = smoothed(mirrored, 8);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const glm::vec3 expected(-a.directors[v].x, a.directors[v].y, a.directors[v].z);
        ASSERT_LT(glm::length(b.directors[v] - expected), 1e-6f);
    }
}

TEST(DirectorSmoothing, NoDirectorTurnsBehindAFace)
{
    // Spikes: a grid whose heights are random and steep.
    SurfaceMesh mesh = flat_grid(12, 12, 1.0f, 1.0f);
    Random random(5);
    for (glm::vec3& p : mesh.positions) {
        p.z = static_cast<float>(random.uniform(0.0, 0.25));
    }
    const Shell before = smoothed(mesh, 0);
    const Shell after = smoothed(mesh, 100);
    int held = 0;
    for (std::size_t p = 0; p < after.prisms.size(); ++p) {
        const glm::uvec3& t = after.topology->triangles[p];
        const glm::dvec3 a(after.positions[t.x]);
        const glm::dvec3 normal =
            glm::normalize(glm::cross(glm::dvec3(after.positions[t.y]) - a, glm::dvec3(after.positions[t.z]) - a));
        for (int i = 0; i < 3; ++i) {
            const double first = glm::dot(normal, glm::dvec3(before.directors[t[i]]));
            const double last = glm::dot(normal, glm::dvec3(after.directors[t[i]]));
            ASSERT_GE(last, std::min(first, 0.2588) - 1e-5);
            held += last < 0.35 ? 1 : 0;
        }
    }
    EXPECT_GT(held, 0);  // the bound was met somewhere
}

TEST(DirectorSmoothing, SameForAnyNumberOfThreads)
{
    const SurfaceMesh mesh = torus(1.0f, 0.4f, 60, 60, 1.0f, 1.0f);
    ShellOptions options;
    options.director_smoothing = 5;
    std::vector<glm::vec3> directors;
    for (const int threads : {1, 2, 3}) {
        Job job(threads);
        const Shell shell = build_shell(mesh.surface(), options, job);
        if (directors.empty()) {
            directors = shell.directors;
        }
        EXPECT_EQ(shell.directors, directors);
    }
}

TEST(DirectorSmoothing, UncoveredFacesHaveNoSay)
{
    // The left slope of the ridge alone is flat: its directors become its normal, whatever the right slope does.
    const SurfaceMesh mesh = ridge();
    std::vector<std::uint8_t> covered;
    for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 8; ++i) {
            covered.push_back(i < 4 ? 1 : 0);
        }
    }
    ShellOptions options;
    options.covered = covered;
    options.director_smoothing = 100;
    const Shell shell = build_shell(mesh.surface(), options);
    const double first = roughness(smoothed(mesh, 0));
    EXPECT_LT(roughness(shell), 0.05 * first);
}

}  // namespace
}  // namespace mesoshell
