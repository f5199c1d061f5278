#include "exact_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mesoshell {
namespace {

constexpr double no_root = 2.0;

// Where all three numerators vanish within this much height of one another, the ray is taken for level with that triangle.
// It is off by as much at most; nearer than that, dividing by the seen area would lose more.
constexpr double level = 1e-6;

// How far, in weights, two prisms share a level ray, so that neither loses it where it runs along the edge between them.
constexpr double shared_rim = 1e-6;

double cross_2d(const glm::dvec2& a, const glm::dvec2& b)
{
    return a.x * b.y - a.y * b.x;
}

template <typename Value>
Value value_of(const Cubic<Value>& c, double s)
{
    return c[0] + (c[1] + (c[2] + c[3] * s) * s) * s;
}

// Negating all three coefficients leaves every bit of the roots: that is what the other side of a fin does.
std::array<double, 2> quadratic_roots(double c0, double c1, double c2)
{
    const double discriminant = c1 * c1 - 4.0 * c0 * c2;
    if (discriminant < 0.0) {
        return {no_root, no_root};
    }
    const double root = std::sqrt(discriminant);
    const double half_sum = -0.5 * (c1 < 0.0 ? c1 - root : c1 + root);
    return {c2 != 0.0 ? half_sum / c2 : no_root, half_sum != 0.0 ? c0 / half_sum : no_root};
}

double largest(const glm::dvec3& v)
{
    return std::max(v.x, std::max(v.y, v.z));
}

}  // namespace

ExactRay::ExactRay(const glm::dvec3& ray_origin, const glm::dvec3& ray_dir)
    : origin(ray_origin), dir(ray_dir), along(ray_dir / glm::dot(ray_dir, ray_dir))
{
    const bool lies = std::abs(dir.z) < 0.7 * glm::length(dir);
    const glm::dvec3 helper = lies ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(1.0, 0.0, 0.0);
    side = glm::normalize(glm::cross(helper, dir));
    up = glm::normalize(glm::cross(dir, side));
}

struct ExactPath::Corners {
    std::array<glm::dvec3, 3> base;
    std::array<glm::dvec3, 3> director;
    std::array<glm::dvec2, 3> uv;
    std::array<glm::dvec2, 3> rise;  // of (u, v) from base to top
};

ExactPath::ExactPath(const PrismTexels& prism, const ExactRay& ray)
{
    Corners corners;
    std::array<glm::dvec2, 3> b;
    std::array<glm::dvec2, 3> d;
    for (int i = 0; i < 3; ++i) {
        corners.base[i] = glm::dvec3(prism[i]);
        corners.director[i] = glm::dvec3(prism[i + 3]) - corners.base[i];
        corners.uv[i] = glm::dvec2(prism[i].w, prism[6][i]);
        corners.rise[i] = glm::dvec2(prism[i + 3].w, prism[6 + (i + 3) / 4][(i + 3) % 4]) - corners.uv[i];
        const glm::dvec3 offset = corners.base[i] - ray.origin;
        b[i] = glm::dvec2(glm::dot(offset, ray.side), glm::dot(offset, ray.up));
        d[i] = glm::dvec2(glm::dot(corners.director[i], ray.side), glm::dot(corners.director[i], ray.up));
        depth_base_[i] = glm::dot(offset, ray.along);
        depth_director_[i] = glm::dot(corners.director[i], ray.along);
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        numerator_[0][i] = cross_2d(b[j], b[k]);
        numerator_[1][i] = cross_2d(b[j], d[k]) + cross_2d(d[j], b[k]);
        numerator_[2][i] = cross_2d(d[j], d[k]);
    }
    if (misses()) {
        return;
    }
    for (int i = 0; i < 3; ++i) {
        const std::array<double, 2> roots = quadratic_roots(numerator_[0][i], numerator_[1][i], numerator_[2][i]);
        roots_[2 * i] = roots[0];
        roots_[2 * i + 1] = roots[1];
    }
    if (may_be_level()) {
        find_level(corners);
    }
    if (level_) {
        follow_level(corners, ray);
    } else {
        follow_height(corners);
    }
    std::sort(spans_.begin(), spans_.begin() + span_count_,
              [](const ExactSpan& x, const ExactSpan& y) { return x.t_out < y.t_out; });
}

glm::dvec3 ExactPath::numerators(double w) const
{
    return numerator_[0] + (numerator_[1] + numerator_[2] * w) * w;
}

double ExactPath::area(double w) const
{
    const glm::dvec3 n = numerators(w);
    return n.x + n.y + n.z;
}

// Whether one numerator is positive and another negative at all heights, by their control points. Most prisms that are asked
// are missed so.
bool ExactPath::misses() const
{
    const glm::dvec3 middle = numerator_[0] + numerator_[1] * 0.5;
    const glm::dvec3 top = numerators(1.0);
    const glm::dvec3 least = glm::min(numerator_[0], glm::min(middle, top));
    const glm::dvec3 most = glm::max(numerator_[0], glm::max(middle, top));
    return largest(least) > 0.0 && largest(-most) > 0.0;
}

