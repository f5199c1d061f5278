#include "fold_jacobian.h"

#include <algorithm>
#include <cmath>

#include "predicates.h"

namespace mesoshell {
namespace {

enum class Least { negative, zero, positive };  // within (0, 1), of a quadratic

// The edges of the prism from its first corner, and the columns.
struct Sides {
    explicit Sides(const PrismCorners& prism)
        : low{Difference{prism.base[0], prism.base[1]}, Difference{prism.base[0], prism.base[2]}},
          high{Difference{prism.top[0], prism.top[1]}, Difference{prism.top[0], prism.top[2]}}
    {
        for (std::size_t i = 0; i < 3; ++i) {
            columns[i] = {prism.base[i], prism.top[i]};
        }
        for (std::size_t i = 0; i < 2; ++i) {
            low_rounded[i] = low[i].rounded();
            high_rounded[i] = high[i].rounded();
        }
    }
    Difference low[2];
    Difference high[2];
    Difference columns[3];
    glm::dvec3 low_rounded[2];
    glm::dvec3 high_rounded[2];
};

int sign_of(const Bounded& bounded)
{
    return bounded.value > bounded.error ? 1 : bounded.value < -bounded.error ? -1 : 0;
}

// Undecided by double precision.
Least least_exactly(const Sides& sides, std::size_t corner)
{
    const Difference& column = sides.columns[corner];
    ExactSum first, twice_middle, last;
    add_determinant(first, sides.low[0], sides.low[1], column, 1.0);
    add_determinant(last, sides.high[0], sides.high[1], column, 1.0);
    if (first.sign() < 0 || last.sign() < 0) {
        return Least::negative;
    }
    add_determinant(twice_middle, sides.low[0], sides.high[1], column, 1.0);
    add_determinant(twice_middle, sides.high[0], sides.low[1], column, 1.0);
    if (twice_middle.sign() >= 0) {
        return first.sign() + twice_middle.sign() + last.sign() > 0 ? Least::positive : Least::zero;
    }
    ExactSum discriminant;
    discriminant.add_product(first, last, 4.0);
    discriminant.add_product(twice_middle, twice_middle, -1.0);
    return discriminant.sign() > 0 ? Least::positive : discriminant.sign() == 0 ? Least::zero : Least::negative;
}

Least least_of(const Sides& sides, std::size_t corner)
{
    const glm::dvec3 column = sides.columns[corner].rounded();
    if (column == glm::dvec3(0.0)) {
        return Least::zero;
    }
    const Bounded first = determinant(sides.low_rounded[0], sides.low_rounded[1], column);
    const Bounded last = determinant(sides.high_rounded[0], sides.high_rounded[1], column);
    const Bounded one = determinant(sides.low_rounded[0], sides.high_rounded[1], column);
    const Bounded other = determinant(sides.high_rounded[0], sides.low_rounded[1], column);
    // The sum of the two is rounded once more.
    const Bounded middle{0.5 * (one.value + other.value), 0.5 * (one.error + other.error) * 1.25};
    if (sign_of(first) < 0 || sign_of(last) < 0) {
        return Least::negative;
    }
    if (sign_of(first) > 0 && sign_of(last) > 0) {
        if (sign_of(middle) > 0) {
            return Least::positive;
        }
        constexpr double rounding = 16.0 * 0x1p-53;
        const double largest = std::abs(middle.value) + middle.error;
        if (largest * largest < (first.value - first.error) * (last.value - last.error) * (1.0 - rounding)) {
            return Least::positive;
        }
        const double smallest = -middle.value - middle.error;
        if (smallest > 0.0 &&
            smallest * smallest * (1.0 - rounding) > (first.value + first.error) * (last.value + last.error)) {
            return Least::negative;
        }
    }
    return least_exactly(sides, corner);
}

}  // namespace

bool inverted(const PrismCorners& prism)
{
    const Sides sides(prism);
    bool positive = false;
    for (std::size_t i = 0; i < 3; ++i) {
        const Least least = least_of(sides, i);
        if (least == Least::negative) {
            return true;
        }
        positive = positive || least == Least::positive;
    }
    return !positive && !prism.empty();
}

double sound_share(const PrismCorners& prism, double surface, double least)
{
    const Sides sides(prism);
    double share = 1.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 column = sides.columns[i].rounded();
        if (column == glm::dvec3(0.0)) {
            continue;
        }
        const auto triple = [&](const glm::dvec3& a, const glm::dvec3& b) { return glm::dot(glm::cross(a, b), column); };
        // Q(w) = c + b w + a w^2, with its value at the surface.
        const double first = triple(sides.low_rounded[0], sides.low_rounded[1]);
        const double last = triple(sides.high_rounded[0], sides.high_rounded[1]);
        const double middle = 0.5 * (triple(sides.low_rounded[0], sides.high_rounded[1]) +
                                     triple(sides.high_rounded[0], sides.low_rounded[1]));
        const double a = first - 2.0 * middle + last;
        const double b = 2.0 * (middle - first);
        const double at_surface = first + surface * (b + surface * a);
        if (!(at_surface > 0.0)) {
            return 0.0;
        }
        // About the surface, Q(surface + x) = at_surface + slope x + a x^2, less what must remain.
        const double slope = b + 2.0 * a * surface;
        const double rest = (1.0 - least) * at_surface;
        const double discriminant = slope * slope - 4.0 * a * rest;
        if (discriminant < 0.0) {
            continue;
        }
        // Both roots without cancellation.
        const double q = -0.5 * (slope + std::copysign(std::sqrt(discriminant), slope));
        for (const double root : {q != 0.0 ? rest / q : 0.0, a != 0.0 ? q / a : 0.0}) {
            const double reach = root > 0.0 ? 1.0 - surface : surface;
            if (root != 0.0 && reach > 0.0) {
                share = std::min(share, std::abs(root) / reach);
            }
        }
    }
    return share;
}

}  // namespace mesoshell
