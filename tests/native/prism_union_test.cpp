// The prisms of a shell fill it: without a gap, and without an overlap.
#include <algorithm>
#include <cmath>

#include "check.h"
#include "mesoshell/render.h"
#include "meshes.h"
#include "prism_truth.h"

namespace mesoshell {
namespace {

// Crossings of a ray with the triangle of columns at one height (Möller and Trumbore 1997), in double precision.
void add_crossing(const PrismTruth& prism, double w, const glm::dvec3& origin, const glm::dvec3& dir,
                  std::vector<double>& out)
{
    const glm::dvec3 a = prism.column(0, w);
    const glm::dvec3 ab = prism.column(1, w) - a;
    const glm::dvec3 ac = prism.column(2, w) - a;
    const glm::dvec3 p = glm::cross(dir, ac);
    const double det = glm::dot(ab, p);
    const glm::dvec3 s = origin - a;
    const double u = glm::dot(s, p) / det;
    const glm::dvec3 q = glm::cross(s, ab);
    const double v = glm::dot(dir, q) / det;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0) {
        out.push_back(glm::dot(ac, q) / det);
    }
}

struct Stretch {
    double t_in;
    double t_out;
    double error_in;
    double error_out;
};

TEST(PrismUnion, ClosedShellHasNoGapsAlongRays)
{
    // Between the surface and the offset surface, both closed: a ray enters and leaves the shell where it crosses
    // either, and in between the spans of the prisms must follow one another.
    const Shell shell = round_octahedron(2).shell(0.2f);
    ASSERT_EQ(shell.prisms.size(), 128u);
    std::vector<PrismTruth> truths;
    std::vector<glm::dvec4> balls;  // around each prism
    for (const PrismTexels& prism : shell.prisms) {
        truths.emplace_back(prism);
        const glm::dvec3 middle = truths.back().position({1.0 / 3.0, 1.0 / 3.0, 0.5});
        balls.emplace_back(middle, truths.back().reach(middle) + 1e-3);
    }
    Random random(1);
    int rays = 0;
    int joints = 0;
    double covered = 0.0;
    for (int i = 0; i < 100000; ++i) {
        const glm::dvec3 dir_exact = random.direction();
        const glm::vec3 dir(dir_exact);
        const glm::vec3 origin(random.in_box(glm::dvec3(-1.25), glm::dvec3(1.25)) - 3.0 * dir_exact);
        const glm::dvec3 o(origin);
        const glm::dvec3 d(dir);
        std::vector<Stretch> spans;
        std::vector<double> crossings;
        for (std::size_t p = 0; p < shell.prisms.size(); ++p) {
            const glm::dvec3 offset = glm::dvec3(balls[p]) - o;
            if (glm::dot(offset, offset) - std::pow(glm::dot(offset, d), 2) > balls[p].w * balls[p].w) {
                continue;
            }
            add_crossing(truths[p], 0.0, o, d, crossings);
            add_crossing(truths[p], 1.0, o, d, crossings);
            for (const PrismSpan& span : prism_spans(shell.prisms[p], origin, dir, everywhere)) {
                const auto error = [&](const glm::vec3& q) {
                    return 3.0 * truths[p].coordinate_error(o, d, q.z) * truths[p].size() + 8 * 0x1p-21;
                };
                spans.push_back({span.t_in, span.t_out, error(span.q_in), error(span.q_out)});
            }
        }
        std::sort(crossings.begin(), crossings.end());
        std::sort(spans.begin(), spans.end(), [](const Stretch& a, const Stretch& b) { return a.t_in < b.t_in; });
        // A ray that grazes an edge of either surface crosses it once or thrice in one precision and not in the other.
        bool grazing = crossings.size() % 2 != 0;
        for (std::size_t k = 1; k < crossings.size(); ++k) {
            grazing = grazing || crossings[k] - crossings[k - 1] < 1e-3;
        }
        if (grazing) {
            continue;
        }
        rays += 1;
        std::size_t next = 0;
        for (std::size_t k = 0; k < crossings.size(); k += 2) {
            ASSERT_LT(next, spans.size()) << "ray " << i;
            ASSERT_NEAR(spans[next].t_in, crossings[k], spans[next].error_in + 1e-6) << "ray " << i;
            while (spans[next].t_out < crossings[k + 1] - spans[next].error_out - 1e-6 && next + 1 < spans.size()) {
                ASSERT_NEAR(spans[next].t_out, spans[next + 1].t_in, spans[next].error_out + spans[next + 1].error_in)
                    << "ray " << i << " has a gap or an overlap";
                next += 1;
                joints += 1;
            }
            ASSERT_NEAR(spans[next].t_out, crossings[k + 1], spans[next].error_out + 1e-6) << "ray " << i;
            covered += crossings[k + 1] - crossings[k];
            next += 1;
            // What an edge of the surface shaves off, shorter than rounding.
            while (next < spans.size() && spans[next].t_out - crossings[k + 1] < spans[next].error_out + 1e-6) {
                next += 1;
            }
        }
        ASSERT_EQ(next, spans.size()) << "ray " << i;
    }
    EXPECT_GT(rays, 95000);
    EXPECT_GT(joints, 50000);
    EXPECT_GT(covered, 10000.0);
}

TEST(PrismUnion, RayInTheFinBetweenTwoPrismsIsSeenByOneOfThem)
{
    // Pixel centers fall exactly onto the edges of a symmetric mesh in a symmetric view; there must be no hole.
    const Shell shell = flat_grid(2, 2, 1.0f, 1.0f).shell(0.25f);
    const auto length_along = [&](const glm::vec3& origin, const glm::vec3& dir) {
        float longest = 0.0f;
        for (const PrismTexels& prism : shell.prisms) {
            for (const PrismSpan& span : prism_spans(prism, origin, dir, everywhere)) {
                longest = std::max(longest, span.t_out - span.t_in);
            }
        }
        return longest;
    };
    for (const glm::vec2 place : {glm::vec2(0.5f, 0.3f), {0.3f, 0.5f}, {0.25f, 0.25f}, {0.5f, 0.5f}, {0.75f, 0.25f}}) {
        EXPECT_NEAR(length_along({place, 2.0f}, {0, 0, -1}), 0.25f, 1e-5f) << "at " << place.x << " " << place.y;
        EXPECT_NEAR(length_along({place, -2.0f}, {0, 0, 1}), 0.25f, 1e-5f) << "at " << place.x << " " << place.y;
    }
    // Aslant, but still in the plane x = 0.5 between the prisms.
    const float half = std::sqrt(0.5f);
    EXPECT_NEAR(length_along({0.5f, 2.05f, 2.0f}, {0, -half, -half}), 0.25f / half, 1e-4f);
}

}  // namespace
}  // namespace mesoshell
