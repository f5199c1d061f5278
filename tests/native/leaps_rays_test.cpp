// The leap table: no ray is shorter than its bound, and bounds are no smaller than cells and voxels make them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "check.h"
#include "direction_bins.h"
#include "embree_scene.h"
#include "mesoshell/leaps.h"
#include "meshes.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

// Of a hit's distance, tile widths.
constexpr float rounding = 1e-6f;

Leaps bake(const Sample& sample, const LeapResolution& resolution = {}, int threads = 0)
{
    Job job(threads);
    return bake_leaps(sample, resolution, job);
}

// A closed three-sided rod.
Mesh strand(const glm::vec3& from, const glm::vec3& to, float radius)
{
    Mesh mesh;
    const glm::vec3 along = glm::normalize(to - from);
    const glm::vec3 other = std::abs(along.z) < 0.9f ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
    const glm::vec3 across = glm::normalize(glm::cross(along, other));
    for (const glm::vec3& end : {from, to}) {
        for (int i = 0; i < 3; ++i) {
            const float angle = 2.0943951f * static_cast<float>(i);
            const glm::vec3 out = std::cos(angle) * across + std::sin(angle) * glm::cross(along, across);
            mesh.positions.push_back(end + radius * out);
        }
    }
    mesh.triangles = {{0, 2, 1}, {3, 4, 5}};
    for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t next = (i + 1) % 3;
        mesh.triangles.insert(mesh.triangles.end(), {{i, next, next + 3}, {i, next + 3, i + 3}});
    }
    return mesh;
}

// Strands a twentieth of a cell thick that reach out of the tile on all sides.
Mesh strands(std::uint32_t seed, int count, const glm::vec3& box)
{
    Random random(seed);
    Mesh mesh;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 from(random.in_box({-0.2, -0.2, -0.1}, glm::dvec3(box) + 0.2));
        const glm::vec3 to(random.in_box({-0.2, -0.2, -0.1}, glm::dvec3(box) + 0.2));
        mesh = merged(mesh, strand(from, to, 0.0008f));
    }
    return mesh;
}

// Bars along u and along v from border to border and beyond, and balls between them; some overlap.
Mesh lattice(float aspect)
{
    Mesh mesh;
    for (int i = 0; i < 4; ++i) {
        const float share = 0.25f * static_cast<float>(i) + 0.1f;
        mesh = merged(mesh, strand({-0.1f, share * aspect, 0.1f}, {1.13f, share * aspect, 0.12f}, 0.02f));
        mesh = merged(mesh, strand({share, -0.1f, 0.35f}, {share, aspect + 0.07f, 0.31f}, 0.03f));
        mesh = merged(mesh, sphere({share, share * aspect, 0.22f + 0.03f * static_cast<float>(i)}, 0.11f, 7, 11));
    }
    return mesh;
}

struct Scene {
    explicit Scene(const Sample& sample)
        : sample(sample), rays(sample.positions(), sample.triangles(), lattice_within(sample, 1.1f)),
          crossings(sample.positions(), sample.triangles(), lattice_within(sample, 0.0f), TriangleScene::Use::crossings)
    {
    }

    glm::vec3 metric(const glm::vec3& pos_texture) const
    {
        return pos_texture * glm::vec3(1.0f, sample.aspect(), sample.height());
    }
    // The winding number is zero high above.
    bool inside(const glm::vec3& pos_texture) const
    {
        return crossings.count_crossings(metric(pos_texture), {0.0f, 0.0f, 1.0f}).winding != 0;
    }
    // Distances to the first surface within the slab; infinite where there is none.
    void cast(const glm::vec3& pos_texture, const glm::vec3 (&dirs)[16], float (&distances)[16]) const
    {
        const glm::vec3 origin = metric(pos_texture);
        alignas(64) std::int32_t valid[16];
        RayPacket16 packet{};
        for (int i = 0; i < 16; ++i) {
            valid[i] = -1;
            packet.org_x[i] = origin.x;
            packet.org_y[i] = origin.y;
            packet.org_z[i] = origin.z;
            packet.dir_x[i] = dirs[i].x;
            packet.dir_y[i] = dirs[i].y;
            packet.dir_z[i] = dirs[i].z;
            packet.tfar[i] = std::min(slab_exit(origin.z, dirs[i].z, sample.height()), 1.05f);
            packet.mask[i] = packet.geometry[i] = packet.instance[i] = ~0u;
        }
        rays.intersect16(valid, packet);
        for (int i = 0; i < 16; ++i) {
            distances[i] = packet.geometry[i] == ~0u ? std::numeric_limits<float>::infinity() : packet.tfar[i];
        }
    }

