#include "scene_meshes.h"

#include <algorithm>
#include <array>
#include <utility>

#include "embree_scene.h"

namespace mesoshell {
namespace {

glm::vec3 unit_or(const glm::vec3& vector, const glm::vec3& otherwise)
{
    const float size = glm::length(vector);
    return size > 0.0f ? vector / size : otherwise;
}

glm::vec3 smooth_normal(const SceneMesh& mesh, std::uint32_t triangle, const glm::vec2& weights)
{
    const bool corners = mesh.normals.size() != mesh.positions.size();
    std::array<glm::vec3, 3> normals;
    for (int i = 0; i < 3; ++i) {
        const std::size_t place = corners ? 3 * static_cast<std::size_t>(triangle) + i : mesh.triangles[triangle][i];
        normals[i] = unit_or(mesh.normals[place], glm::vec3(0.0f));
    }
    return normals[0] * (1.0f - weights.x - weights.y) + normals[1] * weights.x + normals[2] * weights.y;
}

}  // namespace

MeshSet::MeshSet(std::vector<const SceneMesh*> which) : meshes_(std::move(which))
{
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (const SceneMesh* mesh : meshes_) {
        const auto first_vertex = static_cast<std::uint32_t>(positions.size());
        first_.push_back(static_cast<std::uint32_t>(triangles.size()));
        positions.insert(positions.end(), mesh->positions.begin(), mesh->positions.end());
        for (const glm::uvec3& triangle : mesh->triangles) {
            triangles.push_back(triangle + first_vertex);
        }
    }
    triangles_ = std::make_unique<TriangleScene>(positions, triangles);
}

MeshSet::~MeshSet() = default;

MeshHit MeshSet::nearest(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const
{
    const TriangleHit found = triangles_->intersect1(origin, dir, t_near, t_far);
    MeshHit hit;
    hit.hit = found.hit;
    if (!found.hit) {
        return hit;
    }
    const auto place = std::upper_bound(first_.begin(), first_.end(), found.triangle) - first_.begin() - 1;
    const SceneMesh& mesh = *meshes_[place];
    const std::uint32_t triangle = found.triangle - first_[place];
    hit.t = found.t;
    hit.flat_normal = unit_or(found.normal, -dir);
    hit.normal =
        mesh.normals.empty() ? hit.flat_normal : unit_or(smooth_normal(mesh, triangle, found.weights), hit.flat_normal);
    // Both sides look alike, as in Cycles: the smooth normal belongs to the side that its own triangle's points to.
    if (glm::dot(hit.normal, hit.flat_normal) < 0.0f) {
        hit.normal = -hit.normal;
    }
    if (glm::dot(hit.flat_normal, dir) > 0.0f) {
        hit.flat_normal = -hit.flat_normal;
        hit.normal = -hit.normal;
    }
    hit.base_color = mesh.colors.empty() ? mesh.base_color : mesh.colors[triangle];
    hit.object_index = mesh.object_index;
    return hit;
}

bool MeshSet::occluded(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const
{
    return triangles_->occluded1(origin, dir, t_near, t_far);
}

}  // namespace mesoshell
