// Watching and stopping a long call from another thread.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "camera.h"
#include "check.h"
#include "mesoshell/attributes.h"
#include "mesoshell/facets.h"
#include "mesoshell/realize.h"
#include "mesoshell/render.h"
#include "mesoshell/scene.h"
#include "meshes.h"

namespace mesoshell {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(const Clock::time_point& start)
{
    return std::chrono::duration<double>(Clock::now() - start).count();
}

const Mesh& ball()
{
    static const Mesh mesh = sphere({0.5f, 0.5f, 0.3f}, 0.25f, 16, 24);
    return mesh;
}

GdmResolution gdm_grid(int n, int ntheta, int nphi)
{
    GdmResolution r;
    r.nodes = glm::ivec3(n, n, n / 2);
    r.ntheta = ntheta;
    r.nphi = nphi;
    return r;
}

Gdm raw_gdm(int n, int ntheta, int nphi)
{
    Gdm gdm;
    gdm.resolution = gdm_grid(n, ntheta, nphi);
    gdm.height = 0.6f;
    const std::size_t count = std::size_t(n) * n * (n / 2) * ntheta * nphi;
    gdm.values.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        gdm.values[i] = static_cast<float>(i * 2654435761u % 1000u) * 1e-3f;
    }
    return gdm;
}

Map sphere_map(const glm::ivec3& nodes)
{
    Job job;
    const Sdf sdf = bake_sdf(ball().sample(0.6f), nodes, job);
    Map map;
    map.height = sdf.height;
    map.sdf_nodes = sdf.nodes;
    map.sdf = sdf.values;
    return map;
}

// Cancels once the work has begun; it must end with Cancelled, soon, and not because it was done.
void check_cancelling(const std::function<void(Job&)>& work)
{
    // One thread works for seconds, so that the one that watches has its turn even on a busy machine.
    Job job(1);
    std::atomic<bool> ended{false};
    Clock::time_point cancelled_at;
    std::thread watcher([&] {
        while (job.fraction() <= 0.0f && !ended) {
            std::this_thread::yield();
        }
        cancelled_at = Clock::now();
        job.cancel();
    });
    bool cancelled = false;
    try {
        work(job);
    } catch (const Cancelled&) {
        cancelled = true;
    }
    ended = true;
    watcher.join();
    EXPECT_TRUE(cancelled);
    EXPECT_LT(job.fraction(), 0.9f);
    // Half a second is what a user would not notice; the machine may be busy with other things.
    EXPECT_LT(seconds_since(cancelled_at), 2.0);
}

TEST(JobCancel, BakeGdm)
{
    // Thirty million rays: a second of work.
    check_cancelling([](Job& job) { bake_gdm(ball().sample(0.6f), gdm_grid(64, 16, 16), job); });
}

TEST(JobCancel, BakeSdf)
{
    check_cancelling([](Job& job) { bake_sdf(ball().sample(0.6f), glm::ivec3(192), job); });
}

TEST(JobCancel, BakeFacets)
{
    check_cancelling([](Job& job) { bake_facets(ball().sample(0.6f), 128, job); });
}

TEST(JobCancel, ClosestPoints)
{
    check_cancelling([](Job& job) { closest_points(ball().sample(0.6f), glm::ivec3(192), job); });
}

TEST(JobCancel, Compress)
{
    const Gdm gdm = raw_gdm(64, 16, 12);
    check_cancelling([&](Job& job) { compress(gdm, nullptr, CompressOptions{}, job); });
}

TEST(JobCancel, Render)
{
    const Map map = sphere_map({32, 32, 16});
    const Shell shell = torus(1.0f, 0.4f, 24, 16, 6.0f, 4.0f).shell(0.3f);
    const View view = Camera(true, {1.5, -2.4, 2.2}, {0, 0, 0}, 0.55, {2048, 2048}).view();
    check_cancelling([&](Job& job) { render(shell, map, view, ShellParams{}, job); });
}

TEST(JobCancel, RenderScene)
{
    // Few tiles, whose pixels take their time.
    const Map map = sphere_map({32, 32, 16});
    const Shell shell = torus(1.0f, 0.4f, 24, 16, 6.0f, 4.0f).shell(0.3f);
    Scene scene;
    scene.shells.emplace_back();
    scene.shells[0].shell = &shell;
    scene.shells[0].map = &map;
    scene.lights.emplace_back();
    Film film;
    film.clip_from_world = Camera(true, {1.5, -2.4, 2.2}, {0, 0, 0}, 0.55, {64, 64}).view().clip_from_object;
    film.size = glm::ivec2(64);
    film.samples = 512;
    check_cancelling([&](Job& job) { render_scene(scene, film, job); });
}

TEST(JobCancel, Realize)
{
    const Sample sample = sphere({0.5f, 0.5f, 0.3f}, 0.25f, 24, 32).sample(0.6f);
    const Shell shell = torus(1.0f, 0.4f, 96, 64, 96.0f, 64.0f).shell(0.3f);
    check_cancelling([&](Job& job) { realize(shell, sample, job); });
}