    const Sample& sample;
    TriangleScene rays;
    TriangleScene crossings;
};

// Where rays start: anywhere, or close before a surface, which is where bounds are easily too large.
glm::vec3 start_of_rays(const Sample& sample, bool close, Random& random)
{
    if (!close) {
        return glm::vec3(random.in_box(glm::dvec3(0.0), glm::dvec3(1.0)));
    }
    const int count = static_cast<int>(sample.triangles().size());
    const glm::uvec3& t = sample.triangles()[static_cast<std::size_t>(random.below(count))];
    const double u = random.uniform(0.0, 1.0);
    const double v = random.uniform(0.0, 1.0 - u);
    const glm::dvec3 a(sample.positions()[t.x]);
    const glm::dvec3 b(sample.positions()[t.y]);
    const glm::dvec3 c(sample.positions()[t.z]);
    const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    const glm::dvec3 point = a + u * (b - a) + v * (c - a) + normal * std::exp(random.uniform(-10.0, -2.0));
    return {glm::fract(point.x), glm::fract(point.y / sample.aspect()), std::clamp(point.z / sample.height(), 0.0, 1.0)};
}

// Casts some rays and counts those that a bound is too large for.
void expect_no_ray_is_shorter(const Sample& sample, const LeapResolution& resolution, int starts, std::uint32_t seed)
{
    const Leaps leaps = bake(sample, resolution);
    const Scene scene(sample);
    Random random(seed);
    std::size_t cast = 0;
    std::size_t hits = 0;
    std::size_t shorter = 0;
    std::size_t shorter_leaps = 0;
    double bounds = 0.0;
    for (int i = 0; i < starts; ++i) {
        const glm::vec3 start = start_of_rays(sample, i % 2 == 1, random);
        if (scene.inside(start)) {
            continue;
        }
        for (int packet = 0; packet < 4; ++packet) {
            glm::vec3 dirs[16];
            float distances[16];
            for (glm::vec3& dir : dirs) {
                dir = glm::vec3(random.direction());
            }
            scene.cast(start, dirs, distances);
            for (int lane = 0; lane < 16; ++lane) {
                const float bound = lookup_leap(leaps, start, dirs[lane]);
                bounds += bound;
                hits += std::isfinite(distances[lane]) ? 1 : 0;
                shorter += distances[lane] < bound - rounding ? 1 : 0;
                shorter_leaps += distances[lane] < leap_length(leaps, start, dirs[lane]) - rounding ? 1 : 0;
            }
            cast += 16;
        }
    }
    std::printf("%zu rays, %zu hits\n", cast, hits);
    EXPECT_EQ(shorter, 0u);
    EXPECT_EQ(shorter_leaps, 0u);
    EXPECT_GT(hits, cast / 20);
    EXPECT_GT(bounds / static_cast<double>(cast), 0.02);
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

// Ten million rays in all; fewer where a sanitizer makes each of them twenty times as slow.
int starts_of(int millions)
{
    if (sanitized) {
        std::printf("a sanitizer watches: %d of %d thousand rays\n", millions * 10, millions * 1000);
    }
    return millions * (sanitized ? 160 : 16000);
}

TEST(Leaps, NoRayIsShorterThanItsBoundAmongStrands)
{
    expect_no_ray_is_shorter(strands(1, 60, {1.0f, 1.0f, 0.4f}).sample(0.4f), {}, starts_of(4), 11);
}

TEST(Leaps, NoRayIsShorterThanItsBoundAmongStrandsOfAnotherGrid)
{
    expect_no_ray_is_shorter(strands(2, 30, {1.0f, 0.58f, 0.7f}).sample(0.7f, 0.58f), {{9, 17, 21}, 6}, starts_of(2), 12);
    expect_no_ray_is_shorter(strands(3, 30, {1.0f, 2.3f, 0.2f}).sample(0.2f, 2.3f), {{16, 12, 5}, 16}, starts_of(1), 13);
}

TEST(Leaps, NoRayIsShorterThanItsBoundInALattice)
{
    const Sample sample = lattice(0.8f).sample(0.45f, 0.8f);
    ASSERT_TRUE(sample.overlaps());
    ASSERT_TRUE(sample.winds_outward());
    expect_no_ray_is_shorter(sample, {}, starts_of(4), 14);
}

TEST(Leaps, NoRayIsShorterThanItsBoundWhereTheSlabClips)
{
    const Mesh mesh = merged(slab(-0.1f, 0.13f), sphere({0.4f, 0.3f, 0.35f}, 0.25f, 9, 14));
    expect_no_ray_is_shorter(mesh.sample(0.4f), {}, starts_of(2), 15);
}

TEST(Leaps, WithoutWindingOutwardNoRayIsShorterEither)
{
    // A ball whose lower part is turned inside out through its own waist: rays from outside meet backs there.
    Mesh mesh = sphere({0.5f, 0.5f, 0.25f}, 0.2f, 14, 18);
    for (glm::vec3& p : mesh.positions) {
        p.x = 0.5f + (p.x - 0.5f) * (p.z - 0.17f) * 8.0f;
    }
    const Sample sample = mesh.sample(0.5f);
    ASSERT_FALSE(sample.winds_outward());
    expect_no_ray_is_shorter(sample, {}, starts_of(1), 16);
}

// The vector of a box nearest to zero among those of a bin's cone, by Dykstra's alternating projections onto half-spaces
// (Boyle and Dykstra 1986); infinite where they have nothing in common.
double nearest_of_cone(const BinCone& cone, const glm::dvec3& lower, const glm::dvec3& upper)
{
    struct Half {
        glm::dvec3 normal;  // unit length; the half-space is normal . x >= offset
        double offset;
        glm::dvec3 moved{0.0};
    };
    std::vector<Half> halves;
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 up(0.0);
        up[axis] = 1.0;
        halves.push_back({up, lower[axis]});
        halves.push_back({-up, -upper[axis]});
    }
    const auto& corners = cone.corners();
    for (int i = 0; i < 4; ++i) {
        const glm::dvec3 normal = glm::normalize(glm::cross(corners[i], corners[(i + 1) % 4]));
        halves.push_back({glm::dot(normal, corners[(i + 2) % 4]) < 0.0 ? -normal : normal, 0.0});
    }
    glm::dvec3 x(0.0);
    double off = 1.0;
    for (int round = 0; round < 2000 && off > 1e-7; ++round) {
        off = 0.0;
        for (Half& half : halves) {
            const glm::dvec3 y = x + half.moved;
            const double missing = half.offset - glm::dot(half.normal, y);
            off = std::max(off, half.offset - glm::dot(half.normal, x));
            x = y + std::max(missing, 0.0) * half.normal;
            half.moved = y - x;
        }
    }
    return off > 1e-5 ? std::numeric_limits<double>::infinity() : glm::length(x);
}

