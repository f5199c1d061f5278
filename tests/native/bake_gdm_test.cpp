// The raw GDM against closed forms: what every node must hold, on the grid and anywhere (the solids, not the nodes, are
// moved to random places, and the resolutions are odd).
//
// Rounding: single-precision coordinates as far as horizon_distance + 1 from the origin err by 2^-20, a ray's direction
// by 2^-24 of its length of up to 16. `slack` is four times their sum: by so much the surface may seem to be displaced.
// Along the ray that is slack over the cosine of incidence.
#include <algorithm>
#include <cmath>

#include "ball_lattice.h"
#include "check.h"
#include "mesoshell/bake.h"
#include "meshes.h"

namespace mesoshell {
namespace {

constexpr double slack = 4.0 * (0x1p-20 + 16 * 0x1p-24);

GdmResolution resolution(const glm::ivec3& nodes, int ntheta, int nphi)
{
    GdmResolution r;
    r.nodes = nodes;
    r.ntheta = ntheta;
    r.nphi = nphi;
    return r;
}

Gdm bake(const Sample& sample, const GdmResolution& r)
{
    Job job;
    return bake_gdm(sample, r, job);
}

// Calls check(node's place in metric texture space, direction, baked distance) for every value.
template <typename Check>
void for_each_ray(const Gdm& gdm, const Check& check)
{
    const GdmResolution& r = gdm.resolution;
    for (int phi = 0; phi < r.nphi; ++phi) {
        for (int theta = 0; theta < r.ntheta; ++theta) {
            // Written out once more here, from the words of docs/architecture.md.
            const double polar = 3.14159265358979324 * theta / (r.ntheta - 1);
            const double azimuth = 2.0 * 3.14159265358979324 * phi / r.nphi;
            const glm::dvec3 dir(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                                 std::cos(polar));
            for (int z = 0; z < r.nodes.z; ++z) {
                for (int y = 0; y < r.nodes.y; ++y) {
                    for (int x = 0; x < r.nodes.x; ++x) {
                        const glm::dvec3 node(double(x) / r.nodes.x, gdm.aspect * double(y) / r.nodes.y,
                                              gdm.height * double(z) / (r.nodes.z - 1));
                        check(node, dir, static_cast<double>(gdm.values[gdm.index(phi, y, x, theta, z)]));
                    }
                }
            }
        }
    }
}

TEST(GdmDirection, PolesAndQuarters)
{
    const GdmResolution r = resolution({2, 2, 2}, 5, 4);
    const auto expect_near = [](const glm::dvec3& a, const glm::dvec3& b) { EXPECT_LT(glm::length(a - b), 1e-15); };
    expect_near(gdm_direction(r, 0, 3), {0, 0, 1});
    expect_near(gdm_direction(r, 4, 1), {0, 0, -1});
    expect_near(gdm_direction(r, 2, 0), {1, 0, 0});
    expect_near(gdm_direction(r, 2, 1), {0, 1, 0});
    expect_near(gdm_direction(r, 1, 2), {-std::sqrt(0.5), 0, std::sqrt(0.5)});
}

void check_slab(const GdmResolution& r, float aspect)
{
    const double height = 0.7f;
    const double below = 0.2137f;
    const double above = 0.4391f;
    const Gdm gdm = bake(slab(0.2137f, 0.4391f, aspect).sample(0.7f, aspect), r);
    ASSERT_EQ(gdm.values.size(), std::size_t(r.nodes.x) * r.nodes.y * r.nodes.z * r.ntheta * r.nphi);
    std::uint64_t outside = 0;
    for_each_ray(gdm, [&](const glm::dvec3& node, const glm::dvec3& dir, double baked) {
        double exact = slab_end(node.z, dir.z, height);
        if (node.z >= below && node.z <= above) {
            exact = 0.0;
        } else if (node.z > above && dir.z < -1e-9) {
            exact = std::min(exact, (node.z - above) / -dir.z);
        } else if (node.z < below && dir.z > 1e-9) {
            exact = std::min(exact, (below - node.z) / dir.z);
        }
        ASSERT_NEAR(baked, exact, std::min(1e-5, slack / std::max(std::abs(dir.z), 1e-9)))
            << "z " << node.z << " direction z " << dir.z;
        // A ray that would leave the slab where it starts is not cast.
        outside += (node.z < below || node.z > above) && slab_end(node.z, dir.z, height) > 0.0 ? 1 : 0;
    });
    EXPECT_EQ(gdm.ray_count, outside);
}

TEST(BakeGdm, Slab)
{
    check_slab(resolution({8, 4, 6}, 16, 8), 1.0f);
}

TEST(BakeGdm, SlabWithOddNumbersAndAnAspect)
{
    check_slab(resolution({7, 11, 5}, 5, 13), 1.625f);
    check_slab(resolution({5, 3, 9}, 7, 1), 0.4f);
}

TEST(BakeGdm, SmallestGrid)
{
    check_slab(resolution({2, 2, 2}, 2, 1), 1.0f);
}

TEST(BakeGdm, HorizontalRaysEndAtTheHorizon)
{
    // ntheta = 7 has a node at 90 degrees: such a ray stays at its height for ever.
    const Gdm gdm = bake(slab(0.1f, 0.2f).sample(0.7f), resolution({3, 3, 4}, 7, 6));
    int horizontal = 0;
    for_each_ray(gdm, [&](const glm::dvec3& node, const glm::dvec3& dir, double baked) {
        if (std::abs(dir.z) < 1e-9) {
            EXPECT_EQ(baked, node.z == 0.0 || node.z > 0.2 ? horizon_distance : 0.0f);
            horizontal += 1;
        }
    });
    EXPECT_EQ(horizontal, 3 * 3 * 4 * 6);
}

TEST(BakeGdm, NearlyHorizontalRaysEndAtTheHorizon)
{
    // At 64 polar nodes the flattest rays climb by cos(pi/2 - pi/126) = 0.0249: out of a tile of height 0.7 after 28.
    const Gdm gdm = bake(slab(0.1f, 0.2f).sample(0.7f), resolution({2, 2, 8}, 64, 1));
    EXPECT_EQ(gdm.values[gdm.index(0, 0, 0, 31, 3)], horizon_distance);  // upward from z = 0.3
    EXPECT_EQ(*std::max_element(gdm.values.begin(), gdm.values.end()), horizon_distance);
}

// A roof with walls: first hit by intersecting the profile's segments, period by period.
void check_sawtooth(const GdmResolution& r, float aspect, float start)
{
    const float floor = 0.1031f;
    const float low = 0.2217f;
    const float high = 0.5409f;
    const float height = 0.75f;
    const Gdm gdm = bake(sawtooth(floor, low, high, start, aspect).sample(height, aspect), r);
    const double slope = double(high) - double(low);
    int hits_of_roof = 0;
    int hits_of_wall = 0;
    for_each_ray(gdm, [&](const glm::dvec3& node, const glm::dvec3& dir, double baked) {
        const double end = slab_end(node.z, dir.z, height);
        double first = end;
        double cosine = std::max(std::abs(dir.z), 0.01);
        const auto hit = [&](double t, bool facing, double incidence) {
            if (facing && t >= 0.0 && t < first) {
                first = t;
                cosine = incidence;
                return true;
            }
            return false;
        };
        double in_period = node.x - start;
        in_period -= std::floor(in_period);
        const double roof = low + slope * in_period;
        bool uncertain = std::abs(node.z - roof) < slack || std::abs(node.z - floor) < slack;
        if (node.z > floor && node.z < roof) {
            first = 0.0;
        } else {
            bool wall = false;
            const bool floor_hit = hit((floor - node.z) / dir.z, dir.z > 1e-9, std::abs(dir.z));
            for (int period = -20; period <= 20; ++period) {
                const double x0 = start + period;
                // The roof of one period: z = low + slope (x - x0).
                const double along = dir.z - slope * dir.x;
                const double t = (low + slope * (node.x - x0) - node.z) / along;
                const double x = node.x + dir.x * t - x0;
                const double incidence = std::abs(along) / std::hypot(1.0, slope);
                if (x > -slack / incidence && x < 1.0 + slack / incidence && t >= 0.0 && t <= first &&
                    (x < slack / incidence || x > 1.0 - slack / incidence)) {
                    uncertain = true;  // it meets an edge of the roof, which rounding may move
                }
                if (x >= 0.0 && x <= 1.0 && hit(t, along < 0.0, incidence)) {
                    wall = false;
                }
                // The wall at the end of the period faces +x.
                const double t_wall = (x0 + 1.0 - node.x) / dir.x;
                const double z_wall = node.z + dir.z * t_wall;
                if (dir.x < -1e-9 && z_wall >= low && z_wall <= high && hit(t_wall, true, std::abs(dir.x))) {
                    wall = true;
                }
            }
            hits_of_wall += wall ? 1 : 0;
            hits_of_roof += !wall && !floor_hit && first < end ? 1 : 0;
        }
        if (!uncertain) {
            ASSERT_NEAR(baked, first, slack / cosine)
                << "x " << node.x << " z " << node.z << " dir " << dir.x << " " << dir.z;
        }
    });
    EXPECT_GT(hits_of_roof, 50);
    EXPECT_GT(hits_of_wall, 20);
}

TEST(BakeGdm, TiltedRoofWithWalls)
{
    check_sawtooth(resolution({8, 4, 8}, 16, 8), 1.0f, 0.061f);
}

TEST(BakeGdm, TiltedRoofAtRandomPlaces)
{
    Random random(7);
    for (int i = 0; i < 6; ++i) {
        const float aspect = static_cast<float>(random.uniform(0.3, 2.0));
        const float start = static_cast<float>(random.uniform(-1.5, 1.5));
        check_sawtooth(resolution({7, 3, 11}, i % 2 == 0 ? 5 : 10, i % 2 == 0 ? 13 : 6), aspect, start);
    }
}

struct BallCase {
    glm::vec3 center;
    float radius;
    float height;
    float aspect;
    GdmResolution r;
};

// Between the lattice of the balls around the polyhedra and that of the balls inside them.
void check_balls(const BallCase& c)
{
    const Mesh mesh = sphere(c.center, c.radius, 48, 96);
    const glm::dvec3 center(c.center);
    const BallLattice around{center, outer_radius(mesh, center) + slack, c.height, c.aspect};
    const BallLattice within{center, inner_radius(mesh, center) - slack, c.height, c.aspect};
    const Gdm gdm = bake(mesh.sample(c.height, c.aspect), c.r);
    std::size_t rays = 0;
    std::size_t hits = 0;
    std::size_t grazing = 0;
    for_each_ray(gdm, [&](const glm::dvec3& node, const glm::dvec3& dir, double baked) {
        const double end = slab_end(node.z, dir.z, c.height);
        const double soonest = around.cast(node, dir);
        const double latest = within.cast(node, dir);
        // A ray that passes through the thin layer between both balls but not through the inner one may hit or not:
        // nothing else excuses a disagreement about a hit.
        ASSERT_GE(baked, soonest - slack) << "from " << node.x << " " << node.y << " " << node.z;
        ASSERT_LE(baked, latest + slack) << "from " << node.x << " " << node.y << " " << node.z;
        rays += 1;
        hits += latest < end ? 1 : 0;
        grazing += latest - soonest > 0.02 ? 1 : 0;
    });
    // The bounds are tight: the layer is 1.3e-3 of the radius thick, seldom grazed.
    EXPECT_GT(hits, rays / 20);
    EXPECT_LT(grazing, rays / 50);
}

TEST(BakeGdm, BallsOnTheGrid)
{
    check_balls({{0.5f, 0.5f, 0.25f}, 0.2f, 0.5f, 1.0f, resolution({8, 8, 6}, 16, 8)});
}

TEST(BakeGdm, BallsAtRandomPlaces)
{
    Random random(3);
    for (int i = 0; i < 4; ++i) {
        const float aspect = static_cast<float>(random.uniform(0.7, 1.6));
        const float radius = static_cast<float>(random.uniform(0.15, 0.3));
        const glm::vec3 center(random.in_box({-1.0, -1.0, 0.25}, {2.0, 2.0, 0.4}));
        check_balls({center, radius, 0.65f, aspect, resolution({7, 11, 5}, i % 2 == 0 ? 5 : 8, i % 2 == 0 ? 13 : 6)});
    }
}

TEST(BakeGdm, BallsCutByTheSlab)
{
    // Centers near both planes of the slab: the solid is cut open there, but its inside is inside all the same.
    check_balls({{0.31f, 0.77f, 0.02f}, 0.3f, 0.4f, 1.0f, resolution({5, 7, 5}, 6, 7)});
    check_balls({{0.31f, 0.77f, 0.43f}, 0.3f, 0.4f, 0.8f, resolution({5, 7, 5}, 7, 4)});
}

TEST(BakeGdm, ResolutionOutOfRange)
{
    const Sample sample = slab(0.1f, 0.2f).sample(0.7f);
    for (int axis = 0; axis < 3; ++axis) {
        for (const int bad : {1, 0, -3}) {
            GdmResolution r = resolution({4, 4, 4}, 4, 4);
            r.nodes[axis] = bad;
            expect_refusal<InvalidArgument>([&] { bake(sample, r); }, {"resolution", "at least 2"});
        }
    }
    expect_refusal<InvalidArgument>([&] { bake(sample, resolution({4, 4, 4}, 1, 4)); }, {"polar", "at least 2"});
    expect_refusal<InvalidArgument>([&] { bake(sample, resolution({4, 4, 4}, 4, 0)); }, {"azimuth", "at least 1"});
    expect_refusal<InvalidArgument>([&] { bake(sample, resolution({4096, 4096, 64}, 64, 256)); }, {"GB", "lower"});
    expect_refusal<InvalidArgument>([&] { bake(sample, resolution({4, 4, 65}, 64, 4)); }, {"4160", "at most 4096"});
    expect_refusal<InvalidArgument>(
        [&] {
            bake(sample, resolution({1 << 30, 1 << 30, 1 << 30}, 1 << 30, 1 << 30));
        },
        {"at most 4096"});
}

}  // namespace
}  // namespace mesoshell
