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

struct SmoothPlace {
    glm::vec3 normal{0.0f};  // not of unit length
    glm::vec3 lift{0.0f};
};

// Where a triangle's corners have normals, and toward which side.
SmoothPlace smooth_place(const SceneMesh& mesh, std::uint32_t triangle, const glm::vec2& weights, float side)
{
    const bool corners = mesh.normals.size() != mesh.positions.size();
    const std::array<float, 3> shares{1.0f - weights.x - weights.y, weights.x, weights.y};
    const glm::uvec3& vertices = mesh.triangles[triangle];
    glm::vec3 point(0.0f);
    for (int i = 0; i < 3; ++i) {
        point += mesh.positions[vertices[i]] * shares[i];
    }
    SmoothPlace place;
    for (int i = 0; i < 3; ++i) {
        const std::size_t row = corners ? 3 * static_cast<std::size_t>(triangle) + i : vertices[i];
        const glm::vec3 normal = unit_or(mesh.normals[row], glm::vec3(0.0f)) * side;
        place.normal += normal * shares[i];
        // Hanika 2021, "Hacking the shadow terminator": out of the planes that the normals span, as the round surface is.
        place.lift -= normal * (shares[i] * std::min(glm::dot(point - mesh.positions[vertices[i]], normal), 0.0f));
    }
    return place;
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
    if (glm::dot(hit.flat_normal, dir) > 0.0f) {
        hit.flat_normal = -hit.flat_normal;
    }
    hit.normal = hit.flat_normal;
    if (!mesh.normals.empty()) {
        // Both sides look alike, as in Cycles: normals are those of the side that is seen.
        SmoothPlace place = smooth_place(mesh, triangle, found.weights, 1.0f);
        if (glm::dot(place.normal, hit.flat_normal) < 0.0f) {
            place = smooth_place(mesh, triangle, found.weights, -1.0f);
        }
        hit.normal = unit_or(place.normal, hit.flat_normal);
        hit.lift = place.lift;
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
