// Normals of the traversals that read a map: where the shell cuts the solid, and against those of `exact`.
#include <algorithm>
#include <cmath>
#include <vector>

#include "camera.h"
#include "check.h"
#include "mesoshell/traversal.h"
#include "meshes.h"
#include "render_with.h"

namespace mesoshell {
namespace {

constexpr Traversal entry_aware[] = {Traversal::sdf, Traversal::march};

TEST(Normals, WhereTheShellCutsTheSolidTheyAreTheCuts)
{
    // Texture space is object space; a slab cut by the border and by the bottom, so that the solid is a box.
    const float height = 0.5f;
    const double above = 0.35;
    const Sample sample = slab(-0.4f, static_cast<float>(above)).sample(height);
    const Shell shell = flat_grid(3, 2, 1.0f, 1.0f).shell(height);
    const Map map = sdf_map(sample, {16, 16, 17});
    const glm::dvec3 high(1.0, 1.0, above);
    for (const Traversal traversal : entry_aware) {
        glm::ivec3 seen(0);
        for (const glm::dvec3 eye : {glm::dvec3(1.9, -1.1, 1.2), {-1.4, 1.8, 0.3}, {0.9, 0.7, -2.0}}) {
            const Camera camera(true, eye, {0.47, 0.52, 0.2}, 0.45, {48, 48});
            const Rendering picture = render_with(shell, map, camera.view(), static_cast<int>(traversal));
            for (std::size_t i = 0; i < picture.hit.size(); ++i) {
                if (picture.hit[i] == 0) {
                    continue;
                }
                const CameraRay ray = camera.ray(static_cast<int>(i) % 48, static_cast<int>(i) / 48);
                const glm::dvec3 place = ray.origin + ray.dir * static_cast<double>(picture.distance[i]);
                // On a face that is a cut, and not within half a voxel of another: near the solid's own surface the hit
                // counts as that.
                const glm::dvec3 from_face = glm::min(glm::abs(place), glm::abs(high - place));
                int axis = 0;
                int near = 0;
                for (int k = 0; k < 3; ++k) {
                    near += from_face[k] < 0.5 / 16.0 ? 1 : 0;
                    axis = from_face[k] < from_face[axis] ? k : axis;
                }
                if (near != 1 || (axis == 2 && place.z > 0.5 * above)) {
                    continue;
                }
                glm::vec3 normal(0.0f);
                normal[axis] = place[axis] < 0.5 * high[axis] ? -1.0f : 1.0f;
                ASSERT_LT(glm::length(picture.normal[i] - normal), 1e-3f) << static_cast<int>(traversal);
                seen[axis] += 1;
            }
        }
        EXPECT_GT(std::min(seen.x, std::min(seen.y, seen.z)), 100);
    }
}

// Balls with so many faces that these turn by two or three degrees, one of them cut by a planar shell's border.
TEST(Normals, AreThoseOfTheTrianglesToTwoDegreesInTheMean)
{
    const Mesh balls = merged(sphere({0.4f, 0.4f, 0.32f}, 0.26f, 90, 140), sphere({0.92f, 0.92f, 0.2f}, 0.15f, 60, 100));
    const Sample sample = balls.sample(0.6f);
    const Map map = sdf_map(sample, {64, 64, 39});
    struct Base {
        Shell shell;
        Camera camera;
    };
    const Base bases[] = {
        {flat_grid(5, 4, 2.5f, 2.0f).shell(0.6f), Camera(true, {3.5, -3.0, 1.6}, {1.25, 1.0, 0.2}, 0.3, {96, 96})},
        {torus(1.0f, 0.4f, 36, 20, 9.0f, 6.0f).shell(0.3f), Camera(true, {1.5, -2.4, 2.2}, {0, 0, 0}, 0.5, {96, 96})},
    };
    for (const Base& base : bases) {
        const Rendering truth = render_exactly(base.shell, sample, base.camera.view());
        for (const Traversal traversal : entry_aware) {
            const Rendering drawn = render_with(base.shell, map, base.camera.view(), static_cast<int>(traversal));
            double sum = 0.0;
            int count = 0;
            for (std::size_t i = 0; i < truth.hit.size(); ++i) {
                if ((truth.hit[i] & drawn.hit[i]) != 0) {
                    const double cosine = glm::dot(glm::dvec3(truth.normal[i]), glm::dvec3(drawn.normal[i]));
                    sum += glm::degrees(std::acos(std::clamp(cosine, -1.0, 1.0)));
                    count += 1;
                }
            }
            ASSERT_GT(count, 1500);
            EXPECT_LT(sum / count, 2.0) << static_cast<int>(traversal);
        }
    }
}

}  // namespace
}  // namespace mesoshell
