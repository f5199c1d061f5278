// The traversals `march` and `slices`, segment by segment and in a picture, against closed forms.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "camera.h"
#include "check.h"
#include "meshes.h"
#include "render_with.h"
#include "shader_text.h"

namespace mesoshell {
namespace {

constexpr int march_traversal = 3;
constexpr int slices_traversal = 4;

constexpr int side = 20;
constexpr float voxel = 1.0f / side;

// A tile as high as wide, its nodes a voxel apart on all axes, filled from a distance in voxels at a point in voxels.
Map map_of(const std::function<double(const glm::dvec3&)>& distance)
{
    Map map;
    map.height = 1.0f;
    map.sdf_nodes = glm::ivec3(side, side, side + 1);
    for (int z = 0; z <= side; ++z) {
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                map.sdf.push_back(static_cast<float>(distance({x, y, z}) * voxel));
            }
        }
    }
    return map;
}

// Solid below half a voxel above a layer of nodes: these hold 1 and those above them 0, so that the density is 1/2 - height
// in voxels, exactly, over the voxel around the plane.
constexpr double plane = 8.5;

Map plane_map(bool solid_below)
{
    return map_of([=](const glm::dvec3& p) { return solid_below ? p.z - plane : plane - p.z; });
}

shader::Tile tile_of_map(const Map& map)
{
    ShellParams params;
    params.sdf_nodes = glm::vec4(glm::vec3(map.sdf_nodes), 0.0f);
    params.tile = glm::vec4(map.height, map.aspect, 0.0f, 0.0f);
    return shader::tile_of(params);
}

struct Segment {
    glm::dvec3 entry;  // voxels
    glm::dvec3 exit;

    double length() const { return glm::length(exit - entry); }
    glm::dvec3 dir() const { return (exit - entry) / length(); }
};

shader::SegmentHit march(const Map& map, const Segment& segment)
{
    const MapVolumes volumes(map, MapVolumes::Parts::sdf_and_density);
    const shader::FetchScope scope(map, volumes);
    return shader::traverse_march(tile_of_map(map), glm::vec3(segment.entry) * voxel, glm::vec3(segment.exit) * voxel);
}

shader::SegmentHit slices(const Map& map, int layers, const glm::vec3& entry_texture, const glm::vec3& exit_texture)
{
    const MapVolumes volumes(map, MapVolumes::Parts::sdf_and_density);
    const shader::FetchScope scope(map, volumes);
    shader::Tolerance tolerance{};
    tolerance.slice_layers = layers;
    return shader::traverse_slices(tile_of_map(map), tolerance, entry_texture, exit_texture);
}

TEST(March, MeetsAHalfSpaceWithinAVoxel)
{
    const Map map = plane_map(true);
    Random random(1);
    int exact = 0;
    for (int i = 0; i < 2000; ++i) {
        const Segment segment{random.in_box({-30, -30, plane + 0.1}, {30, 30, side}),
                              random.in_box({-30, -30, 0}, {30, 30, plane - 1.1})};
        const double steepness = -segment.dir().z;
        const double truth = (segment.entry.z - plane) / steepness;
        const shader::SegmentHit hit = march(map, segment);
        ASSERT_TRUE(hit.hit);
        const double found = hit.along * segment.length();
        ASSERT_LT(std::abs(found - truth), 1.0);
        // Both samples around the surface lie where the density is linear.
        if (steepness <= 0.5) {
            exact += 1;
            ASSERT_NEAR(found, truth, 1e-4 / steepness);
        }
        // One sample at the entry, then one a voxel until the first that is below; a rounding may decide.
        const double doubt = std::abs(truth - std::round(truth)) < 1e-4 / steepness ? 1.0 : 0.0;
        ASSERT_NEAR(hit.fetches, 1.0 + std::ceil(truth), doubt);
    }
    EXPECT_GT(exact, 500);
}

