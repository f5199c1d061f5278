#include "edge_measure.h"

#include <algorithm>
#include <cmath>

namespace mesoshell {

float EdgeMeasure::operator()(const glm::vec3& a, const glm::vec3& b) const
{
    float share = 0.0f;
    if (refinement_.edge_length > 0.0f) {
        share = glm::distance(a, b) / refinement_.edge_length;
    }
    if (refinement_.edge_pixels > 0.0f) {
        share = std::max(share, static_cast<float>(pixels(a, b)) / refinement_.edge_pixels);
    }
    return share;
}

double EdgeMeasure::pixels(const glm::vec3& a, const glm::vec3& b) const
{
    const glm::dvec4 from = refinement_.clip_from_object * glm::dvec4(a, 1.0);
    const glm::dvec4 to = refinement_.clip_from_object * glm::dvec4(b, 1.0);
    constexpr double margin = 2.0;
    // Half-spaces of clip space in which the piece counts: five planes that meet in the eye, which w > 0 keeps it away from.
    const auto inside = [&](const glm::dvec4& p, int plane) {
        switch (plane) {
        case 0:
            return margin * p.w + p.x;
        case 1:
            return margin * p.w - p.x;
        case 2:
            return margin * p.w + p.y;
        case 3:
            return margin * p.w - p.y;
        default:
            return p.w - 1e-6 * std::max(std::abs(from.w), std::abs(to.w));
        }
    };
    double begin = 0.0;
    double end = 1.0;
    for (int plane = 0; plane < 5; ++plane) {
        const double at_begin = inside(from, plane);
        const double at_end = inside(to, plane);
        if (at_begin < 0.0 && at_end < 0.0) {
            return 0.0;
        }
        if (at_begin < 0.0) {
            begin = std::max(begin, at_begin / (at_begin - at_end));
        } else if (at_end < 0.0) {
            end = std::min(end, at_begin / (at_begin - at_end));
        }
    }
    if (begin >= end) {
        return 0.0;
    }
    const auto on_screen = [&](double share) {
        const glm::dvec4 p = from + (to - from) * share;
        return glm::dvec2(p) / p.w * 0.5 * glm::dvec2(refinement_.screen);
    };
    return glm::distance(on_screen(begin), on_screen(end));
}

}  // namespace mesoshell
