#include "scene_geometry.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "mesoshell/render.h"
#include "scene_meshes.h"
#include "shell_tracer.h"

namespace mesoshell {
namespace {

// Of coordinates as large as these, how far off a flat triangle its hit may be found: some roundings of single precision.
constexpr double hit_rounding = 8.0 * 0x1p-23;

std::vector<const SceneMesh*> meshes_with(const Scene& scene, bool SceneMesh::*visible)
{
    std::vector<const SceneMesh*> meshes;
    for (const SceneMesh& mesh : scene.meshes) {
        if (mesh.*visible && !mesh.triangles.empty()) {
            meshes.push_back(&mesh);
        }
    }
    return meshes;
}

}  // namespace

// A shell and the way into its object space and back.
class SceneGeometry::PlacedShell {
public:
    explicit PlacedShell(const SceneShell& shell)
        : shell_(shell), object_from_world_(glm::inverse(shell.world_from_object)),
          normal_from_object_(glm::transpose(glm::inverse(glm::dmat3(shell.world_from_object)))),
          // What is seen from where is the ray's affair.
          tracer_(*shell.shell, *shell.map, complete_params(shell.settings, *shell.map, glm::dmat4(1.0)), shell.sample)
    {
    }

    bool visible_camera() const { return shell_.visible_camera; }
    bool visible_shadow() const { return shell_.visible_shadow; }

    WorldHit nearest(const WorldRay& ray, int& fetches) const
    {
        const ObjectRay inside = object_ray(ray);
        const ShellTraceHit found = tracer_.nearest(inside.origin, inside.dir, inside.t_near, inside.t_far);
        fetches += found.fetches;
        WorldHit hit;
        hit.hit = found.hit;
        if (!found.hit) {
            return hit;
        }
        hit.t = found.t / inside.scale;
        hit.position = ray.origin + ray.dir * hit.t;
        hit.above = hit.position + glm::dmat3(shell_.world_from_object) * glm::dvec3(found.normal * found.clearance);
        hit.normal = glm::vec3(glm::normalize(normal_from_object_ * glm::dvec3(found.normal)));
        hit.base_color = shell_.base_color;
        hit.object_index = shell_.object_index;
        return hit;
    }

    bool occluded(const WorldRay& ray, int& fetches) const
    {
        const ObjectRay inside = object_ray(ray);
        const ShellOcclusion found = tracer_.any(inside.origin, inside.dir, inside.t_near, inside.t_far);
        fetches += found.fetches;
        return found.hit;
    }

private:
    struct ObjectRay {
        glm::vec3 origin;
        glm::vec3 dir;  // unit length
        float t_near;
        float t_far;
        double scale;  // object units a world unit along the ray
    };

    ObjectRay object_ray(const WorldRay& ray) const
    {
        const glm::dvec3 dir = glm::dmat3(object_from_world_) * ray.dir;
        const double scale = glm::length(dir);
        return {glm::vec3(glm::dvec3(object_from_world_ * glm::dvec4(ray.origin, 1.0))), glm::vec3(dir / scale),
                static_cast<float>(ray.t_near * scale), static_cast<float>(ray.t_far * scale), scale};
    }

    const SceneShell& shell_;
    glm::dmat4 object_from_world_;
    glm::dmat3 normal_from_object_;
    ShellTracer tracer_;
};

SceneGeometry::SceneGeometry(const Scene& scene)
{
    for (std::size_t i = 0; i < scene.shells.size(); ++i) {
        try {
            shells_.push_back(std::make_unique<const PlacedShell>(scene.shells[i]));
        } catch (const InvalidArgument& problem) {
            throw InvalidArgument("shells[" + std::to_string(i) + "]: " + problem.what());
        }
    }
    std::vector<const SceneMesh*> seen = meshes_with(scene, &SceneMesh::visible_camera);
    std::vector<const SceneMesh*> casting = meshes_with(scene, &SceneMesh::visible_shadow);
    const bool same = seen == casting;
    seen_ = std::make_shared<const MeshSet>(std::move(seen));
    casting_ = same ? seen_ : std::make_shared<const MeshSet>(std::move(casting));
}

SceneGeometry::~SceneGeometry() = default;

WorldHit SceneGeometry::nearest(const WorldRay& ray, int& fetches) const
{
    WorldHit nearest;
    WorldRay rest = ray;
    const MeshHit found = seen_->nearest(glm::vec3(ray.origin), glm::vec3(ray.dir),
                                         static_cast<float>(std::max(ray.t_near, 0.0)), static_cast<float>(ray.t_far));
    if (found.hit) {
        nearest.hit = true;
        nearest.t = found.t;
        nearest.position = ray.origin + ray.dir * nearest.t;
        const glm::dvec3 largest = glm::abs(nearest.position) + glm::abs(ray.origin);
        const double rounding = hit_rounding * (largest.x + largest.y + largest.z);
        nearest.above = nearest.position + glm::dvec3(found.lift) + glm::dvec3(found.flat_normal) * rounding;
        nearest.normal = found.normal;
        nearest.base_color = found.base_color;
        nearest.object_index = found.object_index;
        rest.t_far = nearest.t;
    }
    for (const auto& shell : shells_) {
        if (!shell->visible_camera()) {
            continue;
        }
        const WorldHit hit = shell->nearest(rest, fetches);
        if (hit.hit && hit.t < rest.t_far) {
            nearest = hit;
            rest.t_far = hit.t;
        }
    }
    return nearest;
}

bool SceneGeometry::occluded(const WorldRay& ray, int& fetches) const
{
    if (casting_->occluded(glm::vec3(ray.origin), glm::vec3(ray.dir), static_cast<float>(ray.t_near),
                           static_cast<float>(ray.t_far))) {
        return true;
    }
    for (const auto& shell : shells_) {
        if (shell->visible_shadow() && shell->occluded(ray, fetches)) {
            return true;
        }
    }
    return false;
}

}  // namespace mesoshell
