// Where a ray runs inside one prism with bilinear fins, against brute force in double precision.
#include <bit>
#include <cmath>

#include "check.h"
#include "mesoshell/render.h"
#include "meshes.h"
#include "prism_truth.h"

namespace mesoshell {
namespace {

glm::vec3 jitter(Random& random, double size)
{
    return glm::vec3(random.in_box(glm::dvec3(-size), glm::dvec3(size)));
}

PrismTexels random_prism(Random& random)
{
    const std::array<glm::vec3, 3> base{glm::vec3(0, 0, 0) + jitter(random, 0.15),
                                        glm::vec3(1, 0, 0) + jitter(random, 0.15),
                                        glm::vec3(0.3f, 0.9f, 0) + jitter(random, 0.15)};
    std::array<glm::vec3, 3> top;
    for (std::size_t i = 0; i < 3; ++i) {
        top[i] = base[i] + glm::vec3(0, 0, 0.6f) + jitter(random, 0.3);
    }
    return prism_of(base, top);
}

struct Ray {
    glm::vec3 origin;
    glm::vec3 dir;
};

Ray random_ray(Random& random)
{
    const glm::dvec3 target = random.in_box({-0.1, -0.1, -0.1}, {1.0, 0.9, 0.8});
    const glm::dvec3 dir = random.direction();
    return {glm::vec3(target - 3.0 * dir), glm::vec3(dir)};
}

TEST(PrismPosition, CornersAndMiddle)
{
    Random random(1);
    const PrismTexels prism = random_prism(random);
    const auto expect_near = [](const glm::vec3& a, const glm::vec3& b) {
        EXPECT_LT(glm::length(a - b), 4 * 0x1p-23f);
    };
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::vec2 weights(i == 1 ? 1.0f : 0.0f, i == 2 ? 1.0f : 0.0f);
        expect_near(prism_position(prism, {weights, 0.0f}), glm::vec3(prism[i]));
        expect_near(prism_position(prism, {weights, 1.0f}), glm::vec3(prism[i + 3]));
    }
    glm::vec3 mean(0.0f);
    for (std::size_t i = 0; i < 6; ++i) {
        mean += glm::vec3(prism[i]) / 6.0f;
    }
    expect_near(prism_position(prism, {1.0f / 3.0f, 1.0f / 3.0f, 0.5f}), mean);
}

TEST(PrismSpans, EndsLieOnTheRayAndInThePrism)
{
    Random random(2);
    int ends = 0;
    for (int i = 0; i < 20000; ++i) {
        const PrismTexels prism = random_prism(random);
        const PrismTruth truth(prism);
        const Ray ray = random_ray(random);
        float before = everywhere;
        for (const PrismSpan& span : prism_spans(prism, ray.origin, ray.dir, everywhere)) {
            ASSERT_LE(before, span.t_in);
            ASSERT_LE(span.t_in, span.t_out);
            before = span.t_in;
            for (const auto& [t, q] : {std::pair(span.t_in, span.q_in), std::pair(span.t_out, span.q_out)}) {
                ASSERT_TRUE(q.x >= 0.0f && q.y >= 0.0f && q.z >= 0.0f && q.z <= 1.0f);
                const double error = truth.coordinate_error(glm::dvec3(ray.origin), glm::dvec3(ray.dir), q.z);
                ASSERT_LE(q.x + q.y, 1.0 + 2.0 * error + 1e-6);
                // Two coordinates in error, each moves the point by at most the size; the ray parameter itself has
                // 2^-21 of its length of 4.
                const glm::dvec3 on_ray = glm::dvec3(ray.origin) + glm::dvec3(ray.dir) * double(t);
                ASSERT_LE(glm::length(truth.position(glm::dvec3(q)) - on_ray),
                          3.0 * error * truth.size() + 4 * 0x1p-21);
                ends += 1;
            }
        }
    }
    EXPECT_GT(ends, 20000);
}

TEST(PrismSpans, InsideIsWhereThePrismIs)
{
    Random random(3);
    int inside = 0;
    int outside = 0;
    int undecided = 0;
    for (int i = 0; i < 600; ++i) {
        const PrismTexels prism = random_prism(random);
        const PrismTruth truth(prism);
        const Ray ray = random_ray(random);
        const std::vector<PrismSpan> spans = prism_spans(prism, ray.origin, ray.dir, everywhere);
        double error = 0.0;
        for (int k = 0; k <= 10; ++k) {
            error = std::max(error, truth.coordinate_error(glm::dvec3(ray.origin), glm::dvec3(ray.dir), k / 10.0));
        }
        // Where the seen area vanishes at some height, the error is large only there; spans end before, since then the
        // numerators would all be zero.
        error = std::min(error, 0.01);
        for (int k = 0; k < 160; ++k) {
            const double t = 1.8 + 2.4 * (k + random.uniform(0.0, 1.0)) / 160;
            const double depth = truth.depth(glm::dvec3(ray.origin) + glm::dvec3(ray.dir) * t);
            bool in_span = false;
            for (const PrismSpan& span : spans) {
                in_span = in_span || (t >= span.t_in && t <= span.t_out);
            }
            if (std::abs(depth) <= error) {
                undecided += 1;
            } else {
                ASSERT_EQ(in_span, depth > 0.0) << "ray " << i << " at t = " << t << ", depth " << depth;
                (depth > 0.0 ? inside : outside) += 1;
            }
        }
    }
    EXPECT_GT(inside, 10000);
    EXPECT_GT(outside, 10000);
    EXPECT_LT(undecided, (inside + outside) / 50);
}

TEST(PrismSpans, NeighborAcrossAFinMeetsItAtTheSameHeight)
{
    Random random(4);
    int crossings = 0;
    int bits = 0;
    for (int i = 0; i < 40000; ++i) {
        const PrismTexels here = random_prism(random);
        // The neighbor has columns 1 and 2 in reversed order, a third column of its own, other UVs, and its columns may
        // begin anywhere.
        const glm::vec3 far_base = glm::vec3(1.1f, 1.0f, 0.0f) + jitter(random, 0.15);
        const glm::vec3 far_top = far_base + glm::vec3(0, 0, 0.6f) + jitter(random, 0.3);
        const std::array<glm::vec4, 3> base{here[2], here[1], glm::vec4(far_base, 0.0f)};
        const std::array<glm::vec4, 3> top{here[5], here[4], glm::vec4(far_top, 0.0f)};
        PrismTexels there{};
        const auto turn = static_cast<std::size_t>(random.below(3));
        for (std::size_t k = 0; k < 3; ++k) {
            there[k] = base[(k + turn) % 3];
            there[k + 3] = top[(k + turn) % 3];
            there[k].w = static_cast<float>(random.uniform(0.0, 1.0));
            there[k + 3].w = there[k].w;
        }
        there[6] = glm::vec4(random.direction(), 0.5);
        const Ray ray = random_ray(random);
        for (const PrismSpan& a : prism_spans(here, ray.origin, ray.dir, everywhere)) {
            // Column 0 weighs nothing where the ray crosses the fin of columns 1 and 2; away from the fin's borders.
            for (const auto& [t, q] : {std::pair(a.t_in, a.q_in), std::pair(a.t_out, a.q_out)}) {
                if (std::abs(1.0f - q.x - q.y) > 1e-4f || q.z < 0.01f || q.z > 0.99f || q.x < 0.01f || q.y < 0.01f) {
                    continue;
                }
                // The height is a root of what the fin alone decides: the same to the last bit. The ray parameter there
                // is computed from all three columns of either prism.
                bool met = false;
                bool equal = false;
                for (const PrismSpan& b : prism_spans(there, ray.origin, ray.dir, everywhere)) {
                    for (const auto& [t_there, q_there] : {std::pair(b.t_in, b.q_in), std::pair(b.t_out, b.q_out)}) {
                        // A ray that is level with either prism has one height there, which is that prism's own.
                        const bool level = std::min(std::abs(a.q_in.z - a.q_out.z), std::abs(b.q_in.z - b.q_out.z)) < 4e-3f;
                        const bool same = std::bit_cast<std::uint32_t>(q_there.z) == std::bit_cast<std::uint32_t>(q.z);
                        if (same ||
                            (level && std::abs(t_there - t) < 1e-3f && std::abs(q_there.z - q.z) < 1e-3f)) {
                            double error = level ? 1e-3 : 0.0;
                            for (const PrismTexels* prism : {&here, static_cast<const PrismTexels*>(&there)}) {
                                const PrismTruth truth(*prism);
                                error += 3.0 * truth.size() *
                                         truth.coordinate_error(glm::dvec3(ray.origin), glm::dvec3(ray.dir), q.z);
                            }
                            ASSERT_NEAR(t_there, t, error + 8 * 0x1p-21) << "ray " << i;
                            met = true;
                            equal = equal || same;
                        }
                    }
                }
                bits += equal ? 1 : 0;
                ASSERT_TRUE(met) << "ray " << i << " crosses the fin at height " << q.z << ", t = " << t;
                crossings += 1;
            }
        }
    }
    EXPECT_GT(crossings, 5000);
    EXPECT_GT(bits, 0.99 * crossings);
}

TEST(PrismSpans, CameraInside)
{
    Random random(5);
    int cut = 0;
    for (int i = 0; i < 4000; ++i) {
        const PrismTexels prism = random_prism(random);
        const PrismTruth truth(prism);
        const Ray ray = random_ray(random);
        const std::vector<PrismSpan> whole = prism_spans(prism, ray.origin, ray.dir, everywhere);
        const float t_near = static_cast<float>(random.uniform(2.0, 4.0));
        const std::vector<PrismSpan> seen = prism_spans(prism, ray.origin, ray.dir, t_near);
        std::size_t left = 0;
        for (const PrismSpan& span : whole) {
            if (span.t_out <= t_near) {
                continue;
            }
            ASSERT_LT(left, seen.size());
            const PrismSpan& rest = seen[left++];
            ASSERT_EQ(rest.t_in, std::max(span.t_in, t_near));
            ASSERT_EQ(rest.t_out, span.t_out);
            ASSERT_EQ(rest.q_out, span.q_out);
            if (span.t_in < t_near) {
                const double error = truth.coordinate_error(glm::dvec3(ray.origin), glm::dvec3(ray.dir), rest.q_in.z);
                const glm::dvec3 on_ray = glm::dvec3(ray.origin) + glm::dvec3(ray.dir) * double(t_near);
                ASSERT_LE(glm::length(truth.position(glm::dvec3(rest.q_in)) - on_ray),
                          3.0 * error * truth.size() + 8 * 0x1p-21);
                cut += 1;
            } else {
                ASSERT_EQ(rest.q_in, span.q_in);
            }
        }
        ASSERT_EQ(left, seen.size());
    }
    EXPECT_GT(cut, 500);
}

TEST(PrismSpans, RaysThroughCornersAndEdgesStayFinite)
{
    // Quarters of small whole numbers make every kind of exact coincidence: numerators that vanish, double roots, flat
    // fins.
    Random random(8);
    const auto whole = [&](int low, int high) { return static_cast<float>(low + random.below(high - low + 1)); };
    for (int i = 0; i < 200000; ++i) {
        std::array<glm::vec3, 3> base{glm::vec3(0, 0, 0), glm::vec3(2, 0, 0), glm::vec3(0, 2, 0)};
        std::array<glm::vec3, 3> top;
        for (std::size_t k = 0; k < 3; ++k) {
            top[k] = base[k] + glm::vec3(0.25f * whole(-2, 2), 0.25f * whole(-2, 2), whole(1, 2));
        }
        const PrismTexels prism = prism_of(base, top);
        const glm::vec3 origin = 0.25f * glm::vec3(whole(-8, 16), whole(-8, 16), whole(-8, 16));
        glm::vec3 dir(whole(-2, 2), whole(-2, 2), whole(-2, 2));
        if (dir == glm::vec3(0.0f)) {
            continue;
        }
        dir = glm::normalize(dir);
        for (const PrismSpan& span : prism_spans(prism, origin, dir, everywhere)) {
            ASSERT_TRUE(std::isfinite(span.t_in) && std::isfinite(span.t_out)) << "ray " << i;
            ASSERT_LE(span.t_in, span.t_out);
            for (const glm::vec3& q : {span.q_in, span.q_out}) {
                // Not NaN, and where the tile may be looked up.
                ASSERT_TRUE(q.x >= -1e-3f && q.x <= 1.001f && q.y >= -1e-3f && q.y <= 1.001f && q.z >= 0.0f &&
                            q.z <= 1.0f)
                    << "ray " << i << ": " << q.x << " " << q.y << " " << q.z;
            }
        }
    }
}

TEST(PrismSpans, PyramidWhoseTopIsAPoint)
{
    // Base (0,0), (1,0), (0,1) in z = 0, all directors to the apex (0.25, 0.25, 1): seen from above, the triangle at
    // height w is the base shrunk about (0.25, 0.25) by 1 - w.
    PrismTexels pyramid{};
    pyramid[0] = glm::vec4(0.0f, 0.0f, 0.0f, 0.0f);
    pyramid[1] = glm::vec4(1.0f, 0.0f, 0.0f, 0.0f);
    pyramid[2] = glm::vec4(0.0f, 1.0f, 0.0f, 0.0f);
    pyramid[3] = pyramid[4] = pyramid[5] = glm::vec4(0.25f, 0.25f, 1.0f, 0.0f);
    // Down the axis: through the apex to the base.
    std::vector<PrismSpan> spans = prism_spans(pyramid, {0.25f, 0.25f, 3.0f}, {0.0f, 0.0f, -1.0f}, 0.0f);
    ASSERT_EQ(spans.size(), 1u);
    EXPECT_NEAR(spans[0].t_in, 2.0f, 1.001f / 64.0f);  // the end is evaluated a sixty-fourth inside
    EXPECT_NEAR(spans[0].t_out, 3.0f, 1e-5f);
    // Beside it, through (0.5, 0.25): the slanted fin x + y = 1 - w / 2 is met at w = 0.5.
    spans = prism_spans(pyramid, {0.5f, 0.25f, 3.0f}, {0.0f, 0.0f, -1.0f}, 0.0f);
    ASSERT_EQ(spans.size(), 1u);
    EXPECT_NEAR(spans[0].t_in, 2.5f, 1e-5f);
    EXPECT_NEAR(spans[0].t_out, 3.0f, 1e-5f);
    // Level with the apex: a point, which has no inside.
    for (const PrismSpan& span : prism_spans(pyramid, {-2.0f, 0.25f, 1.0f}, {1.0f, 0.0f, 0.0f}, 0.0f)) {
        EXPECT_NEAR(span.t_out - span.t_in, 0.0f, 1e-4f);
    }
}

}  // namespace
}  // namespace mesoshell
