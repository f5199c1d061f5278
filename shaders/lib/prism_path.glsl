// Where a straight ray runs inside a prism with bilinear fins: spans of prism coordinates, without iteration.
//
// Ogaki 2023, "Nonlinear ray tracing for displacement and shell mapping": seen along the ray, the triangle at height w has
// corners linear in w, so the ray's barycentric numerators are quadratics in w, and each depends on the two corner columns of
// one fin alone. Their roots are the fin crossings; a neighbor across a fin finds the same roots.
//
// Nothing here is an array with an index known only at run time: GPUs keep those in memory, which costs ten times the rest.
#ifndef MESOSHELL_LIB_PRISM_PATH
#define MESOSHELL_LIB_PRISM_PATH

#include "prism.glsl"

struct PrismPath {
    vec3 numerator_0;  // N_i(w) = numerator_0 + w numerator_1 + w^2 numerator_2, component i for corner column i
    vec3 numerator_1;
    vec3 numerator_2;
    vec3 depth_base;      // ray parameter of the corners' projections onto the ray, at w = 0
    vec3 depth_director;  // its change from w = 0 to w = 1
    vec3 root_a;          // where N_i is zero; 2 for a root that there is not
    vec3 root_b;
    bool parallel;  // the ray runs along the offset triangles: there is no height to solve for
};

// One stretch of a ray inside a prism.
struct PrismSpan {
    bool found;
    float t_in;  // ray parameter, object-space length when the direction has unit length
    float t_out;
    vec3 q_in;  // prism coordinates
    vec3 q_out;
    bool last;  // there is none after it
};

float cross_2d(vec2 a, vec2 b)
{
    return a.x * b.y - a.y * b.x;
}

vec3 path_numerators(PrismPath path, float w)
{
    return path.numerator_0 + (path.numerator_1 + path.numerator_2 * w) * w;
}

float path_area(PrismPath path, float w)
{
    vec3 n = path_numerators(path, w);
    return n.x + n.y + n.z;
}

// Ray parameter where the ray is at height w.
float path_depth(PrismPath path, float w)
{
    vec3 n = path_numerators(path, w);
    return dot(n, path.depth_base + path.depth_director * w) / (n.x + n.y + n.z);
}

vec3 path_coordinates(PrismPath path, float w)
{
    vec3 n = path_numerators(path, w);
    float area = n.x + n.y + n.z;
    return vec3(clamp(n.y / area, 0.0f, 1.0f), clamp(n.z / area, 0.0f, 1.0f), w);
}

// The roots of c0 + c1 w + c2 w^2; 2 stands for none, so that it is outside every prism. Negating all three coefficients
// leaves every bit of the roots: that is what the other side of a fin does.
vec2 quadratic_roots(float c0, float c1, float c2)
{
    float discriminant = c1 * c1 - 4.0f * c0 * c2;
    if (discriminant < 0.0f) {
        return vec2(2.0f, 2.0f);
    }
    float root = sqrt(discriminant);
    float half_sum = -0.5f * (c1 < 0.0f ? c1 - root : c1 + root);
    float first = c2 != 0.0f ? half_sum / c2 : 2.0f;
    float second = half_sum != 0.0f ? c0 / half_sum : 2.0f;
    return vec2(first, second);
}

