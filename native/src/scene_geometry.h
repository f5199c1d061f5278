// What rays meet in a scene: shells, each in its own object space, and the meshes around them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/scene.h"

namespace mesoshell {

class MeshSet;

struct WorldRay {
    glm::dvec3 origin;
    glm::dvec3 dir;  // unit length
    double t_near = 0.0;
    double t_far = 0.0;  // may be infinite
};

struct WorldHit {
    bool hit = false;
    double t = 0.0;
    glm::dvec3 position{0.0};
    glm::dvec3 above{
        0.0};  // where shadow rays start: off the surface, outside a shell's solid or on the side of a mesh that is seen
    glm::vec3 normal{0.0f};  // unit length; out of a shell's solid, of a mesh toward the origin of the ray
    glm::vec3 base_color{0.0f};
    std::int32_t object_index = -1;
};

class SceneGeometry {
public:
    // The scene must be checked (scene_check.h) and live as long. Throws InvalidArgument for maps, settings and samples
    // that do not fit their traversals.
    explicit SceneGeometry(const Scene& scene);
    ~SceneGeometry();
    SceneGeometry(const SceneGeometry&) = delete;
    SceneGeometry& operator=(const SceneGeometry&) = delete;

    // The nearest of what the camera sees. Adds to `fetches` what it took. Any thread.
    WorldHit nearest(const WorldRay& ray, int& fetches) const;
    // Whether anything that casts shadows is met.
    bool occluded(const WorldRay& ray, int& fetches) const;

private:
    class PlacedShell;

    std::vector<std::unique_ptr<const PlacedShell>> shells_;
    std::shared_ptr<const MeshSet> seen_;
    std::shared_ptr<const MeshSet> casting_;  // often the same
};

}  // namespace mesoshell