TEST(March, FetchesOneSampleAVoxelWhereItMissesAndOneAtBothEnds)
{
    const Map map = plane_map(true);
    Random random(2);
    for (int i = 0; i < 500; ++i) {
        const Segment segment{random.in_box({-30, -30, plane + 0.1}, {30, 30, side}),
                              random.in_box({-30, -30, plane + 0.1}, {30, 30, side})};
        const shader::SegmentHit hit = march(map, segment);
        ASSERT_FALSE(hit.hit);
        const double length = segment.length();
        ASSERT_NEAR(hit.fetches, 1.0 + std::ceil(length), std::abs(length - std::round(length)) < 1e-4 ? 1.0 : 0.0);
    }
    // The last sample is at the exit, here barely in the solid.
    const shader::SegmentHit hit = march(map, {{3, 3, plane + 1.25}, {3, 3, plane - 0.01}});
    EXPECT_TRUE(hit.hit);
    EXPECT_EQ(hit.fetches, 3);
    EXPECT_GT(hit.along, 0.99f);
    EXPECT_EQ(march(map, {{3, 3, 12}, {3, 3, 12}}).fetches, 1);
}

TEST(March, StepsFollowTheNodesOfEachAxis)
{
    Map map;
    map.height = 0.3f;
    map.aspect = 2.0f;
    map.sdf_nodes = glm::ivec3(6, 9, 41);
    map.sdf.assign(6 * 9 * 41, 1.0f);
    const MapVolumes volumes(map, MapVolumes::Parts::sdf_and_density);
    const shader::FetchScope scope(map, volumes);
    Random random(8);
    for (int i = 0; i < 500; ++i) {
        const glm::dvec3 entry = random.in_box({-1, -1, 0}, {2, 2, 1});
        const glm::dvec3 exit = random.in_box({-1, -1, 0}, {2, 2, 1});
        const double steps = glm::length((exit - entry) * glm::dvec3(6, 9, 40));
        const shader::SegmentHit hit = shader::traverse_march(tile_of_map(map), glm::vec3(entry), glm::vec3(exit));
        ASSERT_FALSE(hit.hit);
        ASSERT_NEAR(hit.fetches, 1.0 + std::ceil(steps), std::abs(steps - std::round(steps)) < 1e-4 ? 1.0 : 0.0);
    }
}

TEST(March, HitsAtTheEntryWhereThatIsSolid)
{
    const Map map = plane_map(true);
    Random random(3);
    for (int i = 0; i < 100; ++i) {
        const Segment segment{random.in_box({-30, -30, 0}, {30, 30, plane - 0.01}),
                              random.in_box({-30, -30, 0}, {30, 30, side})};
        const shader::SegmentHit hit = march(map, segment);
        ASSERT_TRUE(hit.hit);
        ASSERT_EQ(hit.along, 0.0f);
        ASSERT_EQ(hit.fetches, 1);
    }
}

TEST(March, EndsOnSegmentsOfAnyLength)
{
    const Map map = plane_map(true);
    const glm::vec3 entry(0.5f, 0.5f, 0.9f);
    const MapVolumes volumes(map, MapVolumes::Parts::sdf_and_density);
    const shader::FetchScope scope(map, volumes);
    for (const float far : {1e6f, INFINITY, NAN}) {
        const shader::SegmentHit hit = shader::traverse_march(tile_of_map(map), entry, entry + glm::vec3(far, 0.0f, 0.0f));
        EXPECT_FALSE(hit.hit) << far;
        EXPECT_LE(hit.fetches, shader::MOST_MARCH_STEPS + 1) << far;
    }
}

// Where a segment enters a ball, in voxels along it, and how long it is inside; nothing where it misses.
struct Chord {
    double enter;
    double length;
};

std::optional<Chord> chord(const Segment& segment, const glm::dvec3& center, double radius)
{
    const glm::dvec3 dir = segment.dir();
    const double middle = glm::dot(center - segment.entry, dir);
    const double away = glm::length(segment.entry + middle * dir - center);
    if (away >= radius) {
        return std::nullopt;
    }
    const double half = std::sqrt(radius * radius - away * away);
    return Chord{middle - half, 2.0 * half};
}

TEST(March, MeetsABallWithinAVoxelWhereItsChordIsAVoxelLong)
{
    const glm::dvec3 center(10.2, 9.7, 10.4);
    const double radius = 6.3;
    // The density is 1/2 within a quarter of a voxel of the surface: it is interpolated between nodes, where it is clamped.
    const double doubt = 0.25;
    const Map map = map_of([=](const glm::dvec3& p) { return glm::length(p - center) - radius; });
    Random random(4);
    int hits = 0;
    int misses = 0;
    while (hits < 1000) {
        const Segment segment{random.in_box({0, 0, side}, {side, side, side}), random.in_box({0, 0, 0}, {side, side, 0})};
        const shader::SegmentHit hit = march(map, segment);
        const std::optional<Chord> outer = chord(segment, center, radius + doubt);
        const std::optional<Chord> inner = chord(segment, center, radius - doubt);
        if (!outer) {
            misses += 1;
            ASSERT_FALSE(hit.hit);
        } else if (inner && inner->length > 1.0) {
            hits += 1;
            ASSERT_TRUE(hit.hit);
            const double found = hit.along * segment.length();
            ASSERT_GT(found, outer->enter - 1e-4);
            ASSERT_LT(found, inner->enter + 1.0);
        }
    }
    EXPECT_GT(misses, 100);
}