// Whether the seen area comes near zero at any height, as it does where all numerators do: not where all its control points
// lie farther on one side.
bool ExactPath::may_be_level() const
{
    const glm::dvec3 ones(1.0);
    const double bottom = glm::dot(numerator_[0], ones);
    const double middle = bottom + 0.5 * glm::dot(numerator_[1], ones);
    const double top = area(1.0);
    const double near = 4.0 * level * largest(glm::abs(numerator_[1]) + glm::abs(numerator_[2]) * 2.0);
    return std::min(bottom, std::min(middle, top)) <= near && std::max(bottom, std::max(middle, top)) >= -near;
}

void ExactPath::find_level(const Corners& corners)
{
    const auto area_squared = [&](double w) {
        const glm::dvec3 p0 = corners.base[0] + corners.director[0] * w;
        const glm::dvec3 e1 = corners.base[1] + corners.director[1] * w - p0;
        const glm::dvec3 normal = glm::cross(e1, corners.base[2] + corners.director[2] * w - p0);
        return glm::dot(normal, normal);
    };
    // At the apex of a pyramid all numerators vanish for any ray.
    const double least_area = 1e-9 * area_squared(0.5);
    const double steepness = largest(glm::abs(numerator_[1]) + glm::abs(numerator_[2]) * 2.0);
    double nearest = level;
    for (const double w : roots_) {
        if (std::abs(w - 0.5) > 0.5 + level || !(area_squared(w) > least_area)) {
            continue;
        }
        const double steep = largest(glm::abs(numerator_[1] + numerator_[2] * (2.0 * w)));
        // Where a ray meets that apex they vanish with their slopes.
        if (steep <= 1e-3 * steepness) {
            continue;
        }
        const double distance = largest(glm::abs(numerators(w))) / steep;
        if (distance <= nearest) {
            nearest = distance;
            level_ = true;
            level_height_ = std::clamp(w, 0.0, 1.0);
        }
    }
}

void ExactPath::follow_level(const Corners& corners, const ExactRay& ray)
{
    // At one height everything is linear: the ray's foot in the triangle's plane, its weights, and the UVs.
    const double w = level_height_;
    const glm::dvec3 p0 = corners.base[0] + corners.director[0] * w;
    const glm::dvec3 e1 = corners.base[1] + corners.director[1] * w - p0;
    const glm::dvec3 e2 = corners.base[2] + corners.director[2] * w - p0;
    const glm::dvec3 normal = glm::cross(e1, e2);
    const double squared = glm::dot(normal, normal);
    const auto weights = [&](const glm::dvec3& offset) {
        const double q1 = glm::dot(glm::cross(offset, e2), normal) / squared;
        const double q2 = glm::dot(glm::cross(e1, offset), normal) / squared;
        return glm::dvec3(-q1 - q2, q1, q2);
    };
    const glm::dvec3 start = weights(ray.origin - p0) + glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 slope = weights(ray.dir);
    curve_.fill(glm::dvec4(0.0));
    place_.fill(glm::dvec3(0.0));
    const double none = std::numeric_limits<double>::max();
    double low = -none;
    double high = none;
    for (int i = 0; i < 3; ++i) {
        const double inside = start[i] + shared_rim;
        if (slope[i] > 0.0) {
            low = std::max(low, -inside / slope[i]);
        } else if (slope[i] < 0.0) {
            high = std::min(high, -inside / slope[i]);
        } else if (inside < 0.0) {
            return;
        }
        const glm::dvec2 uv = corners.uv[i] + corners.rise[i] * w;
        curve_[0] += glm::dvec4(uv * start[i], 0.0, 0.0);
        curve_[1] += glm::dvec4(uv * slope[i], 0.0, 0.0);
    }
    curve_[0].z = w;
    curve_[0].w = 1.0;
    place_[0] = glm::dvec3(0.0, start.y, start.z);
    place_[1] = glm::dvec3(1.0, slope.y, slope.z);
    // A prism without volume bounds nothing.
    if (low < high && low > -none && high < none) {
        spans_[0] = {low, high, low, high, false};
        span_count_ = 1;
    }
}

void ExactPath::follow_height(const Corners& corners)
{
    // Six roots cut the heights into seven parts, some without extent; parts that touch are one stretch.
    std::array<double, 8> cuts{0.0};
    std::transform(roots_.begin(), roots_.end(), cuts.begin() + 1, [](double w) { return w > 0.0 && w < 1.0 ? w : 1.0; });
    cuts[7] = 1.0;
    std::sort(cuts.begin(), cuts.end());
    bool has_curve = false;
    double opened = -1.0;
    for (std::size_t i = 0; i < cuts.size(); ++i) {
        const double w = cuts[i];
        const double next = i + 1 < cuts.size() ? cuts[i + 1] : w;
        if (next == w && w < 1.0) {
            continue;
        }
        const glm::dvec3 n = numerators(0.5 * (w + next));
        const double least = std::min(n.x, std::min(n.y, n.z));
        const double most = largest(n);
        // A ray in a fin is inside both prisms beside it, so that none loses it.
        const bool inside = next > w && ((least >= 0.0 && most > 0.0) || (most <= 0.0 && least < 0.0));
        if (inside && opened < 0.0) {
            opened = w;
        } else if (!inside && opened >= 0.0) {
            if (!has_curve) {
                set_curve(corners);
                has_curve = true;
            }
            add_span(opened, w);
            opened = -1.0;
        }
    }
}

