// The true path of a ray in a prism: it is the ray, its chords bound it, and paths of neighbors meet.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "check.h"
#include "embree_scene.h"
#include "exact_path.h"
#include "meshes.h"
#include "prism_truth.h"

namespace mesoshell {
namespace {

// A prism about one in size, twisted and tapered; some have one or two columns without height, others a top that is a point.
PrismTexels random_prism(Random& random, bool own_top_uvs)
{
    const int kind = random.below(8);
    std::array<glm::vec3, 3> base;
    std::array<glm::vec3, 3> top;
    const glm::dvec3 apex = glm::dvec3(0.3, 0.3, 1.0) + 0.3 * random.direction();
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 corner(i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0, 0.0);
        base[i] = glm::vec3(corner + 0.2 * random.direction());
        top[i] = base[i] + glm::vec3(glm::dvec3(0.0, 0.0, random.uniform(0.4, 1.0)) + 0.25 * random.direction());
        if (kind == 1) {
            top[i] = glm::vec3(apex);
        }
        if (kind - 2 == static_cast<int>(i) || (kind >= 5 && kind - 5 != static_cast<int>(i))) {
            top[i] = base[i];
        }
    }
    PrismTexels texels = prism_of(base, top);
    float* const v[6] = {&texels[6].x, &texels[6].y, &texels[6].z, &texels[6].w, &texels[7].x, &texels[7].y};
    for (std::size_t i = 0; i < 3; ++i) {
        texels[i].w = static_cast<float>(random.uniform(-1.0, 1.0) + (i == 1 ? 2.0 : 0.0));
        *v[i] = static_cast<float>(random.uniform(-1.0, 1.0) + (i == 2 ? 2.0 : 0.0));
        texels[i + 3].w = texels[i].w + (own_top_uvs ? static_cast<float>(random.uniform(-0.5, 0.5)) : 0.0f);
        *v[i + 3] = *v[i] + (own_top_uvs ? static_cast<float>(random.uniform(-0.5, 0.5)) : 0.0f);
    }
    return texels;
}

struct Ray {
    glm::dvec3 origin;
    glm::dvec3 dir;  // of any length
};

// Through a point of a prism: in any direction, or along the offset triangle there, off by slopes of 0 or from 1e-9 to 1e-3.
Ray ray_through(Random& random, const PrismTruth& truth, const glm::dvec3& q)
{
    glm::dvec3 dir = random.direction();
    if (random.below(2) == 0) {
        const glm::dvec3 normal = glm::normalize(
            glm::cross(truth.column(1, q.z) - truth.column(0, q.z), truth.column(2, q.z) - truth.column(0, q.z)));
        dir -= glm::dot(dir, normal) * normal;
        if (random.below(3) > 0) {
            dir += std::pow(10.0, random.uniform(-9.0, -3.0)) * random.direction();
        }
    }
    dir *= random.uniform(0.5, 2.0);
    return {truth.position(q) - random.uniform(8.0, 9.0) * dir, dir};
}

glm::dvec3 random_place(Random& random)
{
    const double q1 = random.uniform(0.02, 0.96);
    return {q1, random.uniform(0.01, 0.98 - q1), random.uniform(0.02, 0.98)};
}

TEST(ExactPath, EveryPlaceIsOnTheRay)
{
    Random random(51);
    int found = 0;
    for (int i = 0; i < 40000; ++i) {
        const PrismTexels prism = random_prism(random, i % 2 == 1);
        const PrismTruth truth(prism);
        const glm::dvec3 q = random_place(random);
        const Ray ray = ray_through(random, truth, q);
        const double t = glm::dot(truth.position(q) - ray.origin, ray.dir) / glm::dot(ray.dir, ray.dir);
        const ExactPath path(prism, ExactRay(ray.origin, ray.dir));
        bool has_place = false;
        for (int k = 0; k < path.span_count(); ++k) {
            const ExactSpan& span = path.span(k);
            ASSERT_LE(span.t_in, span.t_out);
            has_place = has_place || (span.t_in - 1e-6 <= t && t <= span.t_out + 1e-6);
            for (const double share : {0.0, 0.13, 0.5, 0.91, 1.0}) {
                const ExactPlace place = path.at(span.s_in + (span.s_out - span.s_in) * share);
                // What is taken for level is off by up to 1e-6 of height, here of one, and as much of a weight at its rims.
                const glm::dvec3 off = truth.position(place.q) - (ray.origin + ray.dir * place.t);
                ASSERT_LT(glm::length(off), 3e-6);
                const glm::dvec3 texture(texture_at(prism, place.q), place.q.z);
                ASSERT_LT(glm::length(place.texture - texture), 1e-7);
                ASSERT_LT(glm::length(path.texture_at(span.s_in + (span.s_out - span.s_in) * share) - texture), 1e-7);
                ASSERT_GT(std::min({place.q.x, place.q.y, 1.0 - place.q.x - place.q.y, place.q.z, 1.0 - place.q.z}), -2e-6);
            }
        }
        found += has_place ? 1 : 0;
    }
    EXPECT_EQ(found, 40000);
}

TEST(ExactPath, BeginsWhereAsked)
{
    Random random(52);
    for (int i = 0; i < 4000; ++i) {
        const PrismTexels prism = random_prism(random, i % 2 == 1);
        const PrismTruth truth(prism);
        const Ray ray = ray_through(random, truth, random_place(random));
        ExactPath path(prism, ExactRay(ray.origin, ray.dir));
        const ExactSpan first = path.span(0);
        const int count = path.span_count();
        const double t_near = first.t_in + random.uniform(0.1, 0.9) * (first.t_out - first.t_in);
        path.begin_at(t_near);
        ASSERT_EQ(path.span_count(), count);
        ASSERT_TRUE(path.span(0).cut);
        ASSERT_EQ(path.span(0).s_out, first.s_out);
        ASSERT_NEAR(path.at(path.span(0).s_in).t, t_near, 1e-7);
        path.begin_at(first.t_out);
        ASSERT_EQ(path.span_count(), count - 1);
    }
}

TEST(ExactPath, NothingBulgesMoreThanItsBound)
{
    Random random(53);
    const glm::dvec3 scale(1.0, 0.8, 0.5);
    int bent = 0;
    double looseness = 0.0;
    for (int i = 0; i < 20000; ++i) {
        const PrismTexels prism = random_prism(random, i % 2 == 1);
        const Ray ray = ray_through(random, PrismTruth(prism), random_place(random));
        const ExactPath path(prism, ExactRay(ray.origin, ray.dir));
        const ExactSpan& span = path.span(0);
        const double a = span.s_in + random.uniform(0.0, 0.5) * (span.s_out - span.s_in);
        const double b = span.s_in + random.uniform(0.5, 1.0) * (span.s_out - span.s_in);
        const double bound = path.bulge(a, b, scale);
        const glm::dvec3 start = path.texture_at(a) * scale;
        const glm::dvec3 chord = path.texture_at(b) * scale - start;
        double most = 0.0;
        for (int k = 1; k < 32; ++k) {
            const glm::dvec3 offset = path.texture_at(a + (b - a) * k / 32.0) * scale - start;
            const double along = std::clamp(glm::dot(offset, chord) / glm::dot(chord, chord), 0.0, 1.0);
            most = std::max(most, glm::length(offset - chord * along));
        }
        ASSERT_LE(most, bound + 1e-7);
        if (most > 1e-3 && std::isfinite(bound)) {
            bent += 1;
            looseness += bound / most;
        }
    }
    EXPECT_GT(bent, 1000);
    EXPECT_LT(looseness / bent, 2.0);  // a loose one would cost chords
}

// A shell without borders is left through its base and its top alone.
TEST(ExactPath, NeighborsMeetWithoutAGap)
{
    const Shell shell = torus(1.0f, 0.42f, 24, 12, 10.0f, 5.0f).shell(0.31f);
    std::vector<BoxScene::Box> boxes;
    std::vector<PrismTruth> truths;
    for (const PrismTexels& prism : shell.prisms) {
        glm::vec3 lower(prism[0]);
        glm::vec3 upper = lower;
        for (std::size_t corner = 1; corner < 6; ++corner) {
            lower = glm::min(lower, glm::vec3(prism[corner]));
            upper = glm::max(upper, glm::vec3(prism[corner]));
        }
        boxes.push_back({lower - 1e-4f, upper + 1e-4f});
        truths.emplace_back(prism);
    }
    const BoxScene scene(boxes);
    Random random(54);
    int joints = 0;
    for (int i = 0; i < 60000; ++i) {
        const auto through = static_cast<std::size_t>(random.below(static_cast<int>(shell.prisms.size())));
        // A third runs through a point of a fin, and a third of these along it.
        glm::dvec3 q = random_place(random);
        q.y = i % 3 == 0 ? 0.0 : q.y;
        Ray ray = ray_through(random, truths[through], q);
        if (i % 9 == 0) {
            ray.dir = truths[through].column(1, q.z) - truths[through].column(0, q.z);
        }
        ray.origin = truths[through].position(q) - 6.0 / glm::length(ray.dir) * ray.dir;  // outside of the shell
        const double t = glm::dot(truths[through].position(q) - ray.origin, ray.dir) / glm::dot(ray.dir, ray.dir);
        struct Stretch {
            double t_in, t_out, w_in, w_out;
        };
        std::vector<Stretch> stretches;
        const glm::vec3 dir(glm::normalize(ray.dir));
        scene.visit_along(glm::vec3(ray.origin), dir, 0.0f, [&](std::uint32_t prism, float tfar) {
            const ExactPath path(shell.prisms[prism], ExactRay(ray.origin, ray.dir));
            for (int k = 0; k < path.span_count(); ++k) {
                const ExactSpan& span = path.span(k);
                stretches.push_back({span.t_in, span.t_out, path.at(span.s_in).q.z, path.at(span.s_out).q.z});
            }
            return tfar;
        });
        std::sort(stretches.begin(), stretches.end(), [](const Stretch& a, const Stretch& b) { return a.t_in < b.t_in; });
        const auto at_end = [](double w) { return std::min(w, 1.0 - w) < 3e-6; };
        bool holds_point = false;
        double reached = -1e30;
        double w_reached = 0.0;
        for (const Stretch& stretch : stretches) {
            holds_point = holds_point || (stretch.t_in - 1e-6 <= t && t <= stretch.t_out + 1e-6);
            if (stretch.t_in > reached + 1e-6) {
                ASSERT_TRUE(at_end(w_reached) && at_end(stretch.w_in)) << "a ray begins or ends within the shell";
            } else {
                joints += 1;
            }
            if (stretch.t_out > reached) {
                reached = stretch.t_out;
                w_reached = stretch.w_out;
            }
        }
        ASSERT_TRUE(at_end(w_reached)) << "a ray ends within the shell";
        ASSERT_TRUE(holds_point);
    }
    EXPECT_GT(joints, 60000);
}

}  // namespace
}  // namespace mesoshell
