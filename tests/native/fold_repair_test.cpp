// Laws of the repair: nothing folds afterwards but what no thickness mends, most of the thickness stays, and it changes
// gently.
#include <algorithm>
#include <cmath>
#include <string>

#include "check.h"
#include "fold_meshes.h"
#include "mesoshell/folds.h"
#include "prism_truth.h"

namespace mesoshell {
namespace {

std::size_t count(const std::vector<std::uint8_t>& marks)
{
    return static_cast<std::size_t>(std::count(marks.begin(), marks.end(), 1));
}

Shell asked(const SurfaceMesh& mesh, float thickness, float shift, int levels = 0)
{
    Shell shell = mesh.shell(thickness, levels);
    shell.shift = shift;
    return shell;
}

float median_share(const Shell& before, const Shell& after)
{
    std::vector<float> shares;
    for (std::size_t v = 0; v < before.thickness.size(); ++v) {
        if (before.thickness[v] > 0.0f) {
            shares.push_back(after.thickness[v] / before.thickness[v]);
        }
    }
    std::nth_element(shares.begin(), shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2), shares.end());
    return shares[shares.size() / 2];
}

// Repairs and holds the result to the laws that hold for every shell; returns the share of the thickness that the median
// vertex keeps. `base`: whether some folds are of the base.
float repaired(const SurfaceMesh& mesh, float thickness, float shift, bool base, const std::string& name, int levels = 0)
{
    const Shell before = asked(mesh, thickness, shift, levels);
    Shell after = before;
    Job job;
    repair_folds(after, job);
    const Folds left = find_folds(after);
    for (std::size_t p = 0; p < left.inverted.size(); ++p) {
        EXPECT_EQ(left.inverted[p], 0) << name << ", shift " << shift << ": prism " << p;
        EXPECT_LE(left.intersecting[p], left.base[p]) << name << ", shift " << shift << ": prism " << p;
    }
    if (!base) {
        EXPECT_EQ(count(left.base), 0u) << name;
    }
    const float slope = repair_slope / *std::max_element(before.thickness.begin(), before.thickness.end());
    for (const glm::uvec3& t : after.topology->triangles) {
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t a = t[i];
            const std::uint32_t b = t[(i + 1) % 3];
            EXPECT_LE(after.thickness[a], before.thickness[a]);
            EXPECT_GE(after.thickness[a], 0.0f);
            const float share_a = before.thickness[a] > 0.0f ? after.thickness[a] / before.thickness[a] : 1.0f;
            const float share_b = before.thickness[b] > 0.0f ? after.thickness[b] / before.thickness[b] : 1.0f;
            if (before.thickness[a] > 0.0f && before.thickness[b] > 0.0f) {
                EXPECT_LE(std::abs(share_a - share_b),
                          slope * glm::length(after.positions[a] - after.positions[b]) * 1.0001f + 1e-6f)
                    << name;
            }
        }
    }
    return median_share(before, after);
}

// How many of some points drawn from all prisms lie inside another one as well, by more than 1e-3 of prism coordinates.
std::size_t points_in_two(const Shell& shell, std::uint32_t seed)
{
    Random random(seed);
    std::vector<PrismTruth> truths;
    for (const glm::uvec3& t : shell.topology->triangles) {
        truths.emplace_back(
            prism_of({shell.base(t.x), shell.base(t.y), shell.base(t.z)}, {shell.top(t.x), shell.top(t.y), shell.top(t.z)}));
    }
    std::size_t found = 0;
    for (std::size_t p = 0; p < truths.size(); ++p) {
        for (int sample = 0; sample < 30; ++sample) {
            const double q1 = random.uniform(0.0, 1.0);
            const double q2 = random.uniform(0.0, 1.0 - q1);
            const glm::dvec3 point = truths[p].position({q1, q2, random.uniform(0.0, 1.0)});
            for (std::size_t q = 0; q < truths.size(); ++q) {
                if (q != p && glm::length(point - truths[q].position({0.33, 0.33, 0.5})) < truths[q].size() &&
                    truths[q].depth(point) > 1e-3) {
                    ++found;
                }
            }
        }
    }
    return found;
}

constexpr float shifts[] = {0.0f, -0.5f, -1.0f};

TEST(RepairFolds, LeavesSoundShellsAlone)
{
    for (const SurfaceMesh& mesh :
         {cube(), round_octahedron(3), flat_grid(4, 4, 1.0f, 1.0f), torus(1.0f, 0.4f, 24, 16, 3, 2)}) {
        const Shell before = mesh.shell(0.3f);
        Shell after = before;
        Job job;
        repair_folds(after, job);
        EXPECT_EQ(after.thickness, before.thickness);
        EXPECT_EQ(after.directors, before.directors);
    }
}