TEST(Slices, MeetAHalfSpaceOnTheFirstLayerInIt)
{
    Random random(5);
    for (int i = 0; i < 2000; ++i) {
        const bool down = random.below(2) == 0;
        const int layers = 2 + random.below(60);
        const double spacing = static_cast<double>(side) / (layers - 1);
        const Map map = plane_map(down);
        const glm::dvec3 above = random.in_box({-30, -30, plane + 0.1}, {30, 30, side});
        const glm::dvec3 below = random.in_box({-30, -30, 0}, {30, 30, plane - 0.1});
        const Segment segment = down ? Segment{above, below} : Segment{below, above};
        // Layers in the order met: from the first at or after the entry to the last at or before the exit.
        const double start = segment.entry.z / spacing;
        const double end = segment.exit.z / spacing;
        const double first = down ? std::floor(start) : std::ceil(start);
        const double last = down ? std::ceil(end) : std::floor(end);
        const double solid = down ? std::floor(plane / spacing) : std::ceil(plane / spacing);
        const double nearest = std::min({std::abs(start - std::round(start)), std::abs(end - std::round(end)),
                                         std::abs(plane / spacing - std::round(plane / spacing))});
        if (nearest < 1e-4) {
            continue;  // a rounding decides
        }
        const shader::SegmentHit hit =
            slices(map, layers, glm::vec3(segment.entry) * voxel, glm::vec3(segment.exit) * voxel);
        const bool meets = down ? solid >= last : solid <= last;
        ASSERT_EQ(hit.hit, meets);
        const double asked = meets ? solid : last;
        ASSERT_EQ(hit.fetches, std::max(0.0, (down ? first - asked : asked - first) + 1.0));
        if (meets) {
            const double height = segment.entry.z + hit.along * (segment.exit.z - segment.entry.z);
            ASSERT_NEAR(height, solid * spacing, 1e-4);
            ASSERT_LT(std::abs(height - plane), spacing);
        }
    }
}

TEST(Slices, ConvergeToTheSurfaceAsLayersAreAdded)
{
    const glm::dvec3 center(10.2, 9.7, 10.4);
    const double radius = 6.3;
    const double doubt = 0.25;
    const Map map = map_of([=](const glm::dvec3& p) { return glm::length(p - center) - radius; });
    Random random(6);
    std::vector<double> worst;
    for (int layers = 9; layers <= 1025; layers = 2 * layers - 1) {
        const double spacing = static_cast<double>(side) / (layers - 1);
        worst.push_back(0.0);
        int met = 0;
        while (met < 300) {
            const Segment segment{random.in_box({0, 0, side}, {side, side, side}),
                                  random.in_box({0, 0, 0}, {side, side, 0})};
            const double steepness = -segment.dir().z;
            const std::optional<Chord> inner = chord(segment, center, radius - doubt);
            if (!inner || inner->length * steepness <= spacing) {
                continue;  // it may pass between two layers
            }
            met += 1;
            const shader::SegmentHit hit =
                slices(map, layers, glm::vec3(segment.entry) * voxel, glm::vec3(segment.exit) * voxel);
            ASSERT_TRUE(hit.hit);
            const double found = hit.along * segment.length();
            ASSERT_GT(found, chord(segment, center, radius + doubt)->enter - 1e-3);
            ASSERT_LT(found, inner->enter + spacing / steepness + 1e-3);
            worst.back() = std::max(worst.back(), found - inner->enter);
        }
    }
    EXPECT_GT(worst.front(), 1.0) << "so few layers are as good as many: the test sees nothing";
    EXPECT_LT(worst.back(), 0.1);
}

