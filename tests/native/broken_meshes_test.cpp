// A thousand broken meshes: they bake to what a winding number by brute force says, or are refused in a sentence.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>

#include "broken_meshes.h"
#include "mesoshell/bake.h"
#include "mesoshell/error.h"
#include "tile_space.h"
#include "winding_oracle.h"

namespace mesoshell {
namespace {

constexpr int of_each_kind = 9;  // 8 solids x 12 damages x 9, 75 soups, 60 that are no meshes, and one that is nothing: 1,000
constexpr int soups = 75;
// Whole nodes are clear whose winding number is farther than this from one half.
constexpr double unclear = 0.1;
constexpr int nodes_asked = 80;
constexpr double least_share = 0.95;

enum class Outcome { matched, mismatched, refused };

struct Result {
    Outcome outcome = Outcome::matched;
    std::string what;  // the refusal, or the first difference
};

glm::dvec3 place_of(const glm::ivec3& nodes, const Sample& sample, const glm::ivec3& node)
{
    return {double(node.x) / nodes.x, sample.aspect() * double(node.y) / nodes.y,
            sample.height() * double(node.z) / (nodes.z - 1)};
}

std::string at(const glm::dvec3& p)
{
    return " at " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z);
}

// Insideness as the truth has it: 1 inside, 0 outside, -1 unclear.
using Truth = std::function<int(const glm::dvec3&)>;

// Bakes a sample, by both engines and as distances, and compares.
Result compare(const Sample& sample, const Truth& truth, Random& random)
{
    Job job;
    const glm::ivec3 nodes(13, 11, 9);
    const std::vector<std::uint8_t> inside = classify_inside(sample, nodes, job);
    for (int i = 0; i < nodes_asked; ++i) {
        const glm::ivec3 node(random.below(nodes.x), random.below(nodes.y), random.below(nodes.z));
        const glm::dvec3 p = place_of(nodes, sample, node);
        const int expected = truth(p);
        const bool is_inside = inside[(static_cast<std::size_t>(node.z) * nodes.y + node.y) * nodes.x + node.x] != 0;
        if (expected >= 0 && is_inside != (expected == 1)) {
            return {Outcome::mismatched, (is_inside ? "inside" : "outside") + at(p)};
        }
    }

    const glm::ivec3 sdf_nodes(8, 9, 7);
    const double voxel = 1.0 / sdf_nodes.x;
    const Sdf sdf = bake_sdf(sample, sdf_nodes, job);
    for (int i = 0; i < 12; ++i) {
        const glm::ivec3 node(random.below(sdf_nodes.x), random.below(sdf_nodes.y), random.below(sdf_nodes.z));
        const glm::dvec3 p = place_of(sdf_nodes, sample, node);
        const double value = sdf.values[(static_cast<std::size_t>(node.z) * sdf_nodes.y + node.y) * sdf_nodes.x + node.x];
        double exact = brute_force_distance(sample.slab_positions(), sample.slab_triangles(), sample.aspect(), p, 3);
        if (std::signbit(value)) {
            exact = std::min(exact, std::min(p.z, sample.height() - p.z));  // the caps of the tile's height
        }
        if (std::abs(std::abs(value) - exact) > 0.5 * voxel) {
            return {Outcome::mismatched, "distance " + std::to_string(value) + " for " + std::to_string(exact) + at(p)};
        }
        const int expected = truth(p);
        if (expected >= 0 && std::abs(value) > 0.5 * voxel && (value < 0.0) != (expected == 1)) {
            return {Outcome::mismatched, "sign of " + std::to_string(value) + at(p)};
        }
    }

    GdmResolution resolution;
    resolution.nodes = glm::ivec3(8, 9, 5);
    resolution.ntheta = 4;
    resolution.nphi = 3;
    const Gdm rays = bake_gdm(sample, resolution, Engine::embree, job);
    const Gdm slices = bake_gdm(sample, resolution, Engine::slices, job);
    std::size_t differing = 0;
    for (std::size_t i = 0; i < rays.values.size(); ++i) {
        if (!std::isfinite(slices.values[i]) || slices.values[i] < 0.0f || !std::isfinite(rays.values[i])) {
            return {Outcome::mismatched, "a distance along a ray is " + std::to_string(slices.values[i])};
        }
        differing += std::abs(rays.values[i] - slices.values[i]) > 1e-4f ? 1 : 0;
    }
    if (differing * 200 > rays.values.size()) {
        return {Outcome::mismatched, "the engines differ on " + std::to_string(differing) + " rays"};
    }
    return {};
}

template <typename MakeSample>
Result bake(const MakeSample& make_sample, const Truth& truth, Random& random)
{
    try {
        return compare(make_sample(), truth, random);
    } catch (const InvalidArgument& refusal) {
        return {Outcome::refused, refusal.what()};
    } catch (const Error& refusal) {
        return {Outcome::refused, refusal.what()};
    }
}

// Rows of a table that the test prints: what was done, how it ended.
class Table {
public:
    explicit Table(const std::string& title)
    {
        std::printf("%-20s %7s %10s %7s\n", title.c_str(), "matched", "mismatched", "refused");
    }

