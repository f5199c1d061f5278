#include "predicates.h"

#include <cstddef>

namespace mesoshell {
namespace {

// The part of `value` in its upper 53 - `bits` bits.
template <int bits>
double upper_part(double value)
{
    const double scaled = value * (static_cast<double>(1ull << bits) + 1.0);
    return scaled - (scaled - value);
}

}  // namespace

void ExactSum::add(double value)
{
    std::size_t used = 0;
    for (const double part : parts_) {
        const double sum = value + part;
        const double virtual_part = sum - value;
        const double rest = (value - (sum - virtual_part)) + (part - virtual_part);
        value = sum;
        if (rest != 0.0) {
            parts_[used++] = rest;
        }
    }
    parts_.resize(used);
    if (value != 0.0) {
        parts_.push_back(value);
    }
}

void ExactSum::add_product(float a, float b, float c, double factor)
{
    const double both = static_cast<double>(a) * b;  // 48 bits
    const double upper = upper_part<29>(both);
    add(upper * c * factor);
    add((both - upper) * c * factor);
}

void ExactSum::add_product(const ExactSum& a, const ExactSum& b, double factor)
{
    for (const double x : a.parts_) {
        const double x_upper = upper_part<27>(x);
        const double x_lower = x - x_upper;
        for (const double y : b.parts_) {
            const double y_upper = upper_part<27>(y);
            const double y_lower = y - y_upper;
            const double product = x * y;
            const double rest =
                x_lower * y_lower - (((product - x_upper * y_upper) - x_lower * y_upper) - x_upper * y_lower);
            add(rest * factor);
            add(product * factor);
        }
    }
}

void add_determinant(ExactSum& sum, const Difference& a, const Difference& b, const Difference& c, double factor)
{
    for (int ends = 0; ends < 8; ++ends) {
        const glm::vec3& p = (ends & 1) != 0 ? a.from : a.to;
        const glm::vec3& q = (ends & 2) != 0 ? b.from : b.to;
        const glm::vec3& r = (ends & 4) != 0 ? c.from : c.to;
        const bool odd = ((ends & 1) + (ends >> 1 & 1) + (ends >> 2)) % 2 != 0;
        const double sign = odd ? -factor : factor;
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3;
            const int k = (i + 2) % 3;
            sum.add_product(p[i], q[j], r[k], sign);
            sum.add_product(p[i], q[k], r[j], -sign);
        }
    }
}

int determinant_sign(const Difference& a, const Difference& b, const Difference& c)
{
    const Bounded bounded = determinant(a.rounded(), b.rounded(), c.rounded());
    if (std::abs(bounded.value) > bounded.error) {
        return bounded.value > 0.0 ? 1 : -1;
    }
    if (bounded.error == 0.0) {
        return 0;
    }
    ExactSum sum;
    add_determinant(sum, a, b, c, 1.0);
    return sum.sign();
}

int orientation(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c)
{
    const glm::dvec2 p = glm::dvec2(b) - glm::dvec2(a);
    const glm::dvec2 q = glm::dvec2(c) - glm::dvec2(a);
    const double area = p.x * q.y - p.y * q.x;
    const double error = 4.0 * 0x1p-53 * (std::abs(p.x * q.y) + std::abs(p.y * q.x));
    if (std::abs(area) > error) {
        return area > 0.0 ? 1 : -1;
    }
    if (error == 0.0) {
        return 0;
    }
    ExactSum sum;
    const glm::vec2 points[3] = {a, b, c};
    for (int i = 0; i < 3; ++i) {
        const glm::vec2& next = points[(i + 1) % 3];
        sum.add(static_cast<double>(points[i].x) * next.y);
        sum.add(-static_cast<double>(points[i].y) * next.x);
    }
    return sum.sign();
}

}  // namespace mesoshell
