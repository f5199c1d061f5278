// The meshes of a scene as one: a BVH over all their triangles, and what a hit on one of them looks like.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/scene.h"

namespace mesoshell {

class TriangleScene;

struct MeshHit {
    bool hit = false;
    float t = 0.0f;
    glm::vec3 flat_normal{0.0f};  // both of unit length and toward the origin of the ray
    glm::vec3 normal{0.0f};       // the flat one, or interpolated
    glm::vec3 lift{0.0f};         // to the round surface that smooth normals stand for, so that its facets do not shade it
    glm::vec3 base_color{0.0f};
    std::int32_t object_index = -1;
};

class MeshSet {
public:
    // The meshes that `which` names must live as long.
    explicit MeshSet(std::vector<const SceneMesh*> which);
    ~MeshSet();
    MeshSet(const MeshSet&) = delete;
    MeshSet& operator=(const MeshSet&) = delete;

    MeshHit nearest(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const;
    bool occluded(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const;

private:
    std::vector<const SceneMesh*> meshes_;
    std::vector<std::uint32_t> first_;  // of each mesh's triangles
    std::unique_ptr<TriangleScene> triangles_;
};

}  // namespace mesoshell
