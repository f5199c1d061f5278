#include "fold_crossing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "predicates.h"

namespace mesoshell {
namespace {

// The plane of a triangle, asked for the sides of several points.
class Plane {
public:
    explicit Plane(const Triangle& t) : triangle_(t), origin_(t[0])
    {
        const glm::dvec3 b = glm::dvec3(t[1]) - origin_;
        const glm::dvec3 c = glm::dvec3(t[2]) - origin_;
        for (int i = 0; i < 3; ++i) {
            const double one = b[(i + 1) % 3] * c[(i + 2) % 3];
            const double other = b[(i + 2) % 3] * c[(i + 1) % 3];
            normal_[i] = one - other;
            reach_[i] = std::abs(one) + std::abs(other);
        }
    }

    // As orientation, with the same bound of the error: determinant() expanded along its last row.
    int side(const glm::vec3& point) const
    {
        const glm::dvec3 d = glm::dvec3(point) - origin_;
        const double value = glm::dot(d, normal_);
        const double error =
            8.0 * 0x1p-53 * (std::abs(d.x) * reach_.x + std::abs(d.y) * reach_.y + std::abs(d.z) * reach_.z);
        if (std::abs(value) > error) {
            return value > 0.0 ? 1 : -1;
        }
        return error == 0.0 ? 0 : orientation(triangle_[0], triangle_[1], triangle_[2], point);
    }

private:
    const Triangle& triangle_;
    glm::dvec3 origin_;
    glm::dvec3 normal_;
    glm::dvec3 reach_;
};

std::array<int, 3> sides(const Triangle& plane, const Triangle& points)
{
    const Plane asked(plane);
    return {asked.side(points[0]), asked.side(points[1]), asked.side(points[2])};
}

bool on_both_sides(const std::array<int, 3>& signs)
{
    return std::min({signs[0], signs[1], signs[2]}) < 0 && std::max({signs[0], signs[1], signs[2]}) > 0;
}

glm::vec2 without(const glm::vec3& point, int axis)
{
    return {point[(axis + 1) % 3], point[(axis + 2) % 3]};
}

using Flat = std::array<glm::vec2, 3>;

int area_sign(const Flat& t)
{
    return orientation(t[0], t[1], t[2]);
}

// Whether an edge of a has all of b on it or beyond.
bool edge_separates(const Flat& a, const Flat& b)
{
    const int sign = area_sign(a);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto beyond = [&](const glm::vec2& point) { return orientation(a[i], a[(i + 1) % 3], point) * sign <= 0; };
        if (beyond(b[0]) && beyond(b[1]) && beyond(b[2])) {
            return true;
        }
    }
    return false;
}

bool coplanar_crossing(const Triangle& a, Inside inside_a, const Triangle& b, Inside inside_b)
{
    for (int axis = 0; axis < 3; ++axis) {
        const Flat flat_a{without(a[0], axis), without(a[1], axis), without(a[2], axis)};
        const Flat flat_b{without(b[0], axis), without(b[1], axis), without(b[2], axis)};
        const int facing = area_sign(flat_a) * area_sign(flat_b);
        if (facing != 0) {
            const bool same_side = (facing > 0) == (inside_a == inside_b);
            return same_side && !edge_separates(flat_a, flat_b) && !edge_separates(flat_b, flat_a);
        }
    }
    return false;
}

// Turns the corners so that the first is alone on its side; returns that side.
int lead_with_lone(Triangle& corners, const std::array<int, 3>& signs)
{
    for (const int side : {1, -1}) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (signs[i] == side && signs[(i + 1) % 3] != side && signs[(i + 2) % 3] != side) {
                std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(i), corners.end());
                return side;
            }
        }
    }
    return 0;
}

struct Hull {
    std::array<Triangle, 4> triangles;
    std::size_t count = 2;  // of a plane patch
};

