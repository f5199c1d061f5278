// A shell holds together: fins are the same bits from both sides, and no ray is lost between prisms, however it runs.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <vector>

#include "check.h"
#include "embree_scene.h"
#include "mesoshell/render.h"
#include "meshes.h"
#include "prism_truth.h"
#include "shell_table.h"

namespace mesoshell {
namespace {

using Bits = std::array<std::uint32_t, 3>;

Bits bits_of(const glm::vec4& texel)
{
    Bits bits;
    std::memcpy(bits.data(), &texel, sizeof bits);
    return bits;
}

// Base and top of the column where a fin starts, and of that where it ends, seen from its prism.
using Fin = std::array<Bits, 4>;

Fin fin_of(const PrismTexels& prism, std::size_t i)
{
    const std::size_t j = (i + 1) % 3;
    return {bits_of(prism[i]), bits_of(prism[i + 3]), bits_of(prism[j]), bits_of(prism[j + 3])};
}

// Whether each fin of each prism has no neighbor. A fin that two prisms have on the same side is a failure.
std::vector<std::array<bool, 3>> border_fins(const Shell& shell)
{
    std::map<Fin, int> seen;
    for (const PrismTexels& prism : shell.prisms) {
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(seen[fin_of(prism, i)]++, 0) << "two prisms on the same side of a fin";
        }
    }
    std::vector<std::array<bool, 3>> border(shell.prisms.size());
    for (std::size_t p = 0; p < border.size(); ++p) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Fin fin = fin_of(shell.prisms[p], i);
            border[p][i] = seen.count({fin[2], fin[3], fin[0], fin[1]}) == 0;
        }
    }
    return border;
}

int count_border(const Shell& shell)
{
    int count = 0;
    for (const std::array<bool, 3>& fins : border_fins(shell)) {
        count += static_cast<int>(std::count(fins.begin(), fins.end(), true));
    }
    return count;
}

// Every second face has the tile mirrored: a UV seam around each.
SurfaceMesh mirrored_islands(SurfaceMesh mesh)
{
    std::size_t corner = 0;
    for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
        for (int k = 0; k < mesh.face_sizes[face]; ++k, ++corner) {
            mesh.uvs[corner].x *= face % 2 == 0 ? 1.0f : -1.0f;
        }
    }
    return mesh;
}

// A torus with a quarter cut out.
SurfaceMesh open_torus()
{
    SurfaceMesh mesh = torus(1.0f, 0.42f, 24, 12, 10.0f, 5.0f);
    mesh.face_sizes.resize(mesh.face_sizes.size() * 3 / 4);
    mesh.corners.resize(mesh.face_sizes.size() * 4);
    mesh.uvs.resize(mesh.corners.size());
    return mesh;
}

TEST(ShellLaws, FinsAreTheSameBitsFromBothSides)
{
    Job job;
    for (int level = 0; level <= 2; ++level) {
        for (const float shift : {0.0f, -0.5f, -1.0f}) {
            const auto border = [&](const SurfaceMesh& mesh) {
                Shell shell = mesh.shell(0.1f, level);
                shell.shift = shift;
                make_table(shell, job);
                return count_border(shell);
            };
            SCOPED_TRACE("level " + std::to_string(level) + ", shift " + std::to_string(shift));
            EXPECT_EQ(border(torus(1.0f, 0.42f, 24, 12, 10.0f, 5.0f)), 0);
            EXPECT_EQ(border(mirrored_islands(torus(1.0f, 0.42f, 24, 12, 10.0f, 5.0f))), 0);
            EXPECT_EQ(border(cube()), 0);
            EXPECT_EQ(border(mirrored_islands(cube())), 0);
            EXPECT_EQ(border(octahedron()), 0);
            EXPECT_EQ(border(mirrored_islands(round_octahedron(1))), 0);
            EXPECT_EQ(border(flat_grid(5, 3, 1.0f, 1.0f)), 16 << level);
            EXPECT_EQ(border(mirrored_islands(flat_grid(5, 3, 1.0f, 1.0f))), 16 << level);
        }
    }
}

// Rays through a point of a shell, and whether spans lead there from the outside and back without a gap.
class RayLaw {
public:
    explicit RayLaw(const Shell& shell) : shell_(shell), border_(border_fins(shell)), scene_(boxes(shell))
    {
        for (const PrismTexels& prism : shell.prisms) {
            truths_.emplace_back(prism);
        }
        for (std::size_t p = 0; p < border_.size(); ++p) {
            for (std::size_t i = 0; i < 3; ++i) {
                for (const std::size_t column : {i, (i + 1) % 3}) {
                    border_columns_[bits_of(shell.prisms[p][column])] |= border_[p][i];
                }
            }
        }
    }

