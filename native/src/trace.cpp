// The picture of a triangle mesh (realize.h).
#include <algorithm>
#include <limits>
#include <string>

#include <glm/gtc/matrix_access.hpp>

#include "embree_scene.h"
#include "mesoshell/error.h"
#include "mesoshell/realize.h"
#include "parallel.h"
#include "view_rays.h"

namespace mesoshell {

Trace trace(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, const View& view, Job& job)
{
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (std::max(triangles[i].x, std::max(triangles[i].y, triangles[i].z)) >= positions.size()) {
            throw InvalidArgument("triangle " + std::to_string(i) + " uses a vertex that does not exist; there are " +
                                  std::to_string(positions.size()));
        }
    }
    const ViewRays rays(view);
    const TriangleScene scene(positions, triangles);
    const std::size_t pixels = static_cast<std::size_t>(view.size.x) * view.size.y;
    Trace picture;
    picture.size = view.size;
    picture.hit.assign(pixels, 0);
    picture.distance.assign(pixels, std::numeric_limits<float>::infinity());
    picture.normal.assign(pixels, glm::vec3(0.0f));
    const glm::dvec4 near_row = glm::row(view.clip_from_object, 2) + glm::row(view.clip_from_object, 3);
    parallel_for(job, view.size.y, [&](int y) {
        for (int x = 0; x < view.size.x; ++x) {
            const PixelRay ray = rays.at(x, y);
            // The near plane is where clip z + w is 0.
            const double at_origin = glm::dot(near_row, glm::dvec4(ray.origin, 1.0));
            const double along = glm::dot(near_row, glm::dvec4(ray.dir, 0.0));
            const float tnear = static_cast<float>(std::max(-at_origin / along, 0.0));
            const TriangleHit hit =
                scene.intersect1(ray.origin, ray.dir, tnear, std::numeric_limits<float>::infinity());
            if (hit.hit) {
                const std::size_t pixel = static_cast<std::size_t>(y) * view.size.x + x;
                picture.hit[pixel] = 1;
                picture.distance[pixel] = hit.t;
                picture.normal[pixel] = glm::normalize(hit.normal);
            }
        }
    });
    return picture;
}

}  // namespace mesoshell
