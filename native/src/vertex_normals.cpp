#include "vertex_normals.h"

#include <cmath>

namespace mesoshell {

std::vector<glm::vec3> angle_weighted_normals(const Surface& surface)
{
    std::vector<glm::vec3> normals(surface.positions.size(), glm::vec3(0.0f));
    std::size_t first = 0;
    for (const std::int32_t size : surface.face_sizes) {
        for (std::int32_t i = 0; i < size; ++i) {
            const std::int32_t vertex = surface.corners[first + i];
            const glm::vec3& p = surface.positions[vertex];
            const glm::vec3 next = surface.positions[surface.corners[first + (i + 1) % size]] - p;
            const glm::vec3 before = surface.positions[surface.corners[first + (i + size - 1) % size]] - p;
            const glm::vec3 normal = glm::cross(next, before);
            const float area = glm::length(normal);
            if (area > 0.0f) {
                normals[vertex] += normal / area * std::atan2(area, glm::dot(next, before));
            }
        }
        first += static_cast<std::size_t>(size);
    }
    for (glm::vec3& normal : normals) {
        const float size = glm::length(normal);
        normal = size > 0.0f ? normal / size : glm::vec3(0.0f);
    }
    return normals;
}

}  // namespace mesoshell