    // `kind`: 0 a point within a prism, 1 in a fin, 2 in a column, in any direction; 3 in a fin, along it; 4 in a fin, 5 in a prism,
    // 6 in a column, along the triangle there; 7 in a fin, along its edge at that height. From 3 on, two in three are off by
    // slopes from 1e-9 to 1e-3.
    void cast(Random& random, int kind)
    {
        const auto p = static_cast<std::size_t>(random.below(static_cast<int>(shell_.prisms.size())));
        const auto i = static_cast<std::size_t>(random.below(3));
        const bool in_prism = kind == 0 || kind == 5;
        const bool in_column = kind == 2 || kind == 6;
        if (!in_prism && (in_column ? border_columns_[bits_of(shell_.prisms[p][i])] : border_[p][i])) {
            return;
        }
        const double share = random.uniform(0.02, 0.98);
        double weights[3] = {0.0, 0.0, 0.0};
        weights[i] = in_column ? 1.0 : share;
        weights[(i + 1) % 3] = 1.0 - weights[i];
        if (in_prism) {
            weights[(i + 2) % 3] = random.uniform(0.02, 0.9);
            for (const std::size_t k : {i, (i + 1) % 3}) {
                weights[k] *= 1.0 - weights[(i + 2) % 3];
            }
        }
        const glm::dvec3 q(weights[1], weights[2], random.uniform(0.02, 0.98));
        const PrismTruth& truth = truths_[p];
        const glm::dvec3 point = truth.position(q);
        const glm::dvec3 edge = glm::normalize(truth.column((i + 1) % 3, q.z) - truth.column(i, q.z));
        const glm::dvec3 rise = glm::normalize(truth.position({q.x, q.y, 1.0}) - truth.position({q.x, q.y, 0.0}));
        const glm::dvec3 normal = glm::normalize(
            glm::cross(truth.column(1, q.z) - truth.column(0, q.z), truth.column(2, q.z) - truth.column(0, q.z)));
        glm::dvec3 dir = random.direction();
        if (kind == 3) {
            const double angle = random.uniform(0.0, 6.283185307179586);
            dir = glm::normalize(std::cos(angle) * edge + std::sin(angle) * rise);
        } else if (kind == 7) {
            dir = edge;
        } else if (kind > 3) {
            dir = glm::normalize(dir - glm::dot(dir, normal) * normal);
        }
        if (kind >= 3 && random.below(3) > 0) {
            dir = glm::normalize(dir + std::pow(10.0, random.uniform(-9.0, -3.0)) * random.direction());
        }
        follow(glm::vec3(point - random.uniform(4.0, 5.0) * dir), glm::vec3(dir), point, p, q.z, kind);
    }

    int rays() const { return rays_; }
    int joints() const { return joints_; }

private:
    struct Stretch {
        PrismSpan span;
        std::uint32_t prism;
    };

    static std::vector<BoxScene::Box> boxes(const Shell& shell)
    {
        std::vector<BoxScene::Box> boxes;
        for (const PrismTexels& prism : shell.prisms) {
            glm::vec3 lower(prism[0]);
            glm::vec3 upper = lower;
            for (std::size_t corner = 1; corner < 6; ++corner) {
                lower = glm::min(lower, glm::vec3(prism[corner]));
                upper = glm::max(upper, glm::vec3(prism[corner]));
            }
            boxes.push_back({lower - 1e-4f, upper + 1e-4f});
        }
        return boxes;
    }

    // Whether the shell ends where a span does: at its bottom, its top, a fin without a neighbor, or a column of one.
    bool ends_outside(const Stretch& stretch, const glm::vec3& q) const
    {
        const float weights[3] = {1.0f - q.x - q.y, q.x, q.y};
        bool outside = q.z < 1e-3f || q.z > 0.999f;
        for (std::size_t i = 0; i < 3; ++i) {
            // Fin i runs from column i to the next: the third weighs nothing there.
            const bool in_fin = border_[stretch.prism][i] && weights[(i + 2) % 3] < 1e-3f;
            const bool in_column = weights[i] > 0.999f && border_columns_.at(bits_of(shell_.prisms[stretch.prism][i]));
            outside = outside || in_fin || in_column;
        }
        return outside;
    }

