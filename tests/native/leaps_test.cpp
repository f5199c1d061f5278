// The leap table against closed forms, the bins of directions, and what must not change it.
#include <algorithm>
#include <cmath>

#include "check.h"
#include "direction_bins.h"
#include "mesoshell/leaps.h"
#include "meshes.h"

namespace mesoshell {
namespace {

Leaps bake(const Sample& sample, const LeapResolution& resolution = {}, int threads = 0)
{
    Job job(threads);
    return bake_leaps(sample, resolution, job);
}

TEST(DirectionBins, ACornerOfEveryBinWhereTheSquareIsCut)
{
    EXPECT_EQ(octahedral_bin({1.0f, 1.0f, 9.0f}, 2), 3);
    EXPECT_EQ(octahedral_bin({-1.0f, 1.0f, -9.0f}, 2), 2);
    EXPECT_EQ(octahedral_bin({-0.1f, -0.1f, -9.0f}, 8), 0);
    EXPECT_EQ(octahedral_bin({0.1f, 0.2f, 3.0f}, 8), 4 * 8 + 4);
    EXPECT_EQ(octahedral_bin({9.0f, 0.1f, 0.2f}, 8), 4 * 8 + 7);
    EXPECT_EQ(octahedral_bin({9.0f, 0.1f, -0.2f}, 8), 4 * 8 + 7);
}

TEST(DirectionBins, ADirectionIsInTheConeOfItsBinAlone)
{
    Random random(3);
    for (int side = 2; side <= 16; side += 2) {
        std::vector<BinCone> cones;
        for (int bin = 0; bin < side * side; ++bin) {
            cones.emplace_back(bin, side);
        }
        int shared = 0;
        for (int i = 0; i < 2000; ++i) {
            const glm::dvec3 dir = random.direction();
            const int bin = octahedral_bin(glm::vec3(dir), side);
            int found = 0;
            for (int other = 0; other < side * side; ++other) {
                found += cones[other].misses({dir, dir}) ? 0 : 1;
            }
            ASSERT_FALSE(cones[bin].misses({dir, dir})) << side << " " << bin;
            shared += found - 1;
        }
        // Only within some 1e-5 of an edge.
        EXPECT_LE(shared, 10);
    }
}

TEST(DirectionBins, DistanceOfABoxIsBelowThatOfEveryVectorOfTheCone)
{
    Random random(4);
    for (int i = 0; i < 200; ++i) {
        const int side = 2 + 2 * random.below(8);
        const glm::dvec3 lower = random.in_box(glm::dvec3(-0.5), glm::dvec3(0.4));
        const Bounds box{lower, lower + random.in_box(glm::dvec3(0.0), glm::dvec3(0.3))};
        std::vector<double> nearest(static_cast<std::size_t>(side) * side, 1.0);
        for (int j = 0; j < 2000; ++j) {
            const glm::dvec3 end = random.in_box(box.lower, box.upper);
            double& of_bin = nearest[static_cast<std::size_t>(octahedral_bin(glm::vec3(end), side))];
            of_bin = std::min(of_bin, glm::length(end));
        }
        for (int bin = 0; bin < side * side; ++bin) {
            ASSERT_LE(BinCone(bin, side).distance(box, 1.0), nearest[static_cast<std::size_t>(bin)]);
        }
    }
}

TEST(DirectionBins, FacingBinsAreThoseWithADirectionAgainstTheNormal)
{
    Random random(5);
    const int side = 8;
    const FacingBins facing(side);
    for (int i = 0; i < 50; ++i) {
        const glm::dvec3 normal = random.direction();
        std::vector<double> least(side * side, 1.0);
        for (int j = 0; j < 40000; ++j) {
            const glm::dvec3 dir = random.direction();
            double& of_bin = least[static_cast<std::size_t>(octahedral_bin(glm::vec3(dir), side))];
            of_bin = std::min(of_bin, glm::dot(dir, normal));
        }
        BinSet bins(side);
        facing.facing(1e-9 * normal, bins);
        for (int bin = 0; bin < side * side; ++bin) {
            const bool faces = (bins.words[0] >> bin & 1) != 0;
            if (least[static_cast<std::size_t>(bin)] < 0.0) {
                ASSERT_TRUE(faces);
            } else if (least[static_cast<std::size_t>(bin)] > 0.1) {
                ASSERT_FALSE(faces);
            }
        }
    }
}

// Of very many directions of a bin: the largest |dir.z|, and whether all go up, or down.
struct Slope {
    double steepest = 0.0;
    bool down = true;
    bool up = true;
};

std::vector<Slope> slopes_of_bins(int side)
{
    std::vector<Slope> slopes(static_cast<std::size_t>(side) * side);
    const int steps = 64;
    for (int bin = 0; bin < side * side; ++bin) {
        Slope& slope = slopes[static_cast<std::size_t>(bin)];
        for (int i = 0; i <= steps; ++i) {
            for (int j = 0; j <= steps; ++j) {
                const double z = octahedral_node(bin % side * steps + i, bin / side * steps + j, steps * side).z;
                slope.steepest = std::max(slope.steepest, std::abs(z));
                slope.down = slope.down && z <= 0.0;
                slope.up = slope.up && z >= 0.0;
            }
        }
    }
    return slopes;
}

// Of the rays from a cell below or above a plane, toward it: the distance of the nearest corner over the steepest cosine,
// less what a voxel and the unit take.
void check_planes(float below, float above, float height, float aspect, const LeapResolution& resolution)
{
    const Leaps leaps = bake(slab(below, above, aspect).sample(height, aspect), resolution);
    const std::vector<Slope> slopes = slopes_of_bins(resolution.directions);
    const double layer = double(height) / resolution.cells.z;
    int checked = 0;
    for (int z = 0; z < resolution.cells.z; ++z) {
        const double lower = layer * z;
        const double gap = std::max(lower - above, below - (lower + layer));
        if (gap < 0.0) {
            continue;
        }
        for (int bin = 0; bin < resolution.directions * resolution.directions; ++bin) {
            const Slope& slope = slopes[static_cast<std::size_t>(bin)];
            const bool away = lower > above ? slope.up : slope.down;
            const bool toward = lower > above ? slope.down : slope.up;
            for (int i = 0; i < resolution.cells.x * resolution.cells.y; ++i) {
                const double bound = leap_unit * leaps.values[leaps.index(bin, {0, 0, z}) + static_cast<std::size_t>(i)];
                if (away) {
                    ASSERT_EQ(bound, 255 * leap_unit);
                } else if (toward) {
                    const double distance = std::min(gap / slope.steepest, 255.0 * leap_unit);
                    const double lost = 0.25 * layer / slope.steepest + leap_unit + 1e-3 * distance;
                    ASSERT_LE(bound, distance + 1e-6) << "layer " << z << " bin " << bin;
                    ASSERT_GE(bound, distance - lost) << "layer " << z << " bin " << bin;
                    checked += 1;
                }
            }
        }
    }
    EXPECT_GT(checked, 500);
}

TEST(Leaps, Planes)
{
    check_planes(0.21f, 0.33f, 0.8f, 1.0f, {});
    check_planes(0.1f, 0.2f, 0.6f, 0.7f, {{5, 3, 23}, 4});
    check_planes(0.5f, 0.55f, 1.4f, 1.0f, {{4, 4, 16}, 16});
}

TEST(Leaps, CellsOnASurfaceLookAwayFromIt)
{
    // The plane at 0.33 lies in the layer [0.3, 0.35]: nothing bounds a ray from above it that goes up.
    const Leaps leaps = bake(slab(-1.0f, 0.33f).sample(0.8f), {{4, 4, 16}, 8});
    EXPECT_EQ(lookup_leap(leaps, {0.5f, 0.5f, 0.33f / 0.8f}, {0.1f, 0.1f, 1.0f}), 255 * leap_unit);
    EXPECT_EQ(lookup_leap(leaps, {0.5f, 0.5f, 0.33f / 0.8f}, {0.1f, 0.1f, -1.0f}), 0.0f);
}

TEST(Leaps, ThreadsChangeNothing)
{
    const Mesh mesh = merged(sphere({0.3f, 0.4f, 0.2f}, 0.17f, 9, 13), sphere({0.8f, 0.7f, 0.3f}, 0.15f, 8, 11));
    const Sample sample = mesh.sample(0.5f, 0.9f);
    const LeapResolution resolution{{16, 14, 9}, 10};
    const Leaps alone = bake(sample, resolution, 1);
    for (const int threads : {2, 3, 0}) {
        EXPECT_EQ(bake(sample, resolution, threads).values, alone.values);
    }
}

TEST(Leaps, WholePeriodsChangeNothing)
{
    const Mesh mesh = snapped(sphere({0.3f, 0.4f, 0.2f}, 0.17f, 9, 13));
    const Leaps here = bake(mesh.sample(0.5f, 0.75f), {{8, 8, 8}, 8});
    const Leaps there = bake(moved(mesh, {3.0f, -5 * 0.75f, 0.0f}).sample(0.5f, 0.75f), {{8, 8, 8}, 8});
    EXPECT_EQ(there.values, here.values);
}

TEST(Leaps, MovedByCellsTheTableMovesAlong)
{
    const Mesh mesh = snapped(sphere({0.3f, 0.4f, 0.2f}, 0.17f, 9, 13));
    const LeapResolution resolution{{8, 8, 4}, 8};
    const Leaps here = bake(mesh.sample(0.5f), resolution);
    const Leaps there = bake(moved(mesh, {0.25f, 0.875f, 0.0f}).sample(0.5f), resolution);
    for (int bin = 0; bin < 64; ++bin) {
        for (int i = 0; i < 256; ++i) {
            const glm::ivec3 cell(i % 8, i / 8 % 8, i / 64);
            const glm::ivec3 moved_cell((cell.x + 2) % 8, (cell.y + 7) % 8, cell.z);
            ASSERT_EQ(there.values[there.index(bin, moved_cell)], here.values[here.index(bin, cell)]);
        }
    }
}

TEST(Leaps, BoundsEndWhereCellsAreNarrow)
{
    // 128 cells of 1/1280 tile widths along v.
    const Leaps leaps = bake(slab(0.01f, 0.02f, 0.0625f).sample(0.1f, 0.0625f), {{4, 64, 4}, 4});
    EXPECT_EQ(*std::max_element(leaps.values.begin(), leaps.values.end()), 128 * 0.0625 / 64 * 256);
}

TEST(Leaps, LookupIsPeriodicAndClamped)
{
    const Leaps leaps = bake(sphere({0.3f, 0.4f, 0.2f}, 0.17f, 9, 13).sample(0.5f), {{8, 8, 8}, 4});
    const glm::vec3 dir(0.3f, -0.2f, -0.7f);
    const float bound = lookup_leap(leaps, {0.85f, 0.4f, 0.99f}, dir);
    EXPECT_GT(bound, 0.0f);
    EXPECT_EQ(lookup_leap(leaps, {-2.15f, 5.4f, 0.99f}, dir), bound);
    EXPECT_EQ(lookup_leap(leaps, {0.85f, 0.4f, 1.5f}, dir), bound);
    EXPECT_EQ(lookup_leap(leaps, {0.85f, 0.4f, 0.99f}, 5.0f * dir), bound);
}

TEST(Leaps, ALeapIsTheWayOutOfTheCellAndTheBound)
{
    // Cells are 1/4 x 1/4 x 1/8; the ball is far below.
    const Leaps leaps = bake(sphere({0.3f, 0.4f, 0.1f}, 0.05f, 9, 13).sample(0.5f), {{4, 4, 4}, 4});
    const auto leap = [&](const glm::vec3& pos, const glm::vec3& dir) {
        return leap_length(leaps, pos, glm::normalize(dir)) - lookup_leap(leaps, pos, dir);
    };
    EXPECT_NEAR(leap({0.30f, 0.30f, 0.80f}, {1, 0, 0}), 0.20f, 1e-6f);
    EXPECT_NEAR(leap({0.30f, 0.30f, 0.80f}, {-1, 0, 0}), 0.05f, 1e-6f);
    EXPECT_NEAR(leap({0.30f, 0.30f, 0.80f}, {0, 0, 1}), 0.10f, 1e-6f);
    EXPECT_NEAR(leap({-0.70f, 2.30f, 0.80f}, {1, 0, 1}), std::sqrt(2.0f) * 0.10f, 1e-6f);
    EXPECT_NEAR(leap({0.30f, 0.30f, 1.00f}, {0, 0, -1}), 0.125f, 1e-6f);
    EXPECT_EQ(leap_length(leaps, {0.3f, 0.4f, 0.21f}, {0, 0, -1}), 0.0f);
    EXPECT_EQ(leap_lengths(leaps, std::vector<glm::vec3>{{0.3f, 0.3f, 0.8f}}, std::vector<glm::vec3>{{7, 0, 0}})[0],
              leap_length(leaps, {0.3f, 0.3f, 0.8f}, {1, 0, 0}));
    const std::vector<glm::vec3> one(1, glm::vec3(0.5f));
    expect_refusal<InvalidArgument>([&] { leap_lengths(leaps, one, {}); }, {"1 positions", "0 directions"});
    expect_refusal<InvalidArgument>([&] { leap_lengths(leaps, one, std::vector<glm::vec3>(1)); }, {"ray 0"});
}

TEST(Leaps, ResolutionOutOfRange)
{
    const Sample sample = slab(0.1f, 0.2f).sample(0.7f);
    for (int axis = 0; axis < 3; ++axis) {
        for (const int bad : {0, -1, 65}) {
            LeapResolution resolution;
            resolution.cells[axis] = bad;
            expect_refusal<InvalidArgument>([&] { bake(sample, resolution); }, {"leap table", "1 to 64"});
        }
    }
    for (const int bad : {0, -2, 1, 7, 18}) {
        expect_refusal<InvalidArgument>([&] { bake(sample, {{4, 4, 4}, bad}); }, {"octahedral", "2 to 16"});
    }
}

}  // namespace
}  // namespace mesoshell
