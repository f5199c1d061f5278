// Signs of determinants of points given in single precision, exact for all finite values: double precision with a proven
// bound of its error first, then sums of products without error (Shewchuk 1997, "Adaptive precision floating-point
// arithmetic and fast robust geometric predicates"). A product of two floats is exact in double precision, and one of six
// neither overflows nor underflows there, so that no range is left out.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

// A sum of doubles without rounding: parts that do not overlap, smallest first.
class ExactSum {
public:
    void add(double value);
    // factor times a b c, without error.
    void add_product(float a, float b, float c, double factor);
    // factor times the product of two sums, without error; factor is a power of two or its negative.
    void add_product(const ExactSum& a, const ExactSum& b, double factor);
    int sign() const { return parts_.empty() ? 0 : (parts_.back() > 0.0 ? 1 : -1); }

private:
    std::vector<double> parts_;
};

// From one point to another.
struct Difference {
    glm::vec3 from;
    glm::vec3 to;
    glm::dvec3 rounded() const { return glm::dvec3(to) - glm::dvec3(from); }
};

// A determinant and how far from the true one it may be.
struct Bounded {
    double value;
    double error;
};

// det(a, b, c) of rounded differences. Of the true ones it is off by at most (7 + 56 e) e times the permanent, e = 2^-53
// (Shewchuk, orient3d).
inline Bounded determinant(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c)
{
    const double yz = b.y * c.z, zy = b.z * c.y;
    const double zx = b.z * c.x, xz = b.x * c.z;
    const double xy = b.x * c.y, yx = b.y * c.x;
    const double permanent = std::abs(a.x) * (std::abs(yz) + std::abs(zy)) + std::abs(a.y) * (std::abs(zx) + std::abs(xz)) +
                             std::abs(a.z) * (std::abs(xy) + std::abs(yx));
    return {a.x * (yz - zy) + a.y * (zx - xz) + a.z * (xy - yx), 8.0 * 0x1p-53 * permanent};
}

// Adds factor det(a, b, c), exactly.
void add_determinant(ExactSum& sum, const Difference& a, const Difference& b, const Difference& c, double factor);

// Sign of det(a, b, c).
int determinant_sign(const Difference& a, const Difference& b, const Difference& c);

// On which side of the plane through a, b, c the point d lies: 1 where a, b, c wind counterclockwise seen from d.
inline int orientation(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d)
{
    const Bounded bounded =
        determinant(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a), glm::dvec3(d) - glm::dvec3(a));
    if (std::abs(bounded.value) > bounded.error) {
        return bounded.value > 0.0 ? 1 : -1;
    }
    // One of the corners is in their plane; asking for that exactly would take long.
    return bounded.error == 0.0 || d == b || d == c ? 0 : determinant_sign({a, b}, {a, c}, {a, d});
}

// Sign of the area of the triangle a, b, c in the plane.
int orientation(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c);

}  // namespace mesoshell