    void follow(const glm::vec3& origin, const glm::vec3& dir, const glm::dvec3& point, std::size_t through, double height, int kind)
    {
        std::vector<Stretch> stretches;
        scene_.visit_along(origin, dir, 0.0f, [&](std::uint32_t prism, float tfar) {
            for (const PrismSpan& span : prism_spans(shell_.prisms[prism], origin, dir, everywhere)) {
                stretches.push_back({span, prism});
            }
            return tfar;
        });
        std::sort(stretches.begin(), stretches.end(),
                  [](const Stretch& a, const Stretch& b) { return a.span.t_in < b.span.t_in; });
        const double t = glm::dot(point - glm::dvec3(origin), glm::dvec3(dir));
        double nearest = 1e30;
        std::optional<Stretch> last;
        bool begins_outside = true;
        bool ends_well = true;
        float begin = 0.0f;
        for (const Stretch& stretch : stretches) {
            nearest = std::min(nearest, std::max({0.0, stretch.span.t_in - t, t - stretch.span.t_out}));
            const double gap = last ? gap_allowed(origin, dir, *last, stretch) : 0.0;
            if (last && stretch.span.t_in - last->span.t_out <= gap) {
                joints_ += 1;
            } else {
                ASSERT_TRUE(begins_outside) << "kind " << kind << ": a ray begins within the shell";
                ASSERT_TRUE(ends_well) << "kind " << kind << ": a ray ends within the shell";
                begin = stretch.span.t_in;
                begins_outside = false;
                ends_well = false;
            }
            // At a corner of the shell rounding decides which prism comes first.
            const bool same_begin = stretch.span.t_in <= begin + gap;
            begins_outside = begins_outside || (same_begin && ends_outside(stretch, stretch.span.q_in));
            const bool same_end = last && std::abs(stretch.span.t_out - last->span.t_out) <= gap;
            const bool goes_on = !last || stretch.span.t_out > last->span.t_out;
            ends_well = (ends_well && (same_end || !goes_on)) ||
                        ((same_end || goes_on) && ends_outside(stretch, stretch.span.q_out));
            if (!last || stretch.span.t_out > last->span.t_out) {
                last = stretch;
            }
        }
        ASSERT_TRUE(begins_outside && ends_well) << "kind " << kind << ": a ray begins or ends within the shell";
        const double error = 3.0 * truths_[through].size() * truths_[through].coordinate_error(origin, dir, height);
        ASSERT_LE(nearest, 1e-4 + std::min(error, 1e-2)) << "kind " << kind << ": a ray misses the point that it runs through";
        rays_ += 1;
    }

    // What rounding may leave between two spans (PrismTruth::coordinate_error), less than a hundredth of the shell's size.
    double gap_allowed(const glm::dvec3& origin, const glm::dvec3& dir, const Stretch& a, const Stretch& b) const
    {
        const PrismTruth& before = truths_[a.prism];
        const PrismTruth& after = truths_[b.prism];
        const double error = 3.0 * before.size() * before.coordinate_error(origin, dir, a.span.q_out.z) +
                             3.0 * after.size() * after.coordinate_error(origin, dir, b.span.q_in.z);
        return 1e-4 + std::min(error, 1e-2);
    }

    const Shell& shell_;
    std::vector<std::array<bool, 3>> border_;
    std::map<Bits, bool> border_columns_;
    BoxScene scene_;
    std::vector<PrismTruth> truths_;
    int rays_ = 0;
    int joints_ = 0;
};

// Five shells, more than 200,000 rays each.
void expect_no_ray_lost(const Shell& shell, std::uint32_t seed)
{
    RayLaw law(shell);
    Random random(seed);
    for (int i = 0; i < 216000 && !testing::Test::HasFatalFailure(); ++i) {
        law.cast(random, i % 8);
    }
    EXPECT_GT(law.rays(), 200000);
    EXPECT_GT(law.joints(), 200000);
}

TEST(ShellLaws, NoRayIsLostInARoundShell)
{
    expect_no_ray_lost(round_octahedron(2).shell(0.2f), 31);
}

TEST(ShellLaws, NoRayIsLostInAThickTorus)
{
    expect_no_ray_lost(mirrored_islands(torus(1.0f, 0.42f, 24, 12, 10.0f, 5.0f)).shell(0.31f, 1), 32);
}

TEST(ShellLaws, NoRayIsLostInAThinTorus)
{
    expect_no_ray_lost(torus(1.0f, 0.42f, 24, 12, 10.0f, 5.0f).shell(0.005f), 33);
}

TEST(ShellLaws, NoRayIsLostInAShellWithBorders)
{
    expect_no_ray_lost(open_torus().shell(0.2f, 1), 34);
}

TEST(ShellLaws, NoRayIsLostAroundACube)
{
    expect_no_ray_lost(cube().shell(0.3f, 2), 35);
}

}  // namespace
}  // namespace mesoshell
