// The traversal `sdf` against Embree on the realized mesh, with which it shares no code.
#include <algorithm>
#include <cmath>

#include "camera.h"
#include "check.h"
#include "mesoshell/realize.h"
#include "meshes.h"
#include "render_with.h"

namespace mesoshell {
namespace {

// How a drawn torus differs from Embree's picture of the tile's triangles warped into the same shell.
struct Difference {
    double silhouette_iou;
    double median_error;   // of the distance, object units
    double error_95;       // at most so much for 95 % of the pixels that both hit
    double median_cosine;  // between normals
    std::size_t pixels;    // that both hit
};

Difference difference_on(const Shell& shell, const Sample& sample, bool perspective)
{
    const Map map = sdf_map(sample, {40, 40, 25});
    Job job;
    const RealizedMesh mesh = realize(shell, sample, job);
    const Camera camera(perspective, {1.5, -2.4, 2.2}, {0, 0, 0}, perspective ? 0.55 : 1.9, {160, 128});
    const Rendering drawn = render_with(shell, map, camera.view(), sdf_traversal);
    const Trace truth = trace(mesh.positions, mesh.triangles, camera.view(), job);
    int either = 0;
    std::vector<double> errors;
    std::vector<double> cosines;
    for (std::size_t i = 0; i < drawn.hit.size(); ++i) {
        either += drawn.hit[i] | truth.hit[i];
        if ((drawn.hit[i] & truth.hit[i]) != 0) {
            errors.push_back(std::abs(drawn.distance[i] - truth.distance[i]));
            cosines.push_back(glm::dot(drawn.normal[i], truth.normal[i]));
        }
    }
    EXPECT_GT(errors.size(), 1000u);
    std::sort(errors.begin(), errors.end());
    std::sort(cosines.begin(), cosines.end());
    const std::size_t count = errors.size();
    return {static_cast<double>(count) / either, errors[count / 2], errors[count * 95 / 100], cosines[count / 2], count};
}

// Tiles are 2 pi / 9 = 0.7 wide around the axis and 0.42 around the tube, 0.5 tall for a height of 1.
Difference torus_difference(int around, int along, bool perspective)
{
    return difference_on(torus(1.0f, 0.4f, around, along, 9.0f, 6.0f).shell(0.3f),
                         sphere({0.5f, 0.5f, 0.32f}, 0.24f, 24, 32).sample(0.6f), perspective);
}

TEST(Render, SdfAgreesWithTheRealizedTorus)
{
    for (const bool perspective : {true, false}) {
        const Difference difference = torus_difference(96, 64, perspective);
        EXPECT_GT(difference.pixels, 3000u);
        // The law of the project. Balls are 10 pixels wide: one of a hundred pixels is a fortieth of a pixel all around
        // them.
        EXPECT_GE(difference.silhouette_iou, 0.99);
        // A voxel is 1/40 of a tile, about 0.5 / 40 in space. Sphere tracing ends 0.02 voxels early, and interpolating
        // a distance at radius r = 0.24 errs by 3 h^2 / (8 r) = 0.04 voxels: less than a tenth, the ray being aslant
        // and the chord not the curve.
        EXPECT_LT(difference.median_error, 0.1 * 0.5 / 40);
        // Facets turn by pi / 24 from one to the next, so normals of the smooth field differ by a third of that or less
        // at the median.
        EXPECT_GT(difference.median_cosine, std::cos(3.14159 / 24 / 2));
    }
}

TEST(Render, SdfAgreesWithTheRealizedTorusWhoseTopIsRelaxed)
{
    const SurfaceMesh mesh = torus(1.0f, 0.4f, 96, 64, 9.0f, 6.0f);
    ShellOptions options;
    options.thickness = 0.3f;
    options.relax_steps = 30;
    const Shell shell = build_shell(mesh.surface(), options);
    double most = 0.0;
    for (std::size_t i = 0; i < shell.top_uvs.size(); ++i) {
        most = std::max(most, static_cast<double>(glm::length(shell.top_uvs[i] - shell.topology->uvs[i])));
    }
    EXPECT_GT(most, 0.05);  // tiles: four of the field's voxels
    const Difference difference = difference_on(shell, sphere({0.5f, 0.5f, 0.32f}, 0.24f, 24, 32).sample(0.6f), true);
    EXPECT_GE(difference.silhouette_iou, 0.99);
    EXPECT_LT(difference.median_error, 0.1 * 0.5 / 40);
    EXPECT_GT(difference.median_cosine, std::cos(3.14159 / 24 / 2));
}

TEST(Render, SdfAgreesWithARealizedPartThatThinsOut)
{
    // Half of the torus, cut where its border cuts tiles and balls, with a thickness that falls to 0 around it: prisms
    // become wedges, then vanish. The shell is inward, so that the balls' tops lie below the surface.
    const SurfaceMesh mesh = torus(1.0f, 0.4f, 96, 64, 9.0f, 6.0f);
    std::vector<float> factors;
    for (const glm::vec3& p : mesh.positions) {
        factors.push_back(std::clamp(0.5f - p.y, 0.0f, 1.0f));
    }
    std::vector<std::uint8_t> covered(mesh.face_sizes.size());
    for (std::size_t i = 0; i < covered.size(); ++i) {
        covered[i] = i % 96 >= 40 ? 1 : 0;
    }
    ShellOptions options;
    options.thickness = 0.25f;
    options.thickness_factors = factors;
    options.covered = covered;
    options.shift = -1.0f;
    const Shell shell = build_shell(mesh.surface(), options);
    int wedges = 0;
    for (const glm::uvec3& t : shell.topology->triangles) {
        wedges += shell.thickness[t.x] * shell.thickness[t.y] * shell.thickness[t.z] == 0.0f ? 1 : 0;
    }
    EXPECT_GT(wedges, 50);
    const Difference difference = difference_on(shell, sphere({0.5f, 0.5f, 0.32f}, 0.24f, 24, 32).sample(0.6f), true);
    EXPECT_GE(difference.silhouette_iou, 0.99);
    EXPECT_LT(difference.median_error, 0.1 * 0.5 / 40);
}

TEST(Render, SdfFollowsCurvesWhateverThePrismsSize)
{
    // With one straight segment a prism, errors would go with the square of its size.
    const Difference coarse = torus_difference(36, 24, true);
    const Difference fine = torus_difference(72, 48, true);
    EXPECT_GT(fine.pixels, 3000u);
    EXPECT_LT(coarse.error_95, 2.0 * fine.error_95);
}

}  // namespace
}  // namespace mesoshell
