#include "winding_number.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mesoshell {
namespace {

constexpr std::uint32_t triangles_of_leaf = 8;
// A node is seen as a dipole from this many radii on.
constexpr double far_radii = 3.0;
// Between these distances, in periods of the larger length, copies of the tile fade into a plane.
constexpr double near_periods = 1.5;
constexpr double far_periods = 4.5;
constexpr double one_over_sphere = 1.0 / (4.0 * std::numbers::pi);

// Van Oosterom and Strackee 1983, "The solid angle of a plane triangle", equation 8.
double solid_angle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c)
{
    const double la = glm::length(a);
    const double lb = glm::length(b);
    const double lc = glm::length(c);
    return 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)),
                            la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

}  // namespace

WindingNumber::WindingNumber(const PeriodicMesh& mesh, std::span<const glm::uvec3> triangles) : aspect_(mesh.aspect)
{
    triangles_.reserve(triangles.size());
    for (const glm::uvec3& t : triangles) {
        const auto corner = [&](std::uint32_t v) { return glm::dvec3(mesh.positions[v]); };
        triangles_.push_back({corner(t.x), corner(t.y), corner(t.z)});
        // Into the tile: which copy of a triangle is the first does not matter, and the tree wants them close together.
        const glm::dvec3 middle = (triangles_.back()[0] + triangles_.back()[1] + triangles_.back()[2]) / 3.0;
        const glm::dvec3 home(std::floor(middle.x), std::floor(middle.y / aspect_) * aspect_, 0.0);
        for (glm::dvec3& corner : triangles_.back()) {
            corner -= home;
        }
    }
    if (!triangles_.empty()) {
        nodes_.reserve(triangles_.size());
        build(0, static_cast<std::uint32_t>(triangles_.size()));
    }
}

void WindingNumber::build(std::uint32_t first, std::uint32_t last)
{
    const auto middle_of = [](const Corners& t) { return (t[0] + t[1] + t[2]) / 3.0; };
    const std::size_t index = nodes_.size();
    nodes_.emplace_back();
    Node node;
    node.first = first;
    node.last = last;
    double weight = 0.0;
    glm::dvec3 lower(std::numeric_limits<double>::max());
    glm::dvec3 upper(std::numeric_limits<double>::lowest());
    for (std::uint32_t i = first; i < last; ++i) {
        const Corners& t = triangles_[i];
        const glm::dvec3 area = 0.5 * glm::cross(t[1] - t[0], t[2] - t[0]);
        const glm::dvec3 middle = middle_of(t);
        node.area += area;
        node.center += middle * glm::length(area);
        weight += glm::length(area);
        lower = glm::min(lower, middle);
        upper = glm::max(upper, middle);
    }
    node.center = weight > 0.0 ? node.center / weight : middle_of(triangles_[first]);
    for (std::uint32_t i = first; i < last; ++i) {
        const Corners& t = triangles_[i];
        const glm::dvec3 area = 0.5 * glm::cross(t[1] - t[0], t[2] - t[0]);
        const glm::dvec3 offset = middle_of(t) - node.center;
        node.first_moment += glm::outerProduct(area, offset);
        // Of a triangle: of its middle, and a twelfth of what its corners have about that.
        glm::dmat3 spread = glm::outerProduct(offset, offset);
        for (const glm::dvec3& corner : t) {
            spread += glm::outerProduct(corner - middle_of(t), corner - middle_of(t)) / 12.0;
        }
        for (int k = 0; k < 3; ++k) {
            node.second_moment[static_cast<std::size_t>(k)] += spread * area[k];
        }
        for (const glm::dvec3& corner : t) {
            node.radius = std::max(node.radius, glm::length(corner - node.center));
        }
    }
    if (last - first > triangles_of_leaf) {
        const glm::dvec3 extent = upper - lower;
        const int axis = extent.x > extent.y ? (extent.x > extent.z ? 0 : 2) : (extent.y > extent.z ? 1 : 2);
        const std::uint32_t half = first + (last - first) / 2;
        std::nth_element(triangles_.begin() + first, triangles_.begin() + half, triangles_.begin() + last,
                         [&](const Corners& a, const Corners& b) { return middle_of(a)[axis] < middle_of(b)[axis]; });
        build(first, half);
        node.right = static_cast<std::uint32_t>(nodes_.size());
        build(half, last);
    }
    nodes_[index] = node;
}