TEST(RepairFolds, InwardSphereStaysWithinItsRadius)
{
    for (const float thickness : {1.2f, 3.0f, 30.0f}) {
        EXPECT_GT(repaired(round_octahedron(3), thickness, -1.0f, false, "sphere"), 0.8f / thickness);
    }
}

TEST(RepairFolds, InwardTorus)
{
    EXPECT_GT(repaired(torus(1.0f, 0.4f, 24, 16, 3, 2), 0.42f, -1.0f, false, "torus"), 0.8f);
    EXPECT_GT(repaired(torus(1.0f, 0.4f, 24, 16, 3, 2), 0.65f, 0.0f, false, "torus outward"), 0.8f);
}

TEST(RepairFolds, FacingPlatesShareTheGap)
{
    const float share = repaired(facing_plates(0.5f, 8), 0.3f, 0.0f, false, "facing plates");
    EXPECT_GT(share, 0.8f);
    EXPECT_LE(share, 0.25f / 0.3f);
}

TEST(RepairFolds, Valleys)
{
    for (const float angle : {0.3f, 1.0f, 2.0f}) {
        for (const float shift : shifts) {
            repaired(valley(angle, 16), 0.1f, shift, false, "valley " + std::to_string(angle));
        }
    }
    EXPECT_GT(repaired(valley(1.0f, 16), 0.1f, 0.0f, false, "valley"), 0.8f);
}

TEST(RepairFolds, Sockets)
{
    for (const float shift : shifts) {
        EXPECT_GT(repaired(sockets(4), 0.08f, shift, false, "sockets"), 0.8f);
    }
}

TEST(RepairFolds, Bumps)
{
    for (unsigned seed = 0; seed < 5; ++seed) {
        for (const float shift : shifts) {
            repaired(bumpy(3, 0.3f, seed), 0.3f, shift, true, "bumpy");
        }
    }
}

TEST(RepairFolds, Spikes)
{
    for (const float shift : shifts) {
        repaired(spikes(3), 0.1f, shift, true, "spikes");
    }
}

TEST(RepairFolds, GroovesAndSaddles)
{
    const SurfaceMesh groove =
        height_field(32, [](float x, float) { return -0.5f * std::exp(-std::pow((x - 0.5f) / 0.08f, 4.0f)); });
    const SurfaceMesh saddle = height_field(24, [](float x, float y) { return 4.0f * (x - 0.5f) * (y - 0.5f); });
    const SurfaceMesh waves =
        height_field(40, [](float x, float y) { return 0.1f * std::sin(20.0f * x) * std::sin(20.0f * y); });
    for (const float shift : shifts) {
        EXPECT_GT(repaired(groove, 0.1f, shift, false, "groove"), 0.8f);
        EXPECT_GT(repaired(saddle, 0.2f, shift, false, "saddle"), 0.8f);
        EXPECT_GT(repaired(waves, 0.05f, shift, false, "waves"), 0.8f);
    }
}

TEST(RepairFolds, APartInsideAPrismOfAnother)
{
    SurfaceMesh ball = round_octahedron(2);
    for (glm::vec3& p : ball.positions) {
        p = glm::vec3(0.7f, 0.4f, 0.25f) + 0.03f * p;
    }
    for (const float thickness : {0.3f, 0.6f}) {
        repaired(joined(flat_grid(8, 8, 1.0f, 1.0f), ball), thickness, 0.0f, false, "ball in a plate");
    }
}

// After repair no point drawn from a prism lies inside another: the judge is the prisms' inverse map in double precision.
TEST(RepairFolds, NoSampledPointIsInTwoPrisms)
{
    std::size_t before = 0, after = 0;
    for (unsigned seed = 0; seed < 4; ++seed) {
        for (const float shift : shifts) {
            Shell shell = asked(bumpy(2, 0.4f, seed), 0.5f, shift);
            before += points_in_two(shell, seed);
            Job job;
            repair_folds(shell, job);
            after += points_in_two(shell, seed);
        }
    }
    EXPECT_GT(before, 300u);
    EXPECT_EQ(after, 0u);
}