// The shortest ray from a cell, in a bin, that ends in one of the points or a copy of one. What lies in the way of such a
// ray would end it sooner, so that nobody has to look.
double shortest_ray(const Leaps& leaps, const glm::vec3& corner, int bin, const std::vector<glm::vec3>& points)
{
    const glm::dvec3 scale(1.0, leaps.aspect, leaps.height);
    const glm::dvec3 side = scale / glm::dvec3(leaps.cells);
    const BinCone cone(bin, leaps.directions);
    double shortest = 255.0 * leap_unit;
    for (const glm::vec3& point : points) {
        const double above = point.z - corner.z * side.z;
        if (above > shortest + side.z || above < -shortest) {
            continue;
        }
        for (int copy = 0; copy < 9; ++copy) {
            const glm::dvec3 end = glm::dvec3(point) + glm::dvec3(copy % 3 - 1, copy / 3 - 1, 0) * scale;
            const glm::dvec3 upper = end - glm::dvec3(corner) * side;
            const glm::dvec3 lower = upper - side;
            if (glm::length(glm::clamp(glm::dvec3(0.0), lower, upper)) < shortest && !cone.misses({lower, upper})) {
                shortest = std::min(shortest, nearest_of_cone(cone, lower, upper));
            }
        }
    }
    return shortest;
}

