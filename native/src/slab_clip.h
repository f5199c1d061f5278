// Polygons without what lies out of the slab.
#pragma once

#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

// The part of a triangle on one side of a plane z = level: 0, 3 or 4 corners become up to 5 after two planes.
inline std::vector<glm::vec3> clip_polygon(const std::vector<glm::vec3>& polygon, float level, float sign)
{
    std::vector<glm::vec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::vec3& a = polygon[i];
        const glm::vec3& b = polygon[(i + 1) % polygon.size()];
        const float side_a = (a.z - level) * sign;
        const float side_b = (b.z - level) * sign;
        if (side_a >= 0.0f) {
            kept.push_back(a);
        }
        if (side_a * side_b < 0.0f) {
            glm::vec3 crossing = glm::mix(a, b, side_a / (side_a - side_b));
            crossing.z = level;
            kept.push_back(crossing);
        }
    }
    return kept;
}

// The part of a triangle with 0 <= z <= height.
inline std::vector<glm::vec3> part_in_slab(const std::vector<glm::vec3>& triangle, float height)
{
    return clip_polygon(clip_polygon(triangle, 0.0f, 1.0f), height, -1.0f);
}

}  // namespace mesoshell
