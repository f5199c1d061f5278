// Where the map of a prism turns inside out.
//
// With base_i and top_i its corners and d_i = top_i - base_i, a prism maps weights q and height w to
// P(q, w) = sum q_i (base_i + w d_i). Its Jacobian determinant is J(q, w) = sum q_i Q_i(w) with Q_i(w) = N(w) . d_i and
// N(w) = E1(w) x E2(w), the normal of the triangle at height w: linear in q, quadratic in w. So J is positive within the
// whole prism exactly if no Q_i is negative anywhere on [0, 1] and nowhere between all of them are zero. In Bernstein form
// that is decided by the signs of three coefficients and of one discriminant.
#pragma once

#include <array>

#include <glm/glm.hpp>

namespace mesoshell {

struct PrismCorners {
    std::array<glm::vec3, 3> base;
    std::array<glm::vec3, 3> top;

    // Without thickness at all corners it has no inside.
    bool empty() const { return base == top; }
};

// Whether the Jacobian is negative anywhere in the prism, or zero on a whole triangle strictly between base and top. Exact
// for all finite corners. Columns without a thickness are allowed, and an empty prism is not inverted.
bool inverted(const PrismCorners& prism);

// How far a prism may reach from the height `surface` (0 to 1), as a share of its present reach to both sides, before its
// Jacobian falls below `least` of that at this height: 1 where it does not, 0 where the Jacobian is not positive there.
// Double precision.
double sound_share(const PrismCorners& prism, double surface, double least);

}  // namespace mesoshell
