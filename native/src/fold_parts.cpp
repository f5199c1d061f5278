#include "fold_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "box_tree.h"

namespace mesoshell {
namespace {

constexpr double tolerance = 1e-9;
constexpr int halvings = 60;

struct Columns {
    explicit Columns(const PrismCorners& prism)
    {
        for (std::size_t i = 0; i < 3; ++i) {
            base[i] = glm::dvec3(prism.base[i]);
            director[i] = glm::dvec3(prism.top[i]) - base[i];
        }
    }
    std::array<glm::dvec3, 3> at(double w) const
    {
        return {base[0] + w * director[0], base[1] + w * director[1], base[2] + w * director[2]};
    }
    double side(const glm::dvec3& point, double w) const
    {
        const std::array<glm::dvec3, 3> t = at(w);
        return glm::dot(point - t[0], glm::cross(t[1] - t[0], t[2] - t[0]));
    }
    bool within(const glm::dvec3& point, double w) const
    {
        const std::array<glm::dvec3, 3> t = at(w);
        const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
        const double least = -tolerance * glm::dot(normal, normal);
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec3& next = t[(i + 1) % 3];
            if (glm::dot(glm::cross(next - t[i], point - t[i]), normal) < least) {
                return false;
            }
        }
        return true;
    }
    std::array<glm::dvec3, 3> base;
    std::array<glm::dvec3, 3> director;
};

// Heights that part [0, 1] into pieces on each of which a cubic with these values at 0, 1/3, 2/3 and 1 rises or falls.
std::vector<double> turning_points(const std::array<double, 4>& values)
{
    // Its coefficients by divided differences: c1 + 2 c2 w + 3 c3 w^2 is the derivative.
    const double c3 = 4.5 * (values[3] - 3.0 * values[2] + 3.0 * values[1] - values[0]);
    const double c2 = 4.5 * (values[2] - 2.0 * values[1] + values[0]) - c3;
    const double c1 = values[3] - values[0] - c2 - c3;
    std::vector<double> points{0.0, 1.0};
    const double discriminant = c2 * c2 - 3.0 * c1 * c3;
    if (discriminant >= 0.0) {
        const double q = -(c2 + std::copysign(std::sqrt(discriminant), c2));
        for (const double w : {c3 != 0.0 ? q / (3.0 * c3) : -1.0, q != 0.0 ? c1 / q : -1.0}) {
            if (w > 0.0 && w < 1.0) {
                points.push_back(w);
            }
        }
    }
    std::sort(points.begin(), points.end());
    return points;
}

}  // namespace

bool holds(const PrismCorners& prism, const glm::dvec3& point)
{
    const Columns columns(prism);
    const auto side = [&](double w) { return columns.side(point, w); };
    const std::vector<double> points = turning_points({side(0.0), side(1.0 / 3.0), side(2.0 / 3.0), side(1.0)});
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        double low = points[i];
        double high = points[i + 1];
        const bool negative = side(low) < 0.0;
        if (negative == (side(high) < 0.0)) {
            continue;
        }
        for (int k = 0; k < halvings; ++k) {
            const double middle = 0.5 * (low + high);
            ((side(middle) < 0.0) == negative ? low : high) = middle;
        }
        if (columns.within(point, low)) {
            return true;
        }
    }
    return false;
}

FoldParts::FoldParts(const FoldSearch& search) : part_(search.prisms())
{
    const std::size_t vertices = search.vertex_count();
    std::vector<std::uint32_t> parent(vertices);
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t v) {
        while (parent[v] != v) {
            v = parent[v] = parent[parent[v]];
        }
        return v;
    };
    for (std::uint32_t p = 0; p < part_.size(); ++p) {
        const glm::uvec3& t = search.vertices(p);
        const std::uint32_t least = std::min({root(t.x), root(t.y), root(t.z)});
        parent[root(t.x)] = parent[root(t.y)] = parent[root(t.z)] = least;
    }
    std::vector<std::uint8_t> seen(vertices, 0);
    for (std::uint32_t p = 0; p < part_.size(); ++p) {
        part_[p] = root(search.vertices(p).x);
        if (seen[part_[p]] == 0) {
            seen[part_[p]] = 1;
            first_.push_back(p);
        }
    }
}

std::vector<glm::uvec2> FoldParts::nested(const FoldSearch& search, Job& job) const
{
    std::vector<glm::uvec2> pairs;
    if (first_.size() < 2) {
        return pairs;
    }
    std::vector<Box> boxes(search.prisms());
    for (std::uint32_t p = 0; p < boxes.size(); ++p) {
        const PrismCorners prism = search.corners(p);
        boxes[p] = {prism.base[0], prism.base[0]};
        for (std::size_t i = 0; i < 3; ++i) {
            boxes[p].extend(prism.base[i]);
            boxes[p].extend(prism.top[i]);
        }
    }
    const BoxTree tree(boxes, job);
    for (const std::uint32_t p : first_) {
        const PrismCorners prism = search.corners(p);
        if (prism.empty()) {
            continue;
        }
        const glm::dvec3 middle = (glm::dvec3(prism.base[0]) + glm::dvec3(prism.base[1]) + glm::dvec3(prism.base[2])) / 3.0;
        const Box around{glm::vec3(middle), glm::vec3(middle)};
        tree.overlapping(around, [&](std::uint32_t q) {
            const PrismCorners other = search.corners(q);
            if (part_[q] != part_[p] && !other.empty() && holds(other, middle)) {
                pairs.emplace_back(std::min(p, q), std::max(p, q));
            }
            return true;
        });
    }
    return pairs;
}

}  // namespace mesoshell