// The tetrahedron of the corners. Its faces wind alike, whichever way is out.
Hull hull_of(const Patch& p)
{
    return {{Triangle{p[0], p[1], p[2]}, Triangle{p[0], p[2], p[3]}, Triangle{p[0], p[3], p[1]}, Triangle{p[1], p[3], p[2]}},
            orientation(p[0], p[1], p[2], p[3]) == 0 ? std::size_t(2) : std::size_t(4)};
}

bool within(const Hull& hull, const glm::vec3& point)
{
    if (hull.count == 2) {
        return false;
    }
    const Triangle& face = hull.triangles[0];
    const glm::vec3& fourth = hull.triangles[1][2];
    if (glm::any(glm::lessThan(point, glm::min(glm::min(face[0], face[1]), glm::min(face[2], fourth)))) ||
        glm::any(glm::greaterThan(point, glm::max(glm::max(face[0], face[1]), glm::max(face[2], fourth))))) {
        return false;
    }
    const auto side = [&](std::size_t i) {
        const Triangle& t = hull.triangles[i];
        return orientation(t[0], t[1], t[2], point);
    };
    const int first = side(0);
    return first != 0 && side(1) == first && side(2) == first && side(3) == first;
}

bool hulls_cross(const Hull& a, const Triangle& b, Inside inside_b)
{
    for (std::size_t i = 0; i < a.count; ++i) {
        const Triangle& face = a.triangles[i];
        const bool plane = a.count == 2;  // else it is no piece of the boundary, and lying in its plane means nothing
        if (plane ? crossing(face, Inside::back, b, inside_b)
                  : on_both_sides(sides(b, face)) && crossing(face, Inside::back, b, inside_b)) {
            return true;
        }
    }
    return within(a, b[0]) || within(a, b[1]) || within(a, b[2]);
}

bool hulls_cross(const Hull& a, const Hull& b)
{
    for (std::size_t i = 0; i < b.count; ++i) {
        const Triangle& face = b.triangles[i];
        const auto meets = [&](const Triangle& other) {
            return (a.count == 2 && b.count == 2) || on_both_sides(sides(face, other));
        };
        for (std::size_t j = 0; j < a.count; ++j) {
            if (meets(a.triangles[j]) && crossing(a.triangles[j], Inside::back, face, Inside::back)) {
                return true;
            }
        }
        if (within(a, face[0]) || within(a, face[1]) || within(a, face[2])) {
            return true;
        }
    }
    for (const Triangle& face : a.triangles) {
        if (within(b, face[0]) || within(b, face[1]) || within(b, face[2])) {
            return true;
        }
    }
    return false;
}

// How far the diagonals of a patch are apart halfway, squared.
double squared_bulge(const Patch& p)
{
    const glm::dvec3 apart = 0.5 * ((glm::dvec3(p[0]) + glm::dvec3(p[2])) - (glm::dvec3(p[1]) + glm::dvec3(p[3])));
    const glm::dvec3 normal = glm::cross(glm::dvec3(p[2]) - glm::dvec3(p[0]), glm::dvec3(p[3]) - glm::dvec3(p[1]));
    const double size = glm::dot(normal, normal);
    const double along = glm::dot(apart, normal);
    return size > 0.0 ? along * along / size : 0.0;
}

double squared_size(const Patch& p)
{
    const glm::dvec3 one = glm::dvec3(p[2]) - glm::dvec3(p[0]);
    const glm::dvec3 other = glm::dvec3(p[3]) - glm::dvec3(p[1]);
    return std::max(glm::dot(one, one), glm::dot(other, other));
}

constexpr int most_halvings = 3;
constexpr double least_bulge = 1e-5;  // of the size of a patch that is worth halving

int halvings_of(const Patch& p)
{
    return squared_bulge(p) > least_bulge * least_bulge * squared_size(p) ? most_halvings : 0;
}