PrismPath make_prism_path(Prism prism, vec3 origin, vec3 dir)
{
    // The frame depends on the ray alone, so that neighbors project a shared corner to the same bits.
    vec3 helper = abs(dir.z) < 0.7f ? vec3(0.0f, 0.0f, 1.0f) : vec3(1.0f, 0.0f, 0.0f);
    vec3 side = normalize(cross(helper, dir));
    vec3 up = cross(dir, side);
    vec2 base[3];
    vec2 director[3];
    PrismPath path;
    for (int i = 0; i < 3; ++i) {
        vec3 offset = prism.base[i] - origin;
        base[i] = vec2(dot(offset, side), dot(offset, up));
        director[i] = vec2(dot(prism.director[i], side), dot(prism.director[i], up));
        path.depth_base[i] = dot(offset, dir);
        path.depth_director[i] = dot(prism.director[i], dir);
    }
    path.numerator_0 = vec3(cross_2d(base[1], base[2]), cross_2d(base[2], base[0]), cross_2d(base[0], base[1]));
    path.numerator_1 = vec3(cross_2d(base[1], director[2]) + cross_2d(director[1], base[2]),
                            cross_2d(base[2], director[0]) + cross_2d(director[2], base[0]),
                            cross_2d(base[0], director[1]) + cross_2d(director[0], base[1]));
    path.numerator_2 = vec3(cross_2d(director[1], director[2]), cross_2d(director[2], director[0]),
                            cross_2d(director[0], director[1]));
    vec2 roots_0 = quadratic_roots(path.numerator_0.x, path.numerator_1.x, path.numerator_2.x);
    vec2 roots_1 = quadratic_roots(path.numerator_0.y, path.numerator_1.y, path.numerator_2.y);
    vec2 roots_2 = quadratic_roots(path.numerator_0.z, path.numerator_1.z, path.numerator_2.z);
    path.root_a = vec3(roots_0.x, roots_1.x, roots_2.x);
    path.root_b = vec3(roots_0.y, roots_1.y, roots_2.y);

    float widest = max(abs(path_area(path, 0.5f)), max(abs(path_area(path, 0.0f)), abs(path_area(path, 1.0f))));
    vec3 true_area = cross(prism.base[1] - prism.base[0], prism.base[2] - prism.base[0]);
    path.parallel = widest <= 1.0e-4f * length(true_area);
    return path;
}

float nearer_cut(float nearest, float root, float w)
{
    return root > w && root < nearest ? root : nearest;
}

// The least root above w, at most 1: up to there no numerator changes its sign.
float next_cut(PrismPath path, float w)
{
    float cut = nearer_cut(nearer_cut(1.0f, path.root_a.x, w), path.root_b.x, w);
    cut = nearer_cut(nearer_cut(cut, path.root_a.y, w), path.root_b.y, w);
    return nearer_cut(nearer_cut(cut, path.root_a.z, w), path.root_b.z, w);
}

// A ray that runs along the offset triangles stays at one height: the triangle there is clipped in the ray's own parameter.
PrismSpan parallel_span(Prism prism, vec3 origin, vec3 dir)
{
    PrismSpan span;
    span.found = false;
    span.last = true;
    vec3 normal = cross(prism.base[1] - prism.base[0], prism.base[2] - prism.base[0]);
    vec3 center = (prism.base[0] + prism.base[1] + prism.base[2]) / 3.0f;
    float t_center = dot(center - origin, dir);
    vec3 closest = origin + dir * t_center;
    vec3 rise = (prism.director[0] + prism.director[1] + prism.director[2]) / 3.0f;
    float thickness = dot(rise, normal);
    float w = thickness != 0.0f ? dot(closest - center, normal) / thickness : 2.0f;
    if (w < 0.0f || w > 1.0f) {
        return span;
    }
    vec3 p0 = prism.base[0] + prism.director[0] * w;
    vec3 p1 = prism.base[1] + prism.director[1] * w;
    vec3 p2 = prism.base[2] + prism.director[2] * w;
    vec3 area_normal = cross(p1 - p0, p2 - p0);
    float area_squared = dot(area_normal, area_normal);
    if (area_squared == 0.0f) {
        return span;
    }
    // Weights of the three corner columns along the ray: start + t slope.
    vec3 to_1 = cross(p2 - p0, area_normal) / area_squared;
    vec3 to_2 = cross(area_normal, p1 - p0) / area_squared;
    float start_1 = dot(closest - p0, to_1);
    float start_2 = dot(closest - p0, to_2);
    vec3 start = vec3(1.0f - start_1 - start_2, start_1, start_2);
    vec3 slope = vec3(-dot(dir, to_1) - dot(dir, to_2), dot(dir, to_1), dot(dir, to_2));
    float t_low = -3.0e38f;
    float t_high = 3.0e38f;
    for (int i = 0; i < 3; ++i) {
        float crossing = slope[i] != 0.0f ? -start[i] / slope[i] : 0.0f;
        if (slope[i] > 0.0f) {
            t_low = max(t_low, crossing);
        } else if (slope[i] < 0.0f) {
            t_high = min(t_high, crossing);
        } else if (start[i] < 0.0f) {
            return span;
        }
    }
    if (t_low >= t_high) {
        return span;
    }
    span.found = true;
    span.t_in = t_center + t_low;
    span.t_out = t_center + t_high;
    span.q_in = vec3(start.y + slope.y * t_low, start.z + slope.z * t_low, w);
    span.q_out = vec3(start.y + slope.y * t_high, start.z + slope.z * t_high, w);
    return span;
}

