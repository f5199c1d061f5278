// Rays along the offset triangles of a prism, exactly and almost, where there is no height to solve for.
#include <algorithm>
#include <cmath>

#include "check.h"
#include "mesoshell/render.h"
#include "prism_truth.h"

namespace mesoshell {
namespace {

// A prism of equal directors is an affine image of the right prism, so a ray's coordinates are linear along it: clip
// them.
struct Clip {
    double low;
    double high;
    double flattest;  // least change along the ray of a coordinate that bounds it
};

Clip affine_span(const PrismTexels& prism, const glm::dvec3& origin, const glm::dvec3& dir)
{
    const glm::dvec3 base(prism[0]);
    const glm::dmat3 to_world(glm::dvec3(prism[1]) - base, glm::dvec3(prism[2]) - base, glm::dvec3(prism[3]) - base);
    const glm::dvec3 q = glm::inverse(to_world) * (origin - base);
    const glm::dvec3 slope = glm::inverse(to_world) * dir;
    double low = -1e30;
    double high = 1e30;
    double flattest = 1e30;
    const double values[5] = {q.x, q.y, 1.0 - q.x - q.y, q.z, 1.0 - q.z};
    const double changes[5] = {slope.x, slope.y, -slope.x - slope.y, slope.z, -slope.z};
    for (int i = 0; i < 5; ++i) {
        if (changes[i] == 0.0) {
            if (values[i] < 0.0) {
                return {1.0, -1.0, flattest};
            }
            continue;
        }
        flattest = std::min(flattest, std::abs(changes[i]));
        if (changes[i] > 0.0) {
            low = std::max(low, -values[i] / changes[i]);
        } else {
            high = std::min(high, -values[i] / changes[i]);
        }
    }
    return {low, high, flattest};
}

PrismTexels affine_prism()
{
    const std::array<glm::vec3, 3> base{glm::vec3(0, 0, 0), glm::vec3(1, 0.125f, 0), glm::vec3(0.25f, 0.875f, 0)};
    const glm::vec3 director(0.125f, -0.0625f, 0.5f);
    return prism_of(base, {base[0] + director, base[1] + director, base[2] + director});
}

TEST(PrismSpans, RayParallelToTheOffsetTriangles)
{
    const PrismTexels prism = affine_prism();
    Random random(6);
    int found = 0;
    for (int i = 0; i < 3000; ++i) {
        const double azimuth = random.uniform(0.0, 6.283185307179586);
        const glm::vec3 dir(std::cos(azimuth), std::sin(azimuth), 0.0);
        const glm::vec3 target(random.in_box({-0.2, -0.2, -0.1}, {1.3, 1.1, 0.6}));
        const glm::vec3 origin = target - 2.0f * dir;
        const auto [low, high, flattest] = affine_span(prism, glm::dvec3(origin), glm::dvec3(dir));
        const std::vector<PrismSpan> spans = prism_spans(prism, origin, dir, everywhere);
        // A crossing of an edge at a flat angle moves by the error of the coordinates over the slope along the ray, and by the
        // 5e-6 beyond edges that neighbors share; spans shorter than a thousandth may be missed.
        if (high - low > 1e-3) {
            ASSERT_EQ(spans.size(), 1u) << "ray " << i;
            ASSERT_NEAR(spans[0].t_in, low, 1e-5 + 6e-6 / flattest);
            ASSERT_NEAR(spans[0].t_out, high, 1e-5 + 6e-6 / flattest);
            ASSERT_NEAR(spans[0].q_in.z, origin.z / 0.5, 4 * 0x1p-23);
            found += 1;
        } else if (high < low - 1e-3) {
            ASSERT_TRUE(spans.empty()) << "ray " << i;
        }
    }
    EXPECT_GT(found, 500);
}

TEST(PrismSpans, RayAlmostParallelToTheOffsetTriangles)
{
    // From exactly parallel to plainly not. Where the ray is taken for level the derivative of an affine map is the map;
    // elsewhere the numerators are divided by a seen area that is only the slope times the true one.
    const PrismTexels prism = affine_prism();
    const PrismTruth truth(prism);
    Random random(7);
    int found = 0;
    for (int i = 0; i < 20000; ++i) {
        const double azimuth = random.uniform(0.0, 6.283185307179586);
        const double slope = std::pow(10.0, random.uniform(-8.0, -0.5)) * (i % 2 == 0 ? 1.0 : -1.0);
        const glm::dvec3 dir = glm::normalize(glm::dvec3(std::cos(azimuth), std::sin(azimuth), slope));
        const glm::vec3 origin(random.in_box({0.1, 0.0, 0.05}, {1.0, 0.8, 0.45}) - 2.0 * dir);
        const glm::vec3 dir_float(dir);
        const auto [low, high, flattest] = affine_span(prism, glm::dvec3(origin), glm::dvec3(dir_float));
        const double error = std::abs(slope) < 3e-4
                                 ? 1e-5
                                 : truth.coordinate_error(glm::dvec3(origin), glm::dvec3(dir_float), 0.5);
        const double allowed = 3.0 * error * truth.size() + 8 * 0x1p-21;
        if (high - low > 0.1) {
            const std::vector<PrismSpan> spans = prism_spans(prism, origin, dir_float, everywhere);
            ASSERT_EQ(spans.size(), 1u) << "slope " << slope;
            for (const auto& [t, q] :
                 {std::pair(spans[0].t_in, spans[0].q_in), std::pair(spans[0].t_out, spans[0].q_out)}) {
                const glm::dvec3 on_ray = glm::dvec3(origin) + glm::dvec3(dir_float) * double(t);
                ASSERT_LE(glm::length(truth.position(glm::dvec3(q)) - on_ray), allowed) << "slope " << slope;
                ASSERT_GE(truth.depth(on_ray), -2.0 * error - 1e-5) << "slope " << slope;
            }
            // As long as it is long: the ends may move by their error over the sine of the angle to what bounds them.
            ASSERT_GE(spans[0].t_out - spans[0].t_in, 0.9 * (high - low) - 20.0 * allowed) << "slope " << slope;
            found += 1;
        }
    }
    EXPECT_GT(found, 10000);
}

}  // namespace
}  // namespace mesoshell