std::array<Patch, 4> quarters(const Patch& p)
{
    const auto middle = [](const glm::vec3& a, const glm::vec3& b) { return 0.5f * (a + b); };
    const glm::vec3 sides[4] = {middle(p[0], p[1]), middle(p[1], p[2]), middle(p[2], p[3]), middle(p[3], p[0])};
    const glm::vec3 center = middle(sides[0], sides[2]);
    return {Patch{p[0], sides[0], center, sides[3]}, Patch{sides[0], p[1], sides[1], center},
            Patch{center, sides[1], p[2], sides[2]}, Patch{sides[3], center, sides[2], p[3]}};
}

// Whether the bounds of two sets of points overlap.
template <typename Points, typename OtherPoints>
bool boxes_overlap(const Points& a, const OtherPoints& b)
{
    glm::vec3 lower_a = a[0], upper_a = a[0], lower_b = b[0], upper_b = b[0];
    for (const glm::vec3& p : a) {
        lower_a = glm::min(lower_a, p);
        upper_a = glm::max(upper_a, p);
    }
    for (const glm::vec3& p : b) {
        lower_b = glm::min(lower_b, p);
        upper_b = glm::max(upper_b, p);
    }
    return glm::all(glm::lessThanEqual(lower_a, upper_b)) && glm::all(glm::lessThanEqual(lower_b, upper_a));
}

bool parts_cross(const Patch& a, int halvings, const Triangle& b, Inside inside_b)
{
    if (!boxes_overlap(a, b) || !hulls_cross(hull_of(a), b, inside_b)) {
        return false;
    }
    if (halvings == 0) {
        return true;
    }
    const std::array<Patch, 4> parts = quarters(a);
    return std::any_of(parts.begin(), parts.end(),
                       [&](const Patch& part) { return parts_cross(part, halvings - 1, b, inside_b); });
}

bool parts_cross(const Patch& a, int halvings_a, const Patch& b, int halvings_b)
{
    if (!boxes_overlap(a, b) || !hulls_cross(hull_of(a), hull_of(b))) {
        return false;
    }
    if (halvings_a == 0 && halvings_b == 0) {
        return true;
    }
    if (halvings_a < halvings_b) {
        return parts_cross(b, halvings_b, a, halvings_a);
    }
    const std::array<Patch, 4> parts = quarters(a);
    return std::any_of(parts.begin(), parts.end(),
                       [&](const Patch& part) { return parts_cross(part, halvings_a - 1, b, halvings_b); });
}

}  // namespace

bool crossing(const Triangle& a, Inside inside_a, const Triangle& b, Inside inside_b)
{
    const std::array<int, 3> sides_b = sides(a, b);
    if (!on_both_sides(sides_b)) {
        return sides_b == std::array<int, 3>{} && coplanar_crossing(a, inside_a, b, inside_b);
    }
    const std::array<int, 3> sides_a = sides(b, a);
    if (!on_both_sides(sides_a)) {
        return false;
    }
    // Each triangle cuts the line common to both planes in an interval between the edges from its lone corner. Wound so that
    // this corner lies in front of the other triangle's plane, the intervals overlap if two more orientations say so.
    Triangle p = a;
    Triangle q = b;
    const int side_p = lead_with_lone(p, sides_a);
    const int side_q = lead_with_lone(q, sides_b);
    if (side_p < 0) {
        std::swap(q[1], q[2]);
    }
    if (side_q < 0) {
        std::swap(p[1], p[2]);
    }
    return orientation(p[0], p[1], q[0], q[1]) < 0 && orientation(p[0], p[2], q[2], q[0]) < 0;
}

bool crossing(const Patch& a, const Triangle& b, Inside inside_b, bool refined)
{
    return parts_cross(a, refined ? halvings_of(a) : 0, b, inside_b);
}

bool crossing(const Patch& a, const Patch& b, bool refined)
{
    return parts_cross(a, refined ? halvings_of(a) : 0, b, refined ? halvings_of(b) : 0);
}

}  // namespace mesoshell