void ExactPath::set_curve(const Corners& corners)
{
    curve_.fill(glm::dvec4(0.0));
    place_.fill(glm::dvec3(0.0));
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3& n = numerator_[k];
        const double sum = n.x + n.y + n.z;
        curve_[k].w += sum;
        curve_[k + 1].z += sum;
        place_[k].y += n.y;
        place_[k].z += n.z;
        for (int i = 0; i < 3; ++i) {
            curve_[k] += glm::dvec4(corners.uv[i] * n[i], 0.0, 0.0);
            curve_[k + 1] += glm::dvec4(corners.rise[i] * n[i], 0.0, 0.0);
            place_[k].x += depth_base_[i] * n[i];
            place_[k + 1].x += depth_director_[i] * n[i];
        }
    }
}

void ExactPath::add_span(double w_low, double w_high)
{
    // Not what roundings leave between roots that are one, as at an apex.
    if (span_count_ == most_spans || w_high - w_low < 1e-13) {
        return;
    }
    // Where the offset triangle has shrunk to a point, as at the apex of a pyramid, it has no weights: begin beside it.
    const double middle = std::abs(area(0.5 * (w_low + w_high)));
    const double aside = 1e-5 * (w_high - w_low);
    const double low = std::abs(area(w_low)) > 1e-10 * middle ? w_low : w_low + aside;
    const double high = std::abs(area(w_high)) > 1e-10 * middle ? w_high : w_high - aside;
    const double t_low = at(low).t;
    const double t_high = at(high).t;
    ExactSpan& span = spans_[static_cast<std::size_t>(span_count_++)];
    span = t_low <= t_high ? ExactSpan{low, high, t_low, t_high, false} : ExactSpan{high, low, t_high, t_low, false};
}

void ExactPath::begin_at(double t_near)
{
    int kept = 0;
    for (int i = 0; i < span_count_; ++i) {
        ExactSpan span = spans_[static_cast<std::size_t>(i)];
        if (span.t_out <= t_near) {
            continue;
        }
        if (span.t_in < t_near) {
            // The ray's parameter grows along a stretch, but its inverse is a root of a cubic: bisect.
            double before = span.s_in;
            double after = span.s_out;
            for (int step = 0; step < 50; ++step) {
                const double s = 0.5 * (before + after);
                (at(s).t < t_near ? before : after) = s;
            }
            span.s_in = after;
            span.t_in = t_near;
            span.cut = true;
        }
        spans_[static_cast<std::size_t>(kept++)] = span;
    }
    span_count_ = kept;
}

ExactPlace ExactPath::at(double s) const
{
    const glm::dvec4 curve = value_of(curve_, s);
    const glm::dvec3 place = value_of(place_, s);
    return {place.x / curve.w, glm::dvec3(place.y, place.z, curve.z) / curve.w, glm::dvec3(curve) / curve.w};
}

glm::dvec3 ExactPath::texture_at(double s) const
{
    const glm::dvec4 curve = value_of(curve_, s);
    return glm::dvec3(curve) / curve.w;
}

double ExactPath::bulge(double a, double b, const glm::dvec3& scale) const
{
    if (level_) {
        return 0.0;
    }
    // Blossoms: the control points of the cubic from a to b.
    const auto control = [&](double x, double y, double z) {
        return curve_[0] + curve_[1] * ((x + y + z) / 3.0) + curve_[2] * ((x * y + y * z + z * x) / 3.0) +
               curve_[3] * (x * y * z);
    };
    const std::array<glm::dvec4, 4> points{control(a, a, a), control(a, a, b), control(a, b, b), control(b, b, b)};
    const double sign = points[0].w < 0.0 ? -1.0 : 1.0;
    for (const glm::dvec4& p : points) {
        if (!(p.w * sign > 0.0)) {
            return std::numeric_limits<double>::infinity();
        }
    }
    const auto metric = [&](const glm::dvec4& p) { return glm::dvec3(p) / p.w * scale; };
    const glm::dvec3 start = metric(points[0]);
    const glm::dvec3 chord = metric(points[3]) - start;
    const double squared = glm::dot(chord, chord);
    const auto from_chord = [&](const glm::dvec4& p) {
        const glm::dvec3 offset = metric(p) - start;
        const double along = squared > 0.0 ? std::clamp(glm::dot(offset, chord) / squared, 0.0, 1.0) : 0.0;
        return glm::length(offset - chord * along);
    };
    // The distance to a chord is convex, and the inner control points never weigh more than this together.
    const double inner = std::max(points[1].w * sign, points[2].w * sign);
    const double outer = std::min(points[0].w * sign, points[3].w * sign);
    return std::max(from_chord(points[1]), from_chord(points[2])) * 3.0 * inner / (3.0 * inner + outer);
}

}  // namespace mesoshell