    void add(const std::string& row, const Result& result)
    {
        counts_[static_cast<int>(result.outcome)] += 1;
        row_[static_cast<int>(result.outcome)] += 1;
        if (result.outcome != Outcome::matched) {
            notes_[result.what.substr(0, 70)] += 1;
        }
        name_ = row;
    }
    void end_row()
    {
        std::printf("%-20s %7d %10d %7d\n", name_.c_str(), row_[0], row_[1], row_[2]);
        for (const auto& [note, count] : notes_) {
            std::printf("    %d x %s\n", count, note.c_str());
        }
        std::fflush(stdout);
        row_[0] = row_[1] = row_[2] = 0;
        notes_.clear();
    }
    int count(Outcome outcome) const { return counts_[static_cast<int>(outcome)]; }
    double matched_share() const { return counts_[0] / double(counts_[0] + counts_[1] + counts_[2]); }

private:
    int counts_[3] = {0, 0, 0};
    int row_[3] = {0, 0, 0};
    std::string name_;
    std::map<std::string, int> notes_;
};

class BrokenSolids : public testing::TestWithParam<Solid> {};

TEST_P(BrokenSolids, BakeToTheirWindingNumber)
{
    Random random(20 + static_cast<std::uint32_t>(GetParam()));
    Table table(name_of(GetParam()));
    for (const Damage damage : all_damages) {
        for (int i = 0; i < of_each_kind; ++i) {
            const BrokenMesh one = broken(random_solid(GetParam(), random), damage, random);
            const Truth truth = [&](const glm::dvec3& p) {
                const double sum = balanced_winding(one.truth.positions, one.truth.triangles, one.aspect, p, 2);
                const double winding = std::abs(sum + 0.5 * one.covering);
                if (one.moved > 0.0 &&
                    brute_force_distance(one.truth.positions, one.truth.triangles, one.aspect, p, 1) < one.moved) {
                    return -1;
                }
                return std::abs(winding - 0.5) <= unclear ? -1 : winding > 0.5 ? 1 : 0;
            };
            table.add(name_of(damage), bake([&] { return one.mesh.sample(one.height, one.aspect); }, truth, random));
        }
        table.end_row();
    }
    EXPECT_GE(table.matched_share(), least_share);
}

// Inside a sheet of a thickness, outside of it, or too near its rim to tell.
int within_sheets(const Mesh& mesh, float aspect, float thickness, const glm::dvec3& p)
{
    const double away = brute_force_distance(mesh.positions, mesh.triangles, aspect, p, 1);
    if (away > 0.51 * thickness) {
        return 0;
    }
    std::vector<glm::uvec3> rims;
    for (const glm::uvec3& t : mesh.triangles) {
        rims.insert(rims.end(), {{t.x, t.y, t.y}, {t.y, t.z, t.z}, {t.z, t.x, t.x}});
    }
    const bool above_a_face = away < brute_force_distance(mesh.positions, rims, aspect, p, 1) - 1e-6;
    return above_a_face && away < 0.49 * thickness ? 1 : -1;
}

TEST(BrokenMeshes, SoupsOfAThickness)
{
    Random random(7);
    Table table("soup of");
    for (const int count : {1, 20, 150}) {
        for (int i = 0; i < soups / 3; ++i) {
            const float height = static_cast<float>(random.uniform(0.6, 0.9));
            const float aspect = static_cast<float>(random.uniform(0.8, 1.3));
            const Mesh soup = triangle_soup(count, count == 1 ? 0.4 : 0.15, height, aspect, random);
            SampleOptions options;
            options.thickness = static_cast<float>(random.uniform(0.03, 0.1));
            const auto sample = [&] { return Sample(soup.positions, soup.triangles, height, aspect, options); };
            const Truth truth = [&](const glm::dvec3& p) { return within_sheets(soup, aspect, options.thickness, p); };
            table.add(std::to_string(count), bake(sample, truth, random));
        }
        table.end_row();
    }
    EXPECT_GE(table.matched_share(), least_share);
}

TEST(BrokenMeshes, WhatIsNoMeshIsRefused)
{
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const auto any_vertex = [](Mesh& mesh, Random& r) -> glm::vec3& {
        return mesh.positions[static_cast<std::size_t>(r.below(static_cast<int>(mesh.positions.size())))];
    };
    const std::pair<const char*, std::function<void(Mesh&, Random&)>> ways[] = {
        {"not a number", [&](Mesh& mesh, Random& r) { any_vertex(mesh, r)[r.below(3)] = nan; }},
        {"infinite", [&](Mesh& mesh, Random& r) {
             any_vertex(mesh, r)[r.below(3)] = r.below(2) == 0 ? infinity : -infinity;
         }},
        {"no area", [](Mesh& mesh, Random& r) {
             for (glm::uvec3& t : mesh.triangles) {
                 t = glm::uvec3(t[r.below(3)]);
             }
         }},
        {"index out of range", [](Mesh& mesh, Random& r) {
             const auto beyond = static_cast<std::uint32_t>(r.uniform(0.0, 4e9));
             mesh.triangles[static_cast<std::size_t>(r.below(static_cast<int>(mesh.triangles.size())))][r.below(3)] =
                 static_cast<std::uint32_t>(mesh.positions.size()) + beyond;
         }},
        {"empty", [](Mesh& mesh, Random& r) { r.below(2) == 0 ? mesh.positions.clear() : mesh.triangles.clear(); }},
        {"huge coordinates", [&](Mesh& mesh, Random& r) {
             any_vertex(mesh, r)[r.below(3)] = static_cast<float>(std::pow(10.0, r.uniform(4.1, 38.0)));
         }}};
    Random random(8);
    Table table("no mesh");
    for (const auto& [name, spoil] : ways) {
        for (int i = 0; i < 10; ++i) {
            BrokenMesh one = random_solid(all_solids[i % 8], random);
            spoil(one.mesh, random);
            const Result result = bake([&] { return one.mesh.sample(one.height, one.aspect); },
                                       [](const glm::dvec3&) { return -1; }, random);
            EXPECT_EQ(result.outcome, Outcome::refused) << name;
            EXPECT_GT(result.what.size(), 20u) << result.what;
            EXPECT_NE(result.what.find("; "), std::string::npos) << "no remedy: " << result.what;
            table.add(name, result);
        }
        table.end_row();
    }
}

TEST(BrokenMeshes, SoupWithoutAThicknessEnclosesNothing)
{
    Random random(9);
    const Mesh soup = triangle_soup(60, 0.1, 0.6f, 1.0f, random);
    expect_refusal<InvalidArgument>([&] { soup.sample(0.6f); }, {"encloses nothing", "thickness"});
}

INSTANTIATE_TEST_SUITE_P(All, BrokenSolids, testing::ValuesIn(all_solids), [](const auto& param) {
    std::string name = name_of(param.param);
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

}  // namespace
}  // namespace mesoshell