// Where to evaluate the end of a stretch: at its height, unless the offset triangle has shrunk to rounding errors there, as
// at the apex of a pyramid; then a sixty-fourth inside.
float end_height(PrismPath path, float w, float w_inside)
{
    float area_middle = path_area(path, 0.5f * (w + w_inside));
    return abs(path_area(path, w)) > 1.0e-5f * abs(area_middle) ? w : mix(w, w_inside, 1.0f / 64.0f);
}

// The nearest stretch of the ray inside the prism that begins beyond t_after.
PrismSpan next_span(PrismPath path, float t_after)
{
    PrismSpan span;
    span.found = false;
    span.last = true;
    span.t_in = 3.0e38f;
    span.t_out = 3.0e38f;
    span.q_in = vec3(0.0f);
    span.q_out = vec3(0.0f);
    float w = 0.0f;
    float w_open = 0.0f;
    bool open = false;
    // Six roots cut the heights into seven parts; parts that touch are one stretch. An eighth pass closes the last.
    for (int part = 0; part < 8; ++part) {
        float w_close = next_cut(path, w);
        vec3 n = path_numerators(path, 0.5f * (w + w_close));
        float least = min(n.x, min(n.y, n.z));
        float most = max(n.x, max(n.y, n.z));
        // A ray in a fin is inside both prisms beside it, so that none loses it.
        bool inside = w < 1.0f && ((least >= 0.0f && most > 0.0f) || (most <= 0.0f && least < 0.0f));
        if (inside && !open) {
            w_open = w;
        }
        if (open && !inside) {
            float w_low = end_height(path, w_open, w);
            float w_high = end_height(path, w, w_open);
            float t_open = path_depth(path, w_low);
            float t_close = path_depth(path, w_high);
            bool climbs = t_open <= t_close;
            float t_in = climbs ? t_open : t_close;
            if (t_in > t_after) {
                span.last = !span.found;
                if (t_in < span.t_in) {
                    vec3 q_open = path_coordinates(path, w_low);
                    vec3 q_close = path_coordinates(path, w_high);
                    span.found = true;
                    span.t_in = t_in;
                    span.t_out = climbs ? t_close : t_open;
                    span.q_in = climbs ? q_open : q_close;
                    span.q_out = climbs ? q_close : q_open;
                }
            }
        }
        open = inside;
        if (w >= 1.0f) {
            break;
        }
        w = w_close;
    }
    return span;
}

// The part of a span beyond t_near: a camera inside the shell sees it from its near plane on.
PrismSpan clip_span(PrismPath path, PrismSpan span, float t_near)
{
    if (!span.found || span.t_in >= t_near) {
        return span;
    }
    if (span.t_out <= t_near) {
        span.found = false;
        return span;
    }
    if (path.parallel) {
        span.q_in = mix(span.q_in, span.q_out, (t_near - span.t_in) / (span.t_out - span.t_in));
    } else {
        // Height is monotone along a span, but its inverse is a rational function: bisect.
        float w_before = span.q_in.z;
        float w_after = span.q_out.z;
        for (int step = 0; step < 24; ++step) {
            float w = 0.5f * (w_before + w_after);
            bool before = path_depth(path, w) < t_near;
            w_before = before ? w : w_before;
            w_after = before ? w_after : w;
        }
        span.q_in = path_coordinates(path, w_after);
    }
    span.t_in = t_near;
    return span;
}

#endif
