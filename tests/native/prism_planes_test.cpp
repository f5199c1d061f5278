// Prisms whose fins are two planes each, as in the paper, against membership of points in double precision.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "check.h"
#include "mesoshell/render.h"
#include "meshes.h"
#include "prism_truth.h"

namespace mesoshell {
namespace {

// A prism between planes: below its top, above its base, and behind both planes of a convex fin or one of a concave one.
class PlanePrism {
public:
    explicit PlanePrism(const PrismTexels& texels)
    {
        for (std::size_t i = 0; i < 6; ++i) {
            corners_[i] = glm::dvec3(texels[i]);
        }
    }

    // How far inside, as the least distance from a plane that decides; negative outside.
    double depth(const glm::dvec3& point) const
    {
        double depth = std::min(below(point, 0, 2, 1), below(point, 3, 4, 5));
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3;
            // The same diagonal from both sides: up from the base that comes first by x, then y, then z.
            const glm::dvec3& a = corners_[i];
            const glm::dvec3& b = corners_[j];
            const bool rises = std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
            const int far = rises ? j + 3 : i + 3;
            const int fourth = rises ? i + 3 : j + 3;
            const double first = below(point, i, j, far);
            const double second = rises ? below(point, i, far, fourth) : below(point, j, fourth, far);
            const bool convex = below(corners_[fourth], i, j, far) >= 0.0;
            depth = std::min(depth, convex ? std::min(first, second) : std::max(first, second));
        }
        return depth;
    }

private:
    double below(const glm::dvec3& point, int a, int b, int c) const
    {
        const glm::dvec3 normal = glm::cross(corners_[b] - corners_[a], corners_[c] - corners_[a]);
        return -glm::dot(point - corners_[a], glm::normalize(normal));
    }

    std::array<glm::dvec3, 6> corners_;
};

PrismTexels twisted_prism(Random& random, double lean)
{
    const std::array<glm::vec3, 3> base{glm::vec3(0, 0, 0), glm::vec3(1, 0.1f, 0), glm::vec3(0.3f, 0.9f, 0)};
    std::array<glm::vec3, 3> top;
    for (std::size_t i = 0; i < 3; ++i) {
        top[i] = base[i] + glm::vec3(0, 0, 0.6f) + glm::vec3(random.in_box(glm::dvec3(-lean), glm::dvec3(lean)));
    }
    return prism_of(base, top);
}

TEST(PrismPlanes, SpansAreWhereThePlanesHoldThePrism)
{
    Random random(21);
    int inside = 0;
    int outside = 0;
    int twice = 0;
    for (int i = 0; i < 20000; ++i) {
        const PrismTexels prism = twisted_prism(random, 0.3);
        const PlanePrism truth(prism);
        const glm::dvec3 dir = random.direction();
        const glm::vec3 origin(random.in_box({-0.1, -0.1, -0.1}, {1.1, 1.0, 0.8}) - 3.0 * dir);
        const glm::vec3 dir_float(dir);
        const std::vector<PrismSpan> spans = prism_spans(prism, origin, dir_float, everywhere, true);
        twice += spans.size() > 1 ? 1 : 0;
        for (int k = 0; k < 20; ++k) {
            const double t = random.uniform(1.5, 4.5);
            const double depth = truth.depth(glm::dvec3(origin) + glm::dvec3(dir_float) * t);
            bool in_span = false;
            for (const PrismSpan& span : spans) {
                in_span = in_span || (t >= span.t_in && t <= span.t_out);
            }
            if (std::abs(depth) > 1e-5) {
                ASSERT_EQ(in_span, depth > 0.0) << "ray " << i << " at t = " << t << ", depth " << depth;
                (depth > 0.0 ? inside : outside) += 1;
            }
        }
    }
    EXPECT_GT(inside, 25000);
    EXPECT_GT(outside, 100000);
    EXPECT_GT(twice, 10);
}

TEST(PrismPlanes, FlatFinsAreTheirPlanes)
{
    // Equal directors make parallelograms of the fins: nothing is approximated.
    Random random(22);
    int found = 0;
    for (int i = 0; i < 20000; ++i) {
        const std::array<glm::vec3, 3> base{glm::vec3(0, 0, 0), glm::vec3(1, 0.125f, 0), glm::vec3(0.25f, 0.875f, 0)};
        const glm::vec3 director(0.125f, -0.25f, 0.5f);
        const PrismTexels prism = prism_of(base, {base[0] + director, base[1] + director, base[2] + director});
        const glm::dvec3 dir = random.direction();
        const glm::vec3 origin(random.in_box({0.0, 0.0, 0.0}, {1.0, 0.9, 0.5}) - 2.0 * dir);
        const std::vector<PrismSpan> exact = prism_spans(prism, origin, glm::vec3(dir), everywhere);
        const std::vector<PrismSpan> planes = prism_spans(prism, origin, glm::vec3(dir), everywhere, true);
        // A ray along a fin has its end anywhere on it.
        double flattest = 1.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 normal = glm::cross(glm::dvec3(base[(k + 1) % 3] - base[k]), glm::dvec3(director));
            flattest = std::min(flattest, std::abs(glm::dot(dir, normal)));
        }
        if (flattest < 0.003 || exact.size() != 1 || exact[0].t_out - exact[0].t_in < 0.01f || std::abs(dir.z) < 0.01) {
            continue;
        }
        ASSERT_EQ(planes.size(), 1u) << "ray " << i;
        const double error = 3.0 * PrismTruth(prism).coordinate_error(glm::dvec3(origin), dir, 0.5) + 1e-5;
        ASSERT_NEAR(planes[0].t_in, exact[0].t_in, 2.0 * error) << "ray " << i;
        ASSERT_NEAR(planes[0].t_out, exact[0].t_out, 2.0 * error) << "ray " << i;
        ASSERT_LE(glm::length(planes[0].q_in - exact[0].q_in), 8.0 * error) << "ray " << i;
        ASSERT_LE(glm::length(planes[0].q_out - exact[0].q_out), 8.0 * error) << "ray " << i;
        found += 1;
    }
    EXPECT_GT(found, 8000);
}

