// The traversal `exact` against Embree on the realized mesh, with which it shares no code.
#include <algorithm>
#include <cmath>
#include <vector>

#include "camera.h"
#include "check.h"
#include "mesoshell/realize.h"
#include "meshes.h"
#include "render_with.h"

namespace mesoshell {
namespace {

// How two pictures of a shell differ.
struct Difference {
    double silhouette_iou;
    double depth_99;  // error of the distance, object units, of 99 % of the pixels that both hit
    double angle_99;  // degrees between their normals
};

Difference difference_of(const Shell& shell, const Sample& sample, const Camera& camera)
{
    Job job;
    const RealizedMesh mesh = realize(shell, sample, job);
    const Rendering drawn = render_exactly(shell, sample, camera.view());
    const Trace truth = trace(mesh.positions, mesh.triangles, camera.view(), job);
    int either = 0;
    std::vector<double> errors;
    std::vector<double> angles;
    for (std::size_t i = 0; i < drawn.hit.size(); ++i) {
        either += drawn.hit[i] | truth.hit[i];
        if ((drawn.hit[i] & truth.hit[i]) != 0) {
            errors.push_back(std::abs(drawn.distance[i] - truth.distance[i]));
            const double cosine = glm::dot(glm::dvec3(drawn.normal[i]), glm::dvec3(truth.normal[i]));
            angles.push_back(glm::degrees(std::acos(std::clamp(cosine, -1.0, 1.0))));
        }
    }
    EXPECT_GT(errors.size(), 5000u);
    std::sort(errors.begin(), errors.end());
    std::sort(angles.begin(), angles.end());
    const std::size_t count = errors.size();
    return {static_cast<double>(count) / either, errors[count * 99 / 100], angles[count * 99 / 100]};
}

Mesh two_balls()
{
    return merged(sphere({0.5f, 0.5f, 0.3f}, 0.26f, 12, 16), sphere({0.95f, 0.1f, 0.2f}, 0.15f, 8, 12));
}

// The law of the project, on tiles of about 0.5 in space.
void check_law(const Shell& shell, const glm::dvec3& eye, double half_height)
{
    const Difference difference = difference_of(shell, two_balls().sample(0.6f), Camera(true, eye, {0, 0, 0}, half_height, {256, 256}));
    EXPECT_GE(difference.silhouette_iou, 0.998);
    EXPECT_LT(difference.depth_99, 1e-3);
    EXPECT_LT(difference.angle_99, 1.5);
}

TEST(ExactTruth, Torus)
{
    check_law(torus(1.0f, 0.4f, 24, 16, 9.0f, 6.0f).shell(0.3f), {1.5, -2.4, 2.2}, 0.55);
}

}  // namespace
}  // namespace mesoshell
