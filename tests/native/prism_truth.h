// A prism and a ray in double precision: the forward map, its inverse one height at a time, and how far single
// precision may be off.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/shell.h"

namespace mesoshell {

// A near plane behind everything.
constexpr float everywhere = -1e30f;

inline PrismTexels prism_of(const std::array<glm::vec3, 3>& base, const std::array<glm::vec3, 3>& top)
{
    PrismTexels texels{};
    for (std::size_t i = 0; i < 3; ++i) {
        texels[i] = glm::vec4(base[i], 0.0f);
        texels[i + 3] = glm::vec4(top[i], 0.0f);
    }
    return texels;
}

// (u, v) of prism coordinates, tiles.
inline glm::dvec2 texture_at(const PrismTexels& t, const glm::dvec3& q)
{
    const double u[6] = {t[0].w, t[1].w, t[2].w, t[3].w, t[4].w, t[5].w};
    const double v[6] = {t[6].x, t[6].y, t[6].z, t[6].w, t[7].x, t[7].y};
    const double weights[3] = {1.0 - q.x - q.y, q.x, q.y};
    glm::dvec2 sum(0.0);
    for (int i = 0; i < 3; ++i) {
        sum += weights[i] * ((1.0 - q.z) * glm::dvec2(u[i], v[i]) + q.z * glm::dvec2(u[i + 3], v[i + 3]));
    }
    return sum;
}

class PrismTruth {
public:
    explicit PrismTruth(const PrismTexels& texels)
    {
        for (std::size_t i = 0; i < 3; ++i) {
            base_[i] = glm::dvec3(texels[i]);
            director_[i] = glm::dvec3(texels[i + 3]) - base_[i];
        }
    }

    glm::dvec3 column(std::size_t i, double w) const { return base_[i] + director_[i] * w; }

    glm::dvec3 position(const glm::dvec3& q) const
    {
        return column(0, q.z) * (1.0 - q.x - q.y) + column(1, q.z) * q.x + column(2, q.z) * q.y;
    }

    struct Place {
        glm::dvec3 q{0.0};
        double depth = -1.0;
    };

    // How deep a point lies inside, as the least of its weights and of the distances of its height from 0 and 1;
    // negative outside, -1 where no height within [-0.1, 1.1] has the point. The heights are sought by bisection of the
    // side on which the point lies of the triangle at that height.
    double depth(const glm::dvec3& point) const { return locate(point).depth; }

    // The same with the point's prism coordinates.
    Place locate(const glm::dvec3& point) const
    {
        constexpr int steps = 48;
        Place deepest;
        double w_before = -0.1;
        double side_before = side_at(point, w_before);
        for (int i = 1; i <= steps; ++i) {
            const double w = -0.1 + 1.2 * i / steps;
            const double side = side_at(point, w);
            if ((side < 0.0) != (side_before < 0.0)) {
                double low = w_before;
                double high = w;
                for (int k = 0; k < 50; ++k) {
                    const double middle = 0.5 * (low + high);
                    ((side_at(point, middle) < 0.0) == (side_before < 0.0) ? low : high) = middle;
                }
                const Place place = place_at(point, low);
                if (place.depth > deepest.depth) {
                    deepest = place;
                }
            }
            w_before = w;
            side_before = side;
        }
        return deepest;
    }

    // Twice the area of the triangle at height w as seen along a unit direction.
    double seen_area(const glm::dvec3& dir, double w) const
    {
        const glm::dvec3 p0 = column(0, w);
        return std::abs(glm::dot(dir, glm::cross(column(1, w) - p0, column(2, w) - p0)));
    }

    // Greatest distance of a corner from a point.
    double reach(const glm::dvec3& point) const
    {
        double farthest = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            farthest =
                std::max(farthest, std::max(glm::length(column(i, 0.0) - point), glm::length(column(i, 1.0) - point)));
        }
        return farthest;
    }

    // Error of prism coordinates that a ray's path may have at height w in single precision. Corners at up to the
    // distance D of the origin project into the ray's frame with errors of 2 D 2^-24 a coordinate; a numerator is made
    // of four products with coordinates up to the size S of the prism, thrice over for its three coefficients; and the
    // coordinates are quotients by the seen area.
    double coordinate_error(const glm::dvec3& origin, const glm::dvec3& dir, double w) const
    {
        return 24.0 * reach(origin) * size() * 0x1p-24 / seen_area(dir, w);
    }

    double size() const { return std::max(reach(base_[0]), std::max(reach(base_[1]), reach(base_[2]))); }

private:
    double side_at(const glm::dvec3& point, double w) const
    {
        const glm::dvec3 p0 = column(0, w);
        return glm::dot(point - p0, glm::cross(column(1, w) - p0, column(2, w) - p0));
    }

    Place place_at(const glm::dvec3& point, double w) const
    {
        const glm::dvec3 p0 = column(0, w);
        const glm::dvec3 normal = glm::cross(column(1, w) - p0, column(2, w) - p0);
        const double area = glm::dot(normal, normal);
        const double q1 = glm::dot(glm::cross(point - p0, column(2, w) - p0), normal) / area;
        const double q2 = glm::dot(glm::cross(column(1, w) - p0, point - p0), normal) / area;
        return {{q1, q2, w}, std::min(std::min(std::min(q1, q2), 1.0 - q1 - q2), std::min(w, 1.0 - w))};
    }

    std::array<glm::dvec3, 3> base_;
    std::array<glm::dvec3, 3> director_;
};

}  // namespace mesoshell