TEST(JobCancel, BeforeTheStart)
{
    Job job;
    job.cancel();
    const Sample sample = ball().sample(0.6f);
    const View view = Camera(true, {0, 0, 3}, {0, 0, 0}, 0.55, {64, 64}).view();
    EXPECT_THROW(bake_gdm(sample, gdm_grid(64, 16, 32), job), Cancelled);
    EXPECT_THROW(bake_sdf(sample, glm::ivec3(64), job), Cancelled);
    EXPECT_THROW(bake_facets(sample, 32, job), Cancelled);
    EXPECT_THROW(closest_points(sample, glm::ivec3(64), job), Cancelled);
    EXPECT_THROW(compress(raw_gdm(8, 4, 4), nullptr, CompressOptions{}, job), Cancelled);
    EXPECT_THROW(realize(cube().shell(0.1f), sample, job), Cancelled);
    EXPECT_THROW(render(cube().shell(0.1f), sphere_map(glm::ivec3(8)), view, ShellParams{}, job), Cancelled);
    EXPECT_THROW(trace({}, {}, view, job), Cancelled);
    EXPECT_THROW(render_scene({}, {}, job), Cancelled);
}

// Runs some work a few times over, looking at its fraction without a pause.
void check_fraction(const std::function<void(Job&)>& work)
{
    for (int run = 0; run < 30; ++run) {
        Job job;
        EXPECT_EQ(job.fraction(), 0.0f);
        std::atomic<bool> ended{false};
        float largest_step_back = 0.0f;
        std::thread watcher([&] {
            float before = 0.0f;
            while (!ended) {
                const float now = job.fraction();
                largest_step_back = std::max(largest_step_back, before - now);
                before = now;
            }
        });
        work(job);
        ended = true;
        watcher.join();
        ASSERT_LE(largest_step_back, 0.0f);
        // Thousands of small shares are added in single precision.
        ASSERT_NEAR(job.fraction(), 1.0f, 1e-3f);
    }
}

TEST(JobFraction, RoundingsOfALongLoopDoNotTurnItBack)
{
    Job job;
    job.stage(0.1f, 0.4f);
    for (int i = 0; i < 100003; ++i) {
        job.advance(1.0f / 100003.0f);
    }
    const float before = job.fraction();
    EXPECT_NE(before, 0.4f) << "this loop's shares sum without an error";
    EXPECT_NEAR(before, 0.4f, 1e-3f);
    job.stage(std::min(before, 0.4f) - 1e-5f, 1.0f);
    EXPECT_GE(job.fraction(), before);
    job.advance(1.0f);
    EXPECT_LE(job.fraction(), 1.0f);
    job.stage(0.0f, 1.0f);
    EXPECT_EQ(job.fraction(), 0.0f) << "another call begins anew";
}

TEST(JobFraction, BakeGdm)
{
    check_fraction([](Job& job) { bake_gdm(ball().sample(0.6f), gdm_grid(16, 4, 8), job); });
}

TEST(JobFraction, BakeSdf)
{
    check_fraction([](Job& job) { bake_sdf(ball().sample(0.6f), glm::ivec3(20), job); });
}

TEST(JobFraction, BakeFacets)
{
    check_fraction([](Job& job) { bake_facets(ball().sample(0.6f), 4, job); });
}

TEST(JobFraction, ClosestPoints)
{
    check_fraction([](Job& job) { closest_points(ball().sample(0.6f), glm::ivec3(20), job); });
}

TEST(JobFraction, Compress)
{
    const Gdm gdm = raw_gdm(16, 6, 8);
    check_fraction([&](Job& job) { compress(gdm, nullptr, CompressOptions{}, job); });
}

TEST(JobFraction, Render)
{
    const Map map = sphere_map({16, 16, 8});
    const Shell shell = cube().shell(0.3f);
    const View view = Camera(true, {1.5, -2.4, 2.2}, {0, 0, 0}, 0.55, {64, 64}).view();
    check_fraction([&](Job& job) { render(shell, map, view, ShellParams{}, job); });
}

TEST(JobFraction, RenderScene)
{
    Scene scene;
    scene.lights.emplace_back();
    Film film;
    film.size = glm::ivec2(100, 70);
    check_fraction([&](Job& job) { render_scene(scene, film, job); });
}

TEST(JobFraction, StagesFollowOneAnother)
{
    Job job;
    job.stage(0.0f, 0.25f);
    job.advance(0.5f);
    EXPECT_NEAR(job.fraction(), 0.125f, 1e-6f);
    job.advance(0.5f);
    EXPECT_NEAR(job.fraction(), 0.25f, 1e-6f);
    job.stage(0.25f, 1.0f);
    EXPECT_NEAR(job.fraction(), 0.25f, 1e-6f);
    job.advance(1.0f);
    EXPECT_NEAR(job.fraction(), 1.0f, 1e-6f);
}

}  // namespace
}  // namespace mesoshell
