#include "exact_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tile_space.h"

namespace mesoshell {
namespace {

// Chords and upward rays stay within this of where they begin, sideways, in tile widths, so that few copies of the tile do.
constexpr double longest = 0.5;

// Of a stretch: shorter chords are not sought where a path bends without end, as beside the apex of a pyramid.
constexpr double least_step = 1e-6;

// Chords reach so far beyond their ends, in tile widths, that no surface slips between two of them by rounding.
constexpr double rim = 1e-5;

// Not straight up, because walls are; less where the tile is tall.
glm::dvec3 tilted_up(const Sample& sample)
{
    float top = 0.0f;
    for (const glm::vec3& p : sample.positions()) {
        top = std::max(top, p.z);
    }
    const double tilt = std::min(0.0131, longest / std::max(1.0, 2.0 * static_cast<double>(top)));
    return glm::normalize(glm::dvec3(tilt, 0.61 * tilt, 1.0));
}

bool is_plain(const Sample& sample)
{
    return sample.winds_outward() && !sample.overlaps();
}

// How prism coordinates grow in object space at a place: the inverse of the map's Jacobian, up to a positive factor.
struct Slopes {
    glm::dvec3 q1;
    glm::dvec3 q2;
    glm::dvec3 w;
};

Slopes slopes_at(const PrismTexels& prism, const glm::dvec3& q)
{
    std::array<glm::dvec3, 3> p;
    glm::dvec3 p_w(0.0);
    const glm::dvec3 weights(1.0 - q.x - q.y, q.x, q.y);
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 director = glm::dvec3(prism[i + 3]) - glm::dvec3(prism[i]);
        p[i] = glm::dvec3(prism[i]) + director * q.z;
        p_w += director * weights[i];
    }
    const glm::dvec3 e1 = p[1] - p[0];
    const glm::dvec3 e2 = p[2] - p[0];
    const double sign = glm::dot(e1, glm::cross(e2, p_w)) < 0.0 ? -1.0 : 1.0;
    return {glm::cross(e2, p_w) * sign, glm::cross(p_w, e1) * sign, glm::cross(e1, e2) * sign};
}

// A covector of texture space carried to object space by the inverse transpose of the prism map's Jacobian (survey 2014,
// appendix A), unit length.
glm::dvec3 carried(const PrismTexels& prism, const glm::dvec3& q, const glm::dvec3& covector)
{
    const auto uv = [&](int i) {
        const glm::dvec2 base(prism[i].w, prism[6][i]);
        const glm::dvec2 top(prism[i + 3].w, prism[6 + (i + 3) / 4][(i + 3) % 4]);
        return std::array<glm::dvec2, 2>{base + (top - base) * q.z, top - base};
    };
    const std::array<std::array<glm::dvec2, 2>, 3> corners{uv(0), uv(1), uv(2)};
    const glm::dvec2 t_q1 = corners[1][0] - corners[0][0];
    const glm::dvec2 t_q2 = corners[2][0] - corners[0][0];
    const glm::dvec2 t_w = corners[0][1] * (1.0 - q.x - q.y) + corners[1][1] * q.x + corners[2][1] * q.y;
    const glm::dvec2 across(covector);
    const Slopes slopes = slopes_at(prism, q);
    return glm::normalize(slopes.q1 * glm::dot(t_q1, across) + slopes.q2 * glm::dot(t_q2, across) +
                          slopes.w * (glm::dot(t_w, across) + covector.z));
}

// Out of the prism at a place on its border: across the end or the fin that is nearest.
glm::dvec3 border_normal(const PrismTexels& prism, const glm::dvec3& q)
{
    const Slopes slopes = slopes_at(prism, q);
    const std::array<double, 5> inward{1.0 - q.x - q.y, q.x, q.y, q.z, 1.0 - q.z};
    const std::array<glm::dvec3, 5> outward{slopes.q1 + slopes.q2, -slopes.q1, -slopes.q2, -slopes.w, slopes.w};
    const auto nearest = std::min_element(inward.begin(), inward.end()) - inward.begin();
    return glm::normalize(outward[static_cast<std::size_t>(nearest)]);
}

}  // namespace

ExactTracer::ExactTracer(const Sample& sample)
    : scale_(1.0, sample.aspect(), sample.height()), plain_(is_plain(sample)), upward_(tilted_up(sample)),
      scene_(sample.positions(), sample.triangles(), lattice_within(sample, static_cast<float>(longest)),
             is_plain(sample) ? TriangleScene::Use::rays : TriangleScene::Use::crossings)
{
}

// By whole periods, so that the scene's copies surround it and single precision is enough.
glm::dvec3 ExactTracer::near_tile(const glm::dvec3& point) const
{
    return {point.x - std::floor(point.x), point.y - std::floor(point.y / scale_.y) * scale_.y, point.z};
}

