// The error report against every node of a bake, and against distances that are known.
#include <algorithm>
#include <cmath>
#include <vector>

#include "check.h"
#include "mesoshell/measure.h"
#include "mesoshell/render.h"
#include "meshes.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

constexpr int count = 200000;

// A map of some balls, few enough terms for errors of every size.
struct Balls {
    Sample sample;
    Gdm gdm;
    Map map;
};

Balls make_balls(int terms)
{
    GdmResolution r;
    r.nodes = glm::ivec3(16, 12, 9);
    r.ntheta = 8;
    r.nphi = 8;
    Job job;
    const Mesh mesh = merged(sphere({0.31f, 0.33f, 0.22f}, 0.2f, 12, 16), sphere({0.77f, 0.62f, 0.41f}, 0.13f, 12, 16));
    Balls balls{mesh.sample(0.6f, 0.8f), {}, {}};
    balls.gdm = bake_gdm(balls.sample, r, job);
    const Sdf sdf = bake_sdf(balls.sample, {48, 38, 29}, job);
    CompressOptions options;
    options.layout = Layout::paper;
    options.terms = terms;
    options.precision = Precision::single;
    balls.map = compress(balls.gdm, &sdf, options, job);
    return balls;
}

// Errors at every node from which a ray is cast into the slab.
std::vector<double> errors_at_nodes(const Balls& balls)
{
    const GdmResolution& r = balls.map.resolution;
    Job job;
    const std::vector<std::uint8_t> inside = classify_inside(balls.sample, r.nodes, job);
    std::vector<double> errors;
    for (int phi = 0; phi < r.nphi; ++phi) {
        for (int y = 0; y < r.nodes.y; ++y) {
            for (int x = 0; x < r.nodes.x; ++x) {
                for (int theta = 0; theta < r.ntheta; ++theta) {
                    for (int z = 0; z < r.nodes.z; ++z) {
                        const float height = 0.6f * static_cast<float>(z) / static_cast<float>(r.nodes.z - 1);
                        const auto up = static_cast<float>(gdm_direction(r, theta, phi).z);
                        if (inside[(std::size_t(z) * r.nodes.y + y) * r.nodes.x + x] != 0 || slab_exit(height, up, 0.6f) <= 0.0f) {
                            continue;
                        }
                        double sum = 0.0;
                        for (int k = 0; k < balls.map.terms; ++k) {
                            const std::size_t weight = ((std::size_t(k) * r.nphi + phi) * r.nodes.y + y) * r.nodes.x + x;
                            const std::size_t eigenmap = (std::size_t(k) * r.ntheta + theta) * r.nodes.z + z;
                            sum += double(balls.map.weights[weight]) * balls.map.eigenmaps[eigenmap];
                        }
                        errors.push_back(std::abs(std::max(sum, 0.0) - balls.gdm.values[balls.gdm.index(phi, y, x, theta, z)]));
                    }
                }
            }
        }
    }
    std::sort(errors.begin(), errors.end());
    return errors;
}

TEST(Measure, OnTheGridItIsTheErrorOfAllNodes)
{
    const Balls balls = make_balls(6);
    const std::vector<double> errors = errors_at_nodes(balls);
    double squared = 0.0;
    double fourth = 0.0;
    for (const double error : errors) {
        squared += error * error / static_cast<double>(errors.size());
        fourth += std::pow(error, 4) / static_cast<double>(errors.size());
    }
    Job job;
    const ErrorReport report = measure(balls.map, balls.sample, RaySet::on_grid, count, 1, job);
    EXPECT_EQ(report.rays, count);
    // Five standard deviations of a mean of that many squares. (The pole's azimuths are as many rays as any other's here and there.)
    EXPECT_NEAR(report.rmse * report.rmse, squared, 5.0 * std::sqrt((fourth - squared * squared) / count));
    const auto at = [&](double share) { return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size()))]; };
    // Of a sorted sample, the rank errs by the square root of share (1 - share) / count.
    EXPECT_GT(report.median, at(0.5 - 0.006));
    EXPECT_LT(report.median, at(0.5 + 0.006));
    EXPECT_GT(report.percentile_95, at(0.95 - 0.003));
    EXPECT_LT(report.percentile_95, at(0.95 + 0.003));
    EXPECT_GT(report.percentile_99, at(0.99 - 0.0015));
    EXPECT_LT(report.percentile_99, at(0.99 + 0.0015));
    EXPECT_LE(report.largest, errors.back() + 1e-4);
}

