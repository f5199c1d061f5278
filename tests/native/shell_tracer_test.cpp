// One shell and rays from anywhere: the tracer against all prisms one by one.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "check.h"
#include "meshes.h"
#include "render_with.h"
#include "shell_tracer.h"

namespace mesoshell {
namespace {

// Solid throughout: a ray hits where it enters the shell.
Map solid_map()
{
    Map map;
    map.height = 0.5f;
    map.aspect = 1.0f;
    map.sdf_nodes = glm::ivec3(4, 4, 3);
    map.sdf.assign(4 * 4 * 3, -0.25f);
    map.precision = Precision::single;
    return map;
}

float first_entry(const Shell& shell, const glm::vec3& origin, const glm::vec3& dir)
{
    float nearest = std::numeric_limits<float>::infinity();
    for (const PrismTexels& prism : shell.prisms) {
        const std::vector<PrismSpan> spans = prism_spans(prism, origin, dir, 0.0f);
        if (!spans.empty()) {
            nearest = std::min(nearest, spans.front().t_in);
        }
    }
    return nearest;
}

TEST(ShellTracer, FindsWhatAllPrismsOneByOneDo)
{
    const Map map = solid_map();
    const Shell shell = torus(1.0f, 0.4f, 12, 8, 3.0f, 2.0f).shell(0.3f);
    const ShellTracer tracer(shell, map, complete_params(settings(sdf_traversal), map, glm::dmat4(1.0)), nullptr);
    Random random(7);
    int hits = 0;
    for (int i = 0; i < 6000; ++i) {
        // From inside, from around and from far away; every third along an axis, through corners.
        const double distance = std::pow(10.0, i % 4);
        glm::dvec3 target = random.in_box({-1.5, -1.5, -0.7}, {1.5, 1.5, 0.7});
        glm::dvec3 from = random.direction();
        if (i % 3 == 0) {
            target = glm::dvec3(shell.prisms[i % shell.prisms.size()][i % 6]);
            from = glm::dvec3(0.0);
            from[i / 3 % 3] = i % 2 == 0 ? 1.0 : -1.0;
        }
        const glm::vec3 origin(target + from * distance);
        const glm::vec3 dir(glm::normalize(target - glm::dvec3(origin)));
        const float entry = first_entry(shell, origin, dir);
        const ShellTraceHit hit = tracer.nearest(origin, dir, 0.0f, 1e9f);
        ASSERT_EQ(hit.hit, std::isfinite(entry)) << i;
        ASSERT_EQ(tracer.any(origin, dir, 0.0f, 1e9f).hit, hit.hit) << i;
        if (hit.hit) {
            hits += 1;
            ASSERT_NEAR(hit.t, entry, 1e-5 * distance) << i;
            ASSERT_FALSE(tracer.any(origin, dir, 0.0f, hit.t).hit) << i;
            ASSERT_FALSE(tracer.nearest(origin, dir, 0.0f, hit.t).hit) << i;
        }
    }
    EXPECT_GT(hits, 2000);
}

TEST(ShellTracer, ClearanceIsSomeOfAVoxelOnTheWayOut)
{
    // Along the normal the distance from the solid rises to half a voxel and the tolerance, whatever the prism's stretch.
    const Map map = sdf_map(sphere({0.5f, 0.5f, 0.25f}, 0.2f, 32, 48).sample(0.5f), {48, 48, 25});
    const ShellParams params = complete_params(settings(sdf_traversal), map, glm::dmat4(1.0));
    SurfaceMesh mesh = flat_grid(1, 1, 3.0f, 0.5f);
    for (glm::vec2& uv : mesh.uvs) {
        uv = glm::vec2(uv.x / 3.0f + 0.5f * uv.y, uv.y);
    }
    const Shell shell = mesh.shell(0.8f);
    const ShellTracer tracer(shell, map, params, nullptr);
    Random random(3);
    int hits = 0;
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 target(random.in_box({0.2, 0.05, 0.2}, {2.8, 0.45, 0.6}));
        const glm::vec3 dir(random.direction());
        const ShellTraceHit hit = tracer.nearest(target - dir * 4.0f, dir, 0.0f, 100.0f);
        const glm::vec3 above = target + dir * (hit.t - 4.0f) + hit.normal * hit.clearance;
        const auto place = texture_of_position(shell.prisms[hit.prism], above);
        const std::vector<glm::vec3> places{hit.pos_texture, place.value_or(glm::vec3(0.0f))};
        const std::vector<float> distances = lookup_sdf(map, places);
        if (!hit.hit || !place.has_value() || distances[0] < 0.0f) {
            continue;  // not met, beside the prism, or at the shell's border and within the solid
        }
        hits += 1;
        const float voxels = distances[1] * 48.0f;
        // The field is trilinear and its normal a difference over a voxel.
        ASSERT_NEAR(voxels, 0.5f + 2.0f * params.tolerance.y, 0.1f) << i;
    }
    EXPECT_GT(hits, 50);
}

}  // namespace
}  // namespace mesoshell