bool ExactTracer::is_inside(const glm::dvec3& point) const
{
    const glm::vec3 origin(near_tile(point));
    const glm::vec3 dir(upward_);
    if (!plain_) {
        return scene_.count_crossings(origin, dir).winding != 0;
    }
    const TriangleHit hit = scene_.intersect1(origin, dir, 0.0f, std::numeric_limits<float>::infinity());
    return hit.hit && glm::dot(hit.normal, dir) > 0.0f;
}

ExactTracer::Meeting ExactTracer::meet(const glm::dvec3& start, const glm::dvec3& end) const
{
    const double length = glm::length(end - start);
    if (!(length > 0.0)) {
        return {};
    }
    const glm::dvec3 dir = (end - start) / length;
    const glm::dvec3 local = near_tile(start);
    double before = -rim;
    while (before < length + rim) {
        const TriangleHit hit = scene_.intersect1(glm::vec3(local + dir * before), glm::vec3(dir), 0.0f,
                                                  static_cast<float>(length + rim - before));
        if (!hit.hit) {
            return {};
        }
        const double along = before + hit.t;
        const glm::dvec3 normal(hit.normal);
        const bool leaves = glm::dot(normal, dir) > 0.0;
        if (plain_ && leaves && along <= 2.0 * rim) {
            before = along + 0.1 * rim;  // it was in the solid for no longer than the rim
            continue;
        }
        if (plain_ && leaves) {
            return {Meeting::Kind::inside, 0.0, glm::dvec3(0.0)};
        }
        return {Meeting::Kind::surface, along / length, leaves ? -normal : normal};
    }
    return {};
}

// From the chord to the curve: where that meets the surface's plane, by secants as steep as the chord. Where that is at less
// than six degrees it stays within ten times the bulge: the plane may end there.
double ExactTracer::on_curve(const ExactPath& path, double a, double b, const glm::dvec3& start, const glm::dvec3& end,
                             const Meeting& meeting) const
{
    const double first = std::clamp(meeting.along, 0.0, 1.0);
    const double most = 10.0 * most_bulge / glm::length(end - start);
    const double low = std::max(0.0, first - most);
    const double high = std::min(1.0, first + most);
    const glm::dvec3 on_plane = start + (end - start) * meeting.along;
    const double rise = glm::dot(meeting.normal, end - start);
    double along = first;
    for (int step = 0; step < 3 && rise != 0.0; ++step) {
        const double off = glm::dot(meeting.normal, path.texture_at(a + (b - a) * along) * scale_ - on_plane);
        along = std::clamp(along - off / rise, low, high);
    }
    return a + (b - a) * along;
}

ExactHit ExactTracer::nearest(const PrismTexels& prism, const ExactRay& ray, double t_near, double t_far) const
{
    ExactPath path(prism, ray);
    path.begin_at(t_near);
    ExactHit result;
    for (int i = 0; i < path.span_count() && path.span(i).t_in < t_far && !result.hit; ++i) {
        result = nearest_in_span(prism, ray, path, path.span(i));
    }
    return result;
}

ExactHit ExactTracer::nearest_in_span(const PrismTexels& prism, const ExactRay& ray, const ExactPath& path,
                                      const ExactSpan& span) const
{
    const auto hit_at = [&](double s) {
        const ExactPlace place = path.at(s);
        return ExactHit{true, std::clamp(place.t, span.t_in, span.t_out), place.q, place.texture, glm::dvec3(0.0)};
    };
    const auto begins_inside = [&] {
        ExactHit hit = hit_at(span.s_in);
        hit.normal = span.cut ? -glm::normalize(ray.dir) : border_normal(prism, hit.q);
        return hit;
    };
    const glm::dvec3 entry = path.texture_at(span.s_in) * scale_;
    if (!plain_ && is_inside(entry)) {
        return begins_inside();
    }
    double a = span.s_in;
    glm::dvec3 start = entry;
    double step = span.s_out - span.s_in;
    const double least = std::abs(step) * least_step;
    while (a != span.s_out) {
        // As far as a chord may go. How far it bulges grows by the square of its length.
        double b = 0.0;
        glm::dvec3 end;
        for (;;) {
            b = std::abs(step) < 0.999 * std::abs(span.s_out - a) ? a + step : span.s_out;
            end = path.texture_at(b) * scale_;
            const glm::dvec2 sideways = glm::abs(glm::dvec2(end - start));
            const double room = std::min(longest / std::max(sideways.x, sideways.y),
                                         std::sqrt(most_bulge / path.bulge(a, b, scale_)));
            step = (b - a) * std::clamp(0.95 * room, 0.25, 2.0);
            if (room >= 1.0 || std::abs(b - a) <= least) {
                break;
            }
        }
        const Meeting meeting = meet(start, end);
        if (meeting.kind == Meeting::Kind::inside) {
            return begins_inside();
        }
        if (meeting.kind == Meeting::Kind::surface) {
            ExactHit hit = hit_at(on_curve(path, a, b, start, end, meeting));
            hit.normal = carried(prism, hit.q, meeting.normal * scale_);
            return hit;
        }
        a = b;
        start = end;
    }
    return plain_ && is_inside(entry) ? begins_inside() : ExactHit{};
}

}  // namespace mesoshell
