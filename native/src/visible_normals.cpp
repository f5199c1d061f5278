#include "visible_normals.h"

#include <algorithm>

#include "predicates.h"

namespace mesoshell {
namespace {

constexpr std::size_t most_tried = 16;
constexpr int steps = 2000;

double least_dot(const std::vector<glm::dvec3>& normals, const glm::dvec3& dir)
{
    double least = 1.0;
    for (const glm::dvec3& normal : normals) {
        least = std::min(least, glm::dot(normal, dir));
    }
    return least;
}

}  // namespace

glm::dvec3 most_visible_direction(const std::vector<glm::dvec3>& normals)
{
    glm::dvec3 best(0.0);
    double most = 0.0;
    const auto offer = [&](const glm::dvec3& dir) {
        const double size = glm::length(dir);
        if (size > 1e-12) {
            const double least = least_dot(normals, dir / size);
            if (least > most) {
                most = least;
                best = dir / size;
            }
        }
    };
    if (normals.size() > most_tried) {
        // The center of the smallest enclosing ball, approached by ever smaller steps toward the farthest (Badoiu and
        // Clarkson 2003).
        glm::dvec3 center(0.0);
        for (const glm::dvec3& normal : normals) {
            center += normal / static_cast<double>(normals.size());
        }
        for (int i = 1; i <= steps; ++i) {
            const auto farthest = std::min_element(
                normals.begin(), normals.end(),
                [&](const glm::dvec3& a, const glm::dvec3& b) { return glm::dot(a, center) < glm::dot(b, center); });
            center += (*farthest - center) / static_cast<double>(i + 1);
        }
        offer(center);
        return best;
    }
    // The narrowest cone touches one, two or three of them.
    for (std::size_t i = 0; i < normals.size(); ++i) {
        offer(normals[i]);
        for (std::size_t j = 0; j < i; ++j) {
            offer(normals[i] + normals[j]);
            for (std::size_t k = 0; k < j; ++k) {
                const glm::dvec3 axis = glm::cross(normals[j] - normals[i], normals[k] - normals[i]);
                offer(axis);
                offer(-axis);
            }
        }
    }
    return best;
}

glm::vec3 most_visible_normal(const Shell& shell, const VertexPrisms& prisms, std::uint32_t vertex)
{
    std::vector<glm::dvec3> normals;
    const auto point = [&](std::uint32_t prism, int corner) {
        return shell.positions[shell.topology->triangles[prism][corner]];
    };
    for (const std::uint32_t p : prisms.around(vertex)) {
        const glm::dvec3 a(point(p, 0));
        const glm::dvec3 normal = glm::cross(glm::dvec3(point(p, 1)) - a, glm::dvec3(point(p, 2)) - a);
        const double size = glm::length(normal);
        if (size > 0.0) {
            normals.push_back(normal / size);
        }
    }
    const glm::vec3 dir(most_visible_direction(normals));
    for (const std::uint32_t p : prisms.around(vertex)) {
        if (determinant_sign({point(p, 0), point(p, 1)}, {point(p, 0), point(p, 2)}, {glm::vec3(0.0f), dir}) <= 0) {
            return glm::vec3(0.0f);
        }
    }
    return dir;
}

}  // namespace mesoshell