TEST(Measure, AllTermsLeaveNothingOnTheGrid)
{
    const Balls balls = make_balls(8 * 9);
    Job job;
    const ErrorReport on = measure(balls.map, balls.sample, RaySet::on_grid, count, 2, job);
    EXPECT_LT(on.percentile_99, 1e-4);
    // Rays that graze a ball are hits or misses as the order of triangles has it: a few in 100,000, some 0.5 wrong each.
    EXPECT_LT(on.rmse, 0.5 * std::sqrt(5e-5));
    const ErrorReport off = measure(balls.map, balls.sample, RaySet::off_grid, count, 2, job);
    EXPECT_GT(off.rmse, 0.05);  // interpolation between directions 25 degrees apart
    EXPECT_GT(off.percentile_95, off.median);
    EXPECT_GT(off.percentile_99, off.percentile_95);
    EXPECT_GE(off.largest, off.percentile_99);
}

// A map without any terms' weight says 0 everywhere, so that every error is the distance itself.
TEST(Measure, DistancesToAFloorAreKnown)
{
    // Solid below 0.2 of a height of 0.5.
    const Sample sample = slab(-0.1f, 0.2f).sample(0.5f);
    Job job;
    GdmResolution r;
    r.nodes = glm::ivec3(4, 4, 4);
    r.ntheta = 4;
    r.nphi = 4;
    CompressOptions options;
    options.layout = Layout::paper;
    options.terms = 1;
    options.precision = Precision::single;
    Map map = compress(bake_gdm(sample, r, job), nullptr, options, job);
    std::fill(map.weights.begin(), map.weights.end(), 0.0f);
    const ErrorReport report = measure(map, sample, RaySet::off_grid, count, 3, job);
    // Over heights above the floor, z in [0, 0.3], and cosines c: distance z / c, whichever way, at most 16. Its median is where
    // the chance of z / c < d is one half: d / 0.6 = 1/2 as long as d < 0.3.
    EXPECT_NEAR(report.median, 0.3, 0.01);
    EXPECT_NEAR(report.largest, horizon_distance, 1e-3);
    EXPECT_NEAR(report.hits, 0.5, 0.01);
    // Without a distance field it says hit where more than a node and a half, 3/8, are left to the slab's end. Upward that is
    // 0.3 u / c > 3/8 for uniform u and c: 0.4 of half the rays. Downward z / c < 3/8 for z in [0.2, 0.5] is missed.
    EXPECT_NEAR(report.false_hits, 0.2, 0.005);
    EXPECT_NEAR(report.false_misses, 0.5 * (0.375 / 2.0 - 0.2 + 0.2 * 0.2 / 0.75) / 0.3, 0.005);
}

TEST(Measure, HitsOfAPerfectMapAreRight)
{
    // A floor between nodes: of the ten rays from the three nodes above it that point into the slab, six go down.
    const Sample sample = slab(-0.1f, 0.22f).sample(0.5f);
    Job job;
    GdmResolution r;
    r.nodes = glm::ivec3(4, 4, 6);
    r.ntheta = 4;
    r.nphi = 4;
    const Sdf sdf = bake_sdf(sample, {32, 32, 33}, job);
    CompressOptions options;
    options.layout = Layout::paper;
    options.terms = 24;
    options.precision = Precision::single;
    const Map map = compress(bake_gdm(sample, r, job), &sdf, options, job);
    const ErrorReport report = measure(map, sample, RaySet::on_grid, count, 4, job);
    EXPECT_EQ(report.false_hits, 0.0);
    EXPECT_EQ(report.false_misses, 0.0);
    EXPECT_NEAR(report.hits, 0.6, 0.006);
}

TEST(Measure, SeedsAndThreads)
{
    const Balls balls = make_balls(6);
    Job one(1);
    Job three(3);
    const ErrorReport a = measure(balls.map, balls.sample, RaySet::off_grid, 20000, 7, one);
    const ErrorReport b = measure(balls.map, balls.sample, RaySet::off_grid, 20000, 7, three);
    const ErrorReport c = measure(balls.map, balls.sample, RaySet::off_grid, 20000, 8, one);
    EXPECT_EQ(a.rmse, b.rmse);
    EXPECT_EQ(a.percentile_99, b.percentile_99);
    EXPECT_NE(a.rmse, c.rmse);
    EXPECT_NEAR(a.median, c.median, 0.1 * a.median);
}

TEST(Measure, Refusals)
{
    const Balls balls = make_balls(6);
    Job job;
    expect_refusal<InvalidArgument>([&] { measure(balls.map, balls.sample, RaySet::on_grid, 0, 1, job); }, {"number of rays"});
    Map other = balls.map;
    other.height = 0.5f;
    expect_refusal<InvalidArgument>([&] { measure(other, balls.sample, RaySet::on_grid, 10, 1, job); }, {"height or aspect"});
    job.cancel();
    EXPECT_THROW(measure(balls.map, balls.sample, RaySet::on_grid, 10, 1, job), Cancelled);
}

}  // namespace
}  // namespace mesoshell
