// Laws of the repair: nothing folds afterwards but what no thickness mends, most of the thickness stays, and it changes gently.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "check.h"
#include "fold_meshes.h"
#include "mesoshell/folds.h"

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
    const Folds folds = find_folds(before);
    Shell after = before;
    Job job;
    repair_folds(after, job);
    const Folds left = find_folds(after);
    for (std::size_t p = 0; p < left.inverted.size(); ++p) {
        EXPECT_TRUE(left.base[p] != 0 || (left.inverted[p] == 0 && left.intersecting[p] == 0))
            << name << ", shift " << shift << ": prism " << p << (left.inverted[p] != 0 ? " is inverted" : " overlaps");
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
                EXPECT_LE(std::abs(share_a - share_b), slope * glm::length(after.positions[a] - after.positions[b]) * 1.0001f + 1e-6f)
                    << name;
            }
        }
    }
    const float share = median_share(before, after);
    std::printf("%-28s shift %4.1f %7zu prisms: %6zu inverted %6zu overlapping before, %4zu of the base left, median %.3f\n",
                name.c_str(), shift, left.inverted.size(), count(folds.inverted), count(folds.intersecting), count(left.base), share);
    return share;
}

constexpr float shifts[] = {0.0f, -0.5f, -1.0f};

TEST(RepairFolds, LeavesSoundShellsAlone)
{
    for (const SurfaceMesh& mesh : {cube(), round_octahedron(3), flat_grid(4, 4, 1.0f, 1.0f), torus(1.0f, 0.4f, 24, 16, 3, 2)}) {
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
    const SurfaceMesh groove = height_field(32, [](float x, float) { return -0.5f * std::exp(-std::pow((x - 0.5f) / 0.08f, 4.0f)); });
    const SurfaceMesh saddle = height_field(24, [](float x, float y) { return 4.0f * (x - 0.5f) * (y - 0.5f); });
    const SurfaceMesh waves = height_field(40, [](float x, float y) { return 0.1f * std::sin(20.0f * x) * std::sin(20.0f * y); });
    for (const float shift : shifts) {
        EXPECT_GT(repaired(groove, 0.1f, shift, false, "groove"), 0.8f);
        EXPECT_GT(repaired(saddle, 0.2f, shift, false, "saddle"), 0.8f);
        EXPECT_GT(repaired(waves, 0.05f, shift, false, "waves"), 0.8f);
    }
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
