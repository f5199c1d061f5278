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

// A ray, and the frame in which prisms are seen along it: it depends on the ray alone, so that neighbors project a shared
// corner to the same bits.
struct ExactRay {
    // dir has any length but zero; ray parameters are in units of it.
    ExactRay(const glm::dvec3& ray_origin, const glm::dvec3& ray_dir);

    glm::dvec3 origin;
    glm::dvec3 dir;
    glm::dvec3 side;   // unit length, at right angles to dir and to one another
    glm::dvec3 up;
    glm::dvec3 along;  // dir over its squared length
};

// A stretch of the path inside the prism. Its ends are values of the path's own parameter.
struct ExactSpan {
    double s_in;
    double s_out;
    double t_in;  // ray parameter
    double t_out;
    bool cut;  // it begins within the prism, at the nearest t asked for
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

    ExactPath(const PrismTexels& prism, const ExactRay& ray);

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
    struct Corners;

    bool misses() const;
    bool may_be_level() const;
    void find_level(const Corners& corners);
    void follow_level(const Corners& corners, const ExactRay& ray);
    void follow_height(const Corners& corners);
    void set_curve(const Corners& corners);
    void add_span(double w_low, double w_high);
    glm::dvec3 numerators(double w) const;
    double area(double w) const;

    std::array<glm::dvec3, 3> numerator_;    // N(w) = [0] + [1] w + [2] w^2, component i for corner column i
    glm::dvec3 depth_base_;                  // ray parameter of the corners' projections onto the ray, at w = 0
    glm::dvec3 depth_director_;              // its change from w = 0 to w = 1
    std::array<double, 6> roots_;            // where one is zero; 2 for a root that there is not; unset for what is missed
    bool level_ = false;                     // along an offset triangle: the path's parameter is the ray's own, else w
    double level_height_ = 0.0;

    // Set where there is a stretch.
    Cubic<glm::dvec4> curve_;  // (u, v, w, 1) times the weight
    Cubic<glm::dvec3> place_;  // (t, q1, q2) times the weight
    std::array<ExactSpan, most_spans> spans_;
    int span_count_ = 0;
};

}  // namespace mesoshell