TEST(Slices, ASplitSegmentLosesNoLayer)
{
    const Map map = plane_map(true);
    Random random(7);
    for (int i = 0; i < 2000; ++i) {
        const int layers = 2 + random.below(40);
        const glm::vec3 entry = glm::vec3(random.in_box({-1, -1, 0}, {2, 2, 1}));
        const glm::vec3 exit = glm::vec3(random.in_box({-1, -1, 0}, {2, 2, 1}));
        glm::vec3 middle = glm::mix(entry, exit, static_cast<float>(random.uniform(0.0, 1.0)));
        if (i % 2 == 0) {
            // On a layer, as nearly as floats say it.
            middle.z = std::round(middle.z * static_cast<float>(layers - 1)) / static_cast<float>(layers - 1);
        }
        if ((middle.z - entry.z) * (exit.z - middle.z) <= 0.0f) {
            continue;
        }
        const shader::SegmentHit whole = slices(map, layers, entry, exit);
        const shader::SegmentHit near = slices(map, layers, entry, middle);
        const shader::SegmentHit far = slices(map, layers, middle, exit);
        ASSERT_EQ(whole.hit, near.hit || far.hit);
        if (!whole.hit) {
            ASSERT_GE(near.fetches + far.fetches, whole.fetches);
            ASSERT_LE(near.fetches + far.fetches, whole.fetches + 1);
        }
    }
}

TEST(Slices, NothingIsBetweenLayersOrAlongThem)
{
    const Map map = plane_map(true);
    const int layers = 11;  // two voxels apart
    // All of it in the solid.
    EXPECT_FALSE(slices(map, layers, {0.1f, 0.1f, 0.21f}, {3.9f, 0.7f, 0.29f}).hit);
    EXPECT_EQ(slices(map, layers, {0.1f, 0.1f, 0.21f}, {3.9f, 0.7f, 0.29f}).fetches, 0);
    EXPECT_FALSE(slices(map, layers, {0.1f, 0.1f, 0.2f}, {3.9f, 0.7f, 0.2f}).hit);
    // And just across one.
    EXPECT_TRUE(slices(map, layers, {0.1f, 0.1f, 0.21f}, {3.9f, 0.7f, 0.19f}).hit);
}

// A flat square seen from straight above, off the diagonals where two prisms meet: texture space is object space.
TEST(Slices, AreAsManyAsTheNodesInDepthUnlessTheSettingsSayOtherwise)
{
    const Map map = plane_map(true);
    const Shell shell = flat_grid(2, 2, 1.0f, 1.0f).shell(1.0f);
    const Camera camera(false, {0.52, 0.47, 3.0}, {0.52, 0.47, 0.0}, 0.4, {8, 8});
    for (const int layers : {0, 21, 6, 101}) {
        ShellParams params = settings(slices_traversal);
        params.tolerance.w = static_cast<float>(layers);
        const double spacing = 1.0 / ((layers == 0 ? side + 1 : layers) - 1);
        const int below = static_cast<int>(std::floor(plane * voxel / spacing + 1e-6));
        Job job;
        const Rendering picture = render(shell, map, camera.view(), params, job);
        for (std::size_t pixel = 0; pixel < picture.hit.size(); ++pixel) {
            ASSERT_EQ(picture.hit[pixel], 1);
            ASSERT_NEAR(picture.texture[pixel].z, below * spacing, 1e-5);
            ASSERT_EQ(picture.fetches[pixel], static_cast<int>(std::lround(1.0 / spacing)) - below + 1);
        }
    }
}

TEST(March, StepsTheSameInAPicture)
{
    const Map map = plane_map(true);
    const Shell shell = flat_grid(2, 2, 1.0f, 1.0f).shell(1.0f);
    // At 45 degrees through the top, into the middle of the square.
    const Camera camera(false, {-0.5, 0.5, 1.5}, {0.5, 0.5, 0.5}, 0.02, {8, 8});
    const Rendering picture = render_with(shell, map, camera.view(), march_traversal);
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) {
            const std::size_t pixel = static_cast<std::size_t>(y) * 8 + x;
            const CameraRay ray = camera.ray(x, y);
            ASSERT_EQ(picture.hit[pixel], 1);
            ASSERT_NEAR(picture.distance[pixel], (ray.origin.z - plane * voxel) / -ray.dir.z, voxel);
            ASSERT_GE(picture.fetches[pixel], std::floor((side - plane) / -ray.dir.z));
        }
    }
}

}  // namespace
}  // namespace mesoshell