TEST(PrismPlanes, NeighborsShareTheirFins)
{
    // Through a closed shell spans follow one another: along a ray they cover what they add up to, and what bilinear fins
    // cover. Where one ends in a fin and the next begins, the texture goes on at its height.
    Random random(23);
    SurfaceMesh mesh = round_octahedron(2);
    for (const glm::vec3& position : mesh.positions) {
        mesh.normals.push_back(position + glm::vec3(random.in_box(glm::dvec3(-0.3), glm::dvec3(0.3))));
    }
    const Shell shell = mesh.shell(0.2f);
    int joints = 0;
    int goes_on = 0;
    double sum = 0.0;
    double covered = 0.0;
    double exact = 0.0;
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 dir = random.direction();
        const glm::vec3 origin(random.in_box(glm::dvec3(-1.1), glm::dvec3(1.1)) - 3.0 * dir);
        std::vector<PrismSpan> spans;
        for (const PrismTexels& prism : shell.prisms) {
            for (const PrismSpan& span : prism_spans(prism, origin, glm::vec3(dir), everywhere, true)) {
                spans.push_back(span);
                sum += span.t_out - span.t_in;
            }
            for (const PrismSpan& span : prism_spans(prism, origin, glm::vec3(dir), everywhere)) {
                exact += span.t_out - span.t_in;
            }
        }
        std::sort(spans.begin(), spans.end(), [](const PrismSpan& a, const PrismSpan& b) { return a.t_in < b.t_in; });
        float end = everywhere;
        for (std::size_t k = 0; k < spans.size(); ++k) {
            covered += std::max(0.0f, spans[k].t_out - std::max(spans[k].t_in, end));
            end = std::max(end, spans[k].t_out);
            const bool in_fin = spans[k].q_in.z > 0.01f && spans[k].q_in.z < 0.99f;
            if (k > 0 && in_fin && std::abs(spans[k].t_in - spans[k - 1].t_out) < 1e-5f) {
                joints += 1;
                goes_on += std::abs(spans[k].q_in.z - spans[k - 1].q_out.z) < 1e-4f ? 1 : 0;
            }
        }
    }
    EXPECT_GT(joints, 1500);
    EXPECT_GE(goes_on, 0.999 * joints);
    EXPECT_NEAR(sum, covered, 1e-4 * covered);
    EXPECT_NEAR(covered, exact, 1e-4 * exact);
}

}  // namespace
}  // namespace mesoshell