TEST(RepairFolds, MirrorImagesStayMirrorImages)
{
    // An octahedron split and pushed in along an axis is its own mirror image in x and in y, vertex for vertex.
    SurfaceMesh mesh = round_octahedron(3);
    for (glm::vec3& p : mesh.positions) {
        p *= 1.0f - 0.8f * std::exp(-8.0f * (p.x * p.x + p.y * p.y)) * (p.z > 0.0f ? 1.0f : 0.0f);
    }
    mesh.normals = {};
    Shell shell = mesh.shell(0.4f);
    const Shell before = shell;
    Job job;
    repair_folds(shell, job);
    std::size_t lowered = 0;
    for (std::size_t v = 0; v < shell.positions.size(); ++v) {
        const glm::vec3 mirrored = shell.positions[v] * glm::vec3(-1.0f, 1.0f, 1.0f);
        const auto nearest = std::min_element(
            shell.positions.begin(), shell.positions.end(),
            [&](const glm::vec3& a, const glm::vec3& b) { return glm::length(a - mirrored) < glm::length(b - mirrored); });
        ASSERT_LT(glm::length(*nearest - mirrored), 1e-6f);
        const float other = shell.thickness[static_cast<std::size_t>(nearest - shell.positions.begin())];
        EXPECT_NEAR(shell.thickness[v], other, 0.02f * before.thickness[v]) << "but for a step of the bisection";
        lowered += shell.thickness[v] < before.thickness[v] ? 1 : 0;
    }
    EXPECT_GT(lowered, 10u);
}

TEST(RepairFolds, ColumnsWithoutThicknessStay)
{
    Shell shell =
        height_field(16, [](float x, float) { return -0.4f * std::exp(-std::pow((x - 0.5f) / 0.1f, 4.0f)); }).shell(0.15f);
    for (std::size_t v = 0; v < shell.thickness.size(); ++v) {
        shell.thickness[v] *= std::clamp(4.0f * shell.positions[v].y - 1.0f, 0.0f, 1.0f);
    }
    const Shell before = shell;
    EXPECT_GT(count(find_folds(before).intersecting), 0u);
    Job job;
    repair_folds(shell, job);
    const Folds left = find_folds(shell);
    EXPECT_EQ(count(left.inverted) + count(left.intersecting), 0u);
    for (std::size_t v = 0; v < shell.thickness.size(); ++v) {
        EXPECT_LE(shell.thickness[v], before.thickness[v]);
    }
}

TEST(RepairFolds, SheetsThatShareAnEdgeEnd)
{
    // Five walls around one edge: some overlap by nature, and the repair ends all the same.
    SurfaceMesh mesh;
    mesh.positions = {glm::vec3(0, 0, 0), glm::vec3(0, 0, 1)};
    for (int i = 0; i < 5; ++i) {
        const float angle = 1.2f * static_cast<float>(i);
        for (const float z : {1.0f, 0.0f}) {
            mesh.positions.emplace_back(std::cos(angle), std::sin(angle), z);
        }
        mesh.face_sizes.push_back(4);
        for (const int corner : {0, 1, 2 + 2 * i, 3 + 2 * i}) {
            mesh.corners.push_back(corner);
            mesh.uvs.emplace_back(0.0f, 0.0f);
        }
    }
    // All walls' normals turn the same way about the edge and would cancel there.
    mesh.normals.assign(mesh.positions.size(), glm::vec3(1, 0, 0));
    for (const float shift : shifts) {
        repaired(mesh, 0.2f, shift, true, "five walls");
    }
}

TEST(RepairFolds, BuildShellRepairs)
{
    const SurfaceMesh mesh =
        height_field(24, [](float x, float) { return -0.5f * std::exp(-std::pow((x - 0.5f) / 0.08f, 4.0f)); });
    ShellOptions options;
    options.thickness = 0.1f;
    options.repair = true;
    Shell expected = mesh.shell(0.1f);
    Job job;
    repair_folds(expected, job);
    const Shell built = build_shell(mesh.surface(), options);
    EXPECT_EQ(built.thickness, expected.thickness);
    for (std::size_t p = 0; p < built.prisms.size(); ++p) {
        for (int i = 0; i < 3; ++i) {
            EXPECT_EQ(glm::vec3(built.prisms[p][static_cast<std::size_t>(i) + 3]),
                      built.top(built.topology->triangles[p][i]));
        }
    }
}

TEST(RepairFolds, CanBeCancelled)
{
    Shell shell = bumpy(3, 0.3f, 1).shell(0.3f);
    Job job;
    job.cancel();
    EXPECT_THROW(repair_folds(shell, job), Cancelled);
    EXPECT_THROW(find_folds(shell, job), Cancelled);
}

TEST(RepairFolds, SameForAnyThreads)
{
    for (const SurfaceMesh& mesh : {bumpy(3, 0.3f, 1), sockets(4)}) {
        Shell one = mesh.shell(0.3f);
        Shell three = one;
        Job job_one(1), job_three(3);
        repair_folds(one, job_one);
        repair_folds(three, job_three);
        EXPECT_EQ(one.thickness, three.thickness);
        EXPECT_EQ(one.directors, three.directors);
    }
}

}  // namespace
}  // namespace mesoshell
