#include "winding_oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mesoshell {
namespace {

// Van Oosterom and Strackee 1983, "The solid angle of a plane triangle", equation 8.
double solid_angle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c)
{
    const double la = glm::length(a);
    const double lb = glm::length(b);
    const double lc = glm::length(c);
    const double above = glm::dot(a, glm::cross(b, c));
    const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    return 2.0 * std::atan2(above, below);
}

double segment_distance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b)
{
    const glm::dvec3 ab = b - a;
    const double squared = glm::dot(ab, ab);
    const double share = squared > 0.0 ? std::clamp(glm::dot(p - a, ab) / squared, 0.0, 1.0) : 0.0;
    return glm::length(p - a - ab * share);
}

// By its plane, where the foot is within, and else by its sides.
double triangle_distance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c)
{
    double nearest = std::min(segment_distance(p, a, b), std::min(segment_distance(p, b, c), segment_distance(p, c, a)));
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double squared = glm::dot(normal, normal);
    if (squared > 0.0) {
        const glm::dvec3 foot = p - normal * (glm::dot(p - a, normal) / squared);
        if (glm::dot(glm::cross(b - a, foot - a), normal) >= 0.0 && glm::dot(glm::cross(c - b, foot - b), normal) >= 0.0 &&
            glm::dot(glm::cross(a - c, foot - c), normal) >= 0.0) {
            nearest = std::min(nearest, std::abs(glm::dot(p - a, normal)) / std::sqrt(squared));
        }
    }
    return nearest;
}

}  // namespace

double brute_force_winding(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, float aspect,
                           const glm::dvec3& point, int copies)
{
    const double reach = copies * std::max(1.0, static_cast<double>(aspect));
    double sum = 0.0;
    double seen_from_above = 0.0;
    for (const glm::uvec3& t : triangles) {
        const glm::dvec3 a(positions[t.x]);
        const glm::dvec3 b(positions[t.y]);
        const glm::dvec3 c(positions[t.z]);
        const glm::dvec3 center = (a + b + c) / 3.0 - point;
        seen_from_above += glm::cross(b - a, c - a).z * 0.5;
        // Copies whose middle lies in a disc about the point: so the far ones on either side cancel.
        for (double j = std::ceil((-reach - center.y) / aspect); j <= std::floor((reach - center.y) / aspect); ++j) {
            const double y = center.y + j * aspect;
            const double across = std::sqrt(std::max(0.0, reach * reach - y * y));
            for (double i = std::ceil(-across - center.x); i <= std::floor(across - center.x); ++i) {
                const glm::dvec3 offset = glm::dvec3(i, j * aspect, 0.0) - point;
                sum += solid_angle(a + offset, b + offset, c + offset);
            }
        }
    }
    return sum / (4.0 * std::numbers::pi) + seen_from_above / (2.0 * aspect);
}

double balanced_winding(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, float aspect,
                        const glm::dvec3& point, int copies)
{
    // The mean over discs of radii from a quarter of the reach to the reach.
    const double reach = copies * std::max(1.0, static_cast<double>(aspect));
    constexpr int discs = 64;
    double sum = 0.0;
    for (const glm::uvec3& t : triangles) {
        const glm::dvec3 a(positions[t.x]);
        const glm::dvec3 b(positions[t.y]);
        const glm::dvec3 c(positions[t.z]);
        const glm::dvec3 center = (a + b + c) / 3.0 - point;
        for (double j = std::ceil((-reach - center.y) / aspect); j <= std::floor((reach - center.y) / aspect); ++j) {
            const double y = center.y + j * aspect;
            const double across = std::sqrt(std::max(0.0, reach * reach - y * y));
            for (double i = std::ceil(-across - center.x); i <= std::floor(across - center.x); ++i) {
                const glm::dvec3 offset = glm::dvec3(i, j * aspect, 0.0) - point;
                const double share = std::min(1.0, (1.0 - std::hypot(center.x + i, y) / reach) / 0.75);
                sum += share * solid_angle(a + offset, b + offset, c + offset) / (4.0 * std::numbers::pi);
            }
        }
        // Beyond a disc, the integral of z / r^3.
        double beyond = 0.0;
        for (int k = 0; k < discs; ++k) {
            const double radius = reach * (0.25 + 0.75 * (k + 0.5) / discs);
            beyond += center.z / std::sqrt(radius * radius + center.z * center.z) / discs;
        }
        sum += glm::cross(b - a, c - a).z * 0.5 * beyond / (2.0 * aspect);
    }
    return sum;
}

double brute_force_distance(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, float aspect,
                            const glm::dvec3& point, int copies)
{
    double nearest = std::numeric_limits<double>::infinity();
    for (const glm::uvec3& t : triangles) {
        const glm::dvec3 middle((positions[t.x] + positions[t.y] + positions[t.z]) / 3.0f);
        const double column = std::round(point.x - middle.x);
        const double row = std::round((point.y - middle.y) / aspect);
        for (int j = -copies; j <= copies; ++j) {
            for (int i = -copies; i <= copies; ++i) {
                const glm::dvec3 p = point - glm::dvec3(column + i, (row + j) * aspect, 0.0);
                nearest = std::min(nearest, triangle_distance(p, glm::dvec3(positions[t.x]), glm::dvec3(positions[t.y]),
                                                              glm::dvec3(positions[t.z])));
            }
        }
    }
    return nearest;
}

}  // namespace mesoshell
