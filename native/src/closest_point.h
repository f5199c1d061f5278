// The point of a triangle closest to another point.
#pragma once

#include <glm/glm.hpp>

namespace mesoshell {

struct TrianglePoint {
    float squared = 0.0f;         // distance
    glm::vec2 weights{0.0f};      // of the corners b and c; a has the rest
};

// Ericson 2004, "Real-Time Collision Detection", section 5.1.5: the closest point by Voronoi regions.
inline TrianglePoint closest_point(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c)
{
    const auto found = [](const glm::vec3& v, float weight_b, float weight_c) {
        return TrianglePoint{glm::dot(v, v), {weight_b, weight_c}};
    };
    const glm::vec3 ab = b - a;
    const glm::vec3 ac = c - a;
    const glm::vec3 ap = p - a;
    const float d1 = glm::dot(ab, ap);
    const float d2 = glm::dot(ac, ap);
    if (d1 <= 0.0f && d2 <= 0.0f) {
        return found(ap, 0.0f, 0.0f);
    }
    const glm::vec3 bp = p - b;
    const float d3 = glm::dot(ab, bp);
    const float d4 = glm::dot(ac, bp);
    if (d3 >= 0.0f && d4 <= d3) {
        return found(bp, 1.0f, 0.0f);
    }
    const glm::vec3 cp = p - c;
    const float d5 = glm::dot(ab, cp);
    const float d6 = glm::dot(ac, cp);
    if (d6 >= 0.0f && d5 <= d6) {
        return found(cp, 0.0f, 1.0f);
    }
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f) {
        const float share = d1 / (d1 - d3);
        return found(ap - ab * share, share, 0.0f);
    }
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f) {
        const float share = d2 / (d2 - d6);
        return found(ap - ac * share, 0.0f, share);
    }
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0.0f && d4 - d3 >= 0.0f && d5 - d6 >= 0.0f) {
        const float share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return found(bp - (c - b) * share, 1.0f - share, share);
    }
    const float scale = 1.0f / (va + vb + vc);
    return found(ap - ab * (vb * scale) - ac * (vc * scale), vb * scale, vc * scale);
}

inline float squared_distance(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c)
{
    return closest_point(p, a, b, c).squared;
}

}  // namespace mesoshell