double WindingNumber::of_tree(const glm::dvec3& point) const
{
    double sum = 0.0;
    std::array<std::uint32_t, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const std::uint32_t index = stack[--depth];
        const Node& node = nodes_[index];
        const glm::dvec3 to = node.center - point;
        const double squared = glm::dot(to, to);
        if (squared > far_radii * far_radii * node.radius * node.radius) {
            // Taylor's series of A . r / |r|^3 in the offset d, whose second term is A . d - 3 (A . r)(r . d) / r^2.
            const double one_over_squared = 1.0 / squared;
            double sum_of_node = glm::dot(node.area, to);
            for (int k = 0; k < 3; ++k) {
                const glm::dmat3& second = node.second_moment[static_cast<std::size_t>(k)];
                const double trace = second[0][0] + second[1][1] + second[2][2];
                const glm::dvec3 along = second * to;
                sum_of_node += node.first_moment[k][k] - 3.0 * one_over_squared * along[k] +
                               one_over_squared * to[k] * (7.5 * one_over_squared * glm::dot(along, to) - 1.5 * trace);
            }
            sum_of_node -= 3.0 * one_over_squared * glm::dot(to, node.first_moment * to);
            sum += sum_of_node * one_over_squared / std::sqrt(squared);
        } else if (node.right == 0) {
            for (std::uint32_t i = node.first; i < node.last; ++i) {
                sum += solid_angle(triangles_[i][0] - point, triangles_[i][1] - point, triangles_[i][2] - point);
            }
        } else {
            stack[depth++] = node.right;
            stack[depth++] = index + 1;
        }
    }
    return sum * one_over_sphere;
}

double WindingNumber::at(const glm::dvec3& point) const
{
    if (nodes_.empty()) {
        return 0.0;
    }
    const Node& all = nodes_.front();
    const double near = near_periods * std::max(1.0, aspect_);
    const double far = far_periods * std::max(1.0, aspect_);
    const glm::dvec3 from = all.center - point;
    double sum = 0.0;
    for (double j = std::ceil((-far - from.y) / aspect_); j <= std::floor((far - from.y) / aspect_); ++j) {
        const double y = from.y + j * aspect_;
        const double across = std::sqrt(std::max(0.0, far * far - y * y));
        for (double i = std::ceil(-across - from.x); i <= std::floor(across - from.x); ++i) {
            const double share = std::clamp((far - std::hypot(from.x + i, y)) / (far - near), 0.0, 1.0);
            sum += share * of_tree(point - glm::dvec3(i, j * aspect_, 0.0));
        }
    }
    // Outside a disc of radius R the integral of A_z z / |r|^3 is 2 pi A_z z / s, where s^2 = R^2 + z^2, and that of the
    // first moments 2 pi (M_zz - (M_xx + M_yy) / 2) R^2 / s^3; here their means over discs from near to far.
    const double z = std::max(std::abs(from.z), 1e-9);
    const double logarithm = std::asinh(far / z) - std::asinh(near / z);
    const double of_area = std::copysign(z * logarithm, from.z);
    const double of_moment = logarithm - far / std::hypot(far, z) + near / std::hypot(near, z);
    const glm::dmat3& moment = all.first_moment;
    return sum + (all.area.z * of_area + (moment[2][2] - 0.5 * (moment[0][0] + moment[1][1])) * of_moment) /
                     (2.0 * aspect_ * (far - near));
}

}  // namespace mesoshell
