// The true path of a straight ray through one prism, in double precision: a rational curve in texture space.
//
// Ogaki 2023, "Nonlinear ray tracing for displacement and shell mapping": seen along the ray, the ray's barycentric
// numerators in the triangle at height w are quadratics in w. Texture coordinates are their products with the corners' UVs,
// linear in w where the top has UVs of its own, over their sum: u and v have degree 2, or 3 there. lib/prism_path.glsl finds
// the same in single precision, with the same names; here stretches of neighbors meet within 1e-9 of a prism.
#pragma once

#include <array>

#include <glm/glm.hpp>

#include "mesoshell/shell.h"

namespace mesoshell {

// A stretch of the path inside the prism. Its ends are values of the path's own parameter.
struct ExactSpan {
    double s_in = 0.0;
    double s_out = 0.0;
    double t_in = 0.0;  // ray parameter
    double t_out = 0.0;
    bool cut = false;  // it begins within the prism, at the nearest t asked for
};

// Where the path is at a value of its parameter.
struct ExactPlace {
    double t = 0.0;
    glm::dvec3 q{0.0};        // prism coordinates: weights of corner columns 1 and 2, and height
    glm::dvec3 texture{0.0};  // texture space
};

// Coefficients of a polynomial of degree 3 in the path's parameter.
template <typename Value>
using Cubic = std::array<Value, 4>;

class ExactPath {
public:
    // A ray leaves a prism through a fin and comes back at most once for each fin.
    static constexpr int most_spans = 4;

    // dir has any length but zero; t is in units of it.
    ExactPath(const PrismTexels& prism, const glm::dvec3& origin, const glm::dvec3& dir);

    // Its stretches that end beyond t_near, nearest first.
    int span_count() const { return span_count_; }
    const ExactSpan& span(int i) const { return spans_[static_cast<std::size_t>(i)]; }
    void begin_at(double t_near);

    ExactPlace at(double s) const;
    glm::dvec3 texture_at(double s) const;

    // An upper bound of how far, in metric texture space, the path from a to b lies from the chord between its ends: control
    // points hold a curve in their hull. Infinite where they do not, because the path's weights change sign.
    double bulge(double a, double b, const glm::dvec3& scale) const;

private:
    void find_level(const std::array<glm::dvec3, 3>& base, const std::array<glm::dvec3, 3>& director);
    void follow_height(const std::array<glm::dvec2, 3>& uv, const std::array<glm::dvec2, 3>& rise);
    void follow_level(const std::array<glm::dvec3, 3>& base, const std::array<glm::dvec3, 3>& director,
                      const std::array<glm::dvec2, 3>& uv, const std::array<glm::dvec2, 3>& rise, const glm::dvec3& origin,
                      const glm::dvec3& dir);
    void add_span(double s_low, double s_high);
    glm::dvec3 numerators(double w) const;
    double area(double w) const;

    std::array<glm::dvec3, 3> numerator_{};  // N(w) = [0] + [1] w + [2] w^2, component i for corner column i
    glm::dvec3 depth_base_{0.0};             // ray parameter of the corners' projections onto the ray, at w = 0
    glm::dvec3 depth_director_{0.0};         // its change from w = 0 to w = 1
    std::array<double, 6> roots_{};          // where a numerator is zero; 2 for a root that there is not
    bool level_ = false;                     // along an offset triangle: the path's parameter is the ray's own, else w
    double level_height_ = 0.0;

    Cubic<glm::dvec4> curve_{};  // (u, v, w, 1) times the weight
    Cubic<glm::dvec3> place_{};  // (t, q1, q2) times the weight
    std::array<ExactSpan, most_spans> spans_{};
    int span_count_ = 0;
};

}  // namespace mesoshell