// Of the surface within the slab and the tile.
std::vector<glm::vec3> points_of_surface(const Sample& sample, int count, Random& random)
{
    std::vector<double> areas{0.0};
    for (const glm::uvec3& t : sample.slab_triangles()) {
        const std::vector<glm::vec3>& p = sample.slab_positions();
        areas.push_back(areas.back() + glm::length(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x])));
    }
    std::vector<glm::vec3> points;
    for (int i = 0; i < count; ++i) {
        const auto found = std::upper_bound(areas.begin(), areas.end(), random.uniform(0.0, areas.back()));
        const glm::uvec3& t = sample.slab_triangles()[static_cast<std::size_t>(found - areas.begin()) - 1];
        const double u = std::sqrt(random.uniform(0.0, 1.0));
        const double v = random.uniform(0.0, 1.0);
        const glm::vec3 weights(1.0 - u, u * (1.0 - v), u * v);
        glm::vec3 point(0.0f);
        for (int corner = 0; corner < 3; ++corner) {
            point += weights[corner] * sample.slab_positions()[t[corner]];
        }
        points.emplace_back(glm::fract(point.x), sample.aspect() * glm::fract(point.y / sample.aspect()), point.z);
    }
    return points;
}

// How near bounds are to what they bound, in cells that touch no surface. What is missing is a voxel, a quarter of a cell,
// and half a unit.
void expect_tight(const Sample& sample, double least, std::uint32_t seed)
{
    if (sanitized) {
        GTEST_SKIP() << "a sanitizer would take minutes, and bounds are the same without it";
    }
    const Leaps leaps = bake(sample);
    const Scene scene(sample);
    const glm::vec3 cells(leaps.cells);
    Random random(seed);
    const std::vector<glm::vec3> points = points_of_surface(sample, 400000, random);
    double bounds = 0.0;
    double shortest_rays = 0.0;
    std::vector<double> ratios;
    while (ratios.size() < 120) {
        const glm::vec3 corner(random.below(leaps.cells.x), random.below(leaps.cells.y), random.below(leaps.cells.z));
        const glm::vec3 toward(random.direction());
        const glm::vec3 middle = (corner + 0.5f) / cells;
        const float diagonal = glm::length(scene.metric(1.0f / cells));
        if (scene.inside(middle) || scene.rays.distance(scene.metric(middle), 1.0f) < 0.5f * diagonal) {
            continue;
        }
        const double shortest = shortest_ray(leaps, corner, octahedral_bin(toward, leaps.directions), points);
        const double bound = lookup_leap(leaps, middle, toward);
        ASSERT_LE(bound, shortest + rounding);
        bounds += bound;
        shortest_rays += shortest;
        ratios.push_back(bound / shortest);
    }
    std::nth_element(ratios.begin(), ratios.begin() + 60, ratios.end());
    std::printf("bounds are %.3f of the shortest ray found, %.3f in the median\n", bounds / shortest_rays, ratios[60]);
    EXPECT_GT(bounds / shortest_rays, least);
    EXPECT_GT(ratios[60], least);
}

TEST(Leaps, TightAmongStrands)
{
    expect_tight(strands(1, 60, {1.0f, 1.0f, 0.4f}).sample(0.4f), 0.78, 21);
}

TEST(Leaps, TightInALattice)
{
    expect_tight(lattice(0.8f).sample(0.45f, 0.8f), 0.85, 22);
}

}  // namespace
}  // namespace mesoshell
