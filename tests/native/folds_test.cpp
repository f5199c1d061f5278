// Laws of find_folds: closed forms on simple shells, and sampled points that lie in two prisms.
#include "mesoshell/folds.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "check.h"
#include "fold_meshes.h"
#include "prism_truth.h"

namespace mesoshell {
namespace {

std::size_t count(const std::vector<std::uint8_t>& marks)
{
    return static_cast<std::size_t>(std::count(marks.begin(), marks.end(), 1));
}

Shell shell_of(const SurfaceMesh& mesh, float thickness, float shift)
{
    ShellOptions options;
    options.thickness = thickness;
    Shell shell = build_shell(mesh.surface(), options);
    shell.shift = shift;  // find_folds reads vertices alone
    return shell;
}

TEST(FindFolds, ConvexShellsHaveNone)
{
    for (const float thickness : {0.01f, 1.0f, 100.0f}) {
        for (const SurfaceMesh& mesh : {cube(), octahedron(), round_octahedron(3), flat_grid(5, 4, 2.0f, 1.0f)}) {
            const Folds folds = find_folds(mesh.shell(thickness));
            EXPECT_EQ(count(folds.inverted), 0u);
            EXPECT_EQ(count(folds.intersecting), 0u);
            EXPECT_EQ(count(folds.base), 0u);
            EXPECT_TRUE(folds.pairs.empty());
        }
    }
}

TEST(FindFolds, InwardSphereFoldsBeyondItsRadius)
{
    SurfaceMesh mesh = round_octahedron(3);
    mesh.normals = mesh.positions;  // every column ends at the center
    for (const float thickness : {0.5f, 0.95f, 0.999f}) {
        const Folds folds = find_folds(shell_of(mesh, thickness, -1.0f));
        EXPECT_EQ(count(folds.inverted) + count(folds.intersecting), 0u) << thickness;
    }
    const Folds folds = find_folds(shell_of(mesh, 1.5f, -1.0f));
    for (std::size_t p = 0; p < folds.inverted.size(); ++p) {
        EXPECT_TRUE(folds.inverted[p] != 0 || folds.intersecting[p] != 0);
        EXPECT_EQ(folds.base[p], 0);
    }
}

TEST(FindFolds, InwardTorusFoldsBeyondItsTube)
{
    SurfaceMesh mesh = torus(1.0f, 0.4f, 24, 16, 3.0f, 2.0f);
    for (const float thickness : {0.2f, 0.37f}) {
        const Folds folds = find_folds(shell_of(mesh, thickness, -1.0f));
        EXPECT_EQ(count(folds.inverted) + count(folds.intersecting), 0u) << thickness;
    }
    for (const float thickness : {0.41f, 0.6f}) {
        const Folds folds = find_folds(shell_of(mesh, thickness, -1.0f));
        EXPECT_GT(count(folds.inverted) + count(folds.intersecting), folds.inverted.size() / 2) << thickness;
    }
    // Outward it closes its hole at a thickness of 0.6, on the inner side of the ring.
    EXPECT_EQ(count(find_folds(mesh.shell(0.55f)).intersecting), 0u);
    EXPECT_GT(count(find_folds(mesh.shell(0.65f)).intersecting), 0u);
}

TEST(FindFolds, FacingPlatesTouchAtHalfTheirDistance)
{
    for (const int cells : {1, 4}) {
        const SurfaceMesh mesh = facing_plates(0.5f, cells);
        EXPECT_EQ(count(find_folds(mesh.shell(0.2f)).intersecting), 0u);
        EXPECT_EQ(count(find_folds(mesh.shell(0.25f)).intersecting), 0u) << "touching is no overlap";
        const Folds folds = find_folds(mesh.shell(0.2501f));
        EXPECT_EQ(count(folds.intersecting), folds.intersecting.size());
        EXPECT_EQ(count(folds.inverted), 0u);
        EXPECT_EQ(count(folds.base), 0u);
    }
}

// Two plates that meet at a concave angle: the bisector of the angle is the director along the crease, so that the prisms'
// columns end on the plane between the plates there. `arm` beyond the crease a plate is as thick as its distance from that
// plane at a thickness of arm tan(angle / 2).
TEST(FindFolds, ValleysFoldWhereTheNextColumnsMeet)
{
    // One cell on each side: the only columns off the crease stand at a distance of 1 from it.
    const float angle = 1.0f;
    const float limit = std::tan(0.5f * angle);
    EXPECT_EQ(count(find_folds(valley(angle, 1).shell(0.98f * limit)).intersecting), 0u);
    EXPECT_EQ(count(find_folds(valley(angle, 1).shell(0.98f * limit)).inverted), 0u);
    const Folds folds = find_folds(valley(angle, 1).shell(1.02f * limit));
    EXPECT_GT(count(folds.intersecting) + count(folds.inverted), 0u);
    EXPECT_EQ(count(folds.base), 0u);
    // Four cells: four times sooner.
    EXPECT_EQ(count(find_folds(valley(angle, 4).shell(0.98f * 0.25f * limit)).intersecting), 0u);
    EXPECT_GT(count(find_folds(valley(angle, 4).shell(1.02f * 0.25f * limit)).intersecting) +
                  count(find_folds(valley(angle, 4).shell(1.02f * 0.25f * limit)).inverted),
              0u);
}

TEST(FindFolds, APartInsideAPrismOfAnother)
{
    // A small sphere between a plate and its top, in the middle of one large prism: their boundaries do not cross.
    SurfaceMesh ball = round_octahedron(2);
    for (glm::vec3& p : ball.positions) {
        p = glm::vec3(3.0f, 1.5f, 0.5f) + 0.1f * p;
    }
    const SurfaceMesh mesh = joined(flat_grid(1, 1, 4.0f, 4.0f), ball);
    Shell shell = mesh.shell(0.2f);
    std::fill(shell.thickness.begin() + 4, shell.thickness.end(), 0.01f);
    EXPECT_EQ(count(find_folds(shell).intersecting), 0u);
    std::fill(shell.thickness.begin(), shell.thickness.begin() + 4, 1.5f);
    const Folds folds = find_folds(shell);
    for (std::size_t p = 2; p < folds.intersecting.size(); ++p) {
        EXPECT_EQ(folds.intersecting[p], 1) << p;
    }
    EXPECT_EQ(folds.intersecting[0] + folds.intersecting[1], 1);
    EXPECT_EQ(count(folds.base), 0u);
    EXPECT_EQ(count(folds.inverted), 0u);
}

TEST(FindFolds, CrossingSurfacesAreOfTheBase)
{
    SurfaceMesh mesh = flat_grid(1, 1, 2.0f, 2.0f);
    const SurfaceMesh other = mesh;
    for (const glm::vec3& p : other.positions) {
        mesh.positions.emplace_back(p.x + 0.25f, 1.25f, p.y - 1.0f);
    }
    for (const std::int32_t corner : other.corners) {
        mesh.corners.push_back(corner + 4);
    }
    mesh.uvs.insert(mesh.uvs.end(), other.uvs.begin(), other.uvs.end());
    mesh.face_sizes.push_back(4);
    mesh.normals.clear();
    for (const float shift : {0.0f, -0.5f, -1.0f}) {
        const Folds folds = find_folds(shell_of(mesh, 0.1f, shift));
        EXPECT_GT(count(folds.base), 0u);
        EXPECT_EQ(count(folds.inverted), 0u);
        for (const glm::uvec2& pair : folds.pairs) {
            EXPECT_LT(pair.x, 2u);
            EXPECT_GE(pair.y, 2u);
        }
    }
}

TEST(FindFolds, ThreeSheetsAtAnEdge)
{
    // A wall on a floor: two of the three faces use the edge in the same direction.
    SurfaceMesh mesh = flat_grid(2, 1, 2.0f, 1.0f);
    const auto first = static_cast<std::int32_t>(mesh.positions.size());
    mesh.positions.emplace_back(1.0f, 0.0f, 1.0f);
    mesh.positions.emplace_back(1.0f, 1.0f, 1.0f);
    std::int32_t low = -1, high = -1;
    for (std::int32_t i = 0; i < first; ++i) {
        if (mesh.positions[static_cast<std::size_t>(i)] == glm::vec3(1, 0, 0)) {
            low = i;
        }
        if (mesh.positions[static_cast<std::size_t>(i)] == glm::vec3(1, 1, 0)) {
            high = i;
        }
    }
    mesh.face_sizes.push_back(4);
    for (const std::int32_t corner : {low, high, first + 1, first}) {
        mesh.corners.push_back(corner);
        mesh.uvs.emplace_back(0.0f, 0.0f);
    }
    mesh.normals.clear();
    const Folds folds = find_folds(mesh.shell(0.1f));
    EXPECT_GT(count(folds.base), 1u);
    EXPECT_GT(count(folds.intersecting), 1u);
}

bool share_vertex(const Shell& shell, std::size_t p, std::size_t q)
{
    for (int i = 0; i < 9; ++i) {
        if (shell.topology->triangles[p][i / 3] == shell.topology->triangles[q][i % 3]) {
            return true;
        }
    }
    return false;
}

TEST(FindFolds, EveryPointInTwoPrismsIsReported)
{
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::size_t overlaps = 0;
    for (unsigned seed = 0; seed < 8; ++seed) {
        for (const float shift : {0.0f, -0.5f, -1.0f}) {
            const Shell shell = [&] {
                Shell made = shell_of(bumpy(2, 0.4f, seed), 0.5f, shift);
                return made;
            }();
            const Folds folds = find_folds(shell);
            std::vector<PrismTruth> truths;
            for (const glm::uvec3& t : shell.topology->triangles) {
                truths.emplace_back(prism_of({shell.base(t.x), shell.base(t.y), shell.base(t.z)},
                                             {shell.top(t.x), shell.top(t.y), shell.top(t.z)}));
            }
            for (std::size_t p = 0; p < truths.size(); ++p) {
                for (int sample = 0; sample < 20; ++sample) {
                    double q1 = unit(random), q2 = unit(random);
                    if (q1 + q2 > 1.0) {
                        q1 = 1.0 - q1;
                        q2 = 1.0 - q2;
                    }
                    const glm::dvec3 point = truths[p].position({q1, q2, unit(random)});
                    if (truths[p].depth(point) < 1e-3) {
                        continue;
                    }
                    for (std::size_t q = 0; q < truths.size(); ++q) {
                        if (q == p || glm::length(point - truths[q].position({0.33, 0.33, 0.5})) > truths[q].size() ||
                            truths[q].depth(point) < 1e-3) {
                            continue;
                        }
                        ++overlaps;
                        const auto marked = [&](std::size_t i) {
                            return folds.intersecting[i] != 0 || folds.inverted[i] != 0;
                        };
                        // Beside an inverted prism, one with a vertex of it need not be marked as well.
                        const bool beside = share_vertex(shell, p, q) && (folds.inverted[p] != 0 || folds.inverted[q] != 0);
                        EXPECT_TRUE(beside || (marked(p) && marked(q))) << seed << " " << shift << ": " << p << " and " << q;
                    }
                }
            }
        }
    }
    EXPECT_GT(overlaps, 1000u);
}

}  // namespace
}  // namespace mesoshell
