// Where a straight ray runs inside a prism with bilinear fins: spans of prism coordinates, without iteration.
//
// Ogaki 2023, "Nonlinear ray tracing for displacement and shell mapping": seen along the ray, the triangle at height w has
// corners linear in w, so the ray's barycentric numerators are quadratics in w, and each depends on the two corner columns of
// one fin alone. Their roots are the fin crossings; a neighbor across a fin finds the same roots.
#ifndef MESOSHELL_LIB_PRISM_PATH
#define MESOSHELL_LIB_PRISM_PATH

#include "prism.glsl"

struct PrismPath {
    vec3 numerator_0;  // N_i(w) = numerator_0 + w numerator_1 + w^2 numerator_2, component i for corner column i
    vec3 numerator_1;
    vec3 numerator_2;
    vec3 depth_base;      // ray parameter of the corners' projections onto the ray, at w = 0
    vec3 depth_director;  // its change from w = 0 to w = 1
};

// Up to three stretches of a ray inside one prism, nearest first.
struct PrismSpans {
    int count;
    float t_in[3];  // ray parameter, object-space length when the direction has unit length
    float t_out[3];
    vec3 q_in[3];  // prism coordinates
    vec3 q_out[3];
};

float cross_2d(vec2 a, vec2 b)
{
    return a.x * b.y - a.y * b.x;
}

PrismPath make_prism_path(Prism prism, vec3 origin, vec3 dir)
{
    // The frame depends on the ray alone, so that neighbors project a shared corner to the same bits.
    vec3 helper = abs(dir.z) < 0.7f ? vec3(0.0f, 0.0f, 1.0f) : vec3(1.0f, 0.0f, 0.0f);
    vec3 side = normalize(cross(helper, dir));
    vec3 up = cross(dir, side);
    vec2 base[3];
    vec2 director[3];
    vec3 depth_base;
    vec3 depth_director;
    for (int i = 0; i < 3; ++i) {
        vec3 offset = prism.base[i] - origin;
        base[i] = vec2(dot(offset, side), dot(offset, up));
        director[i] = vec2(dot(prism.director[i], side), dot(prism.director[i], up));
        depth_base[i] = dot(offset, dir);
        depth_director[i] = dot(prism.director[i], dir);
    }
    PrismPath path;
    path.depth_base = depth_base;
    path.depth_director = depth_director;
    for (int i = 0; i < 3; ++i) {
        int j = i == 2 ? 0 : i + 1;
        int k = j == 2 ? 0 : j + 1;
        path.numerator_0[i] = cross_2d(base[j], base[k]);
        path.numerator_1[i] = cross_2d(base[j], director[k]) + cross_2d(director[j], base[k]);
        path.numerator_2[i] = cross_2d(director[j], director[k]);
    }
    return path;
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

PrismSpans insert_span(PrismSpans spans, float t_a, float t_b, vec3 q_a, vec3 q_b)
{
    if (spans.count == 3) {
        return spans;
    }
    bool forward = t_a <= t_b;
    float t_in = forward ? t_a : t_b;
    int slot = spans.count;
    while (slot > 0 && spans.t_in[slot - 1] > t_in) {
        spans.t_in[slot] = spans.t_in[slot - 1];
        spans.t_out[slot] = spans.t_out[slot - 1];
        spans.q_in[slot] = spans.q_in[slot - 1];
        spans.q_out[slot] = spans.q_out[slot - 1];
        slot -= 1;
    }
    spans.t_in[slot] = t_in;
    spans.t_out[slot] = forward ? t_b : t_a;
    spans.q_in[slot] = forward ? q_a : q_b;
    spans.q_out[slot] = forward ? q_b : q_a;
    spans.count += 1;
    return spans;
}

// A ray that runs along the offset triangles has no height to solve for: it stays at one height, and the triangle there is
// clipped in the ray's own parameter.
PrismSpans parallel_spans(Prism prism, vec3 origin, vec3 dir)
{
    PrismSpans spans;
    spans.count = 0;
    vec3 normal = cross(prism.base[1] - prism.base[0], prism.base[2] - prism.base[0]);
    vec3 center = (prism.base[0] + prism.base[1] + prism.base[2]) / 3.0f;
    float t_center = dot(center - origin, dir);
    vec3 closest = origin + dir * t_center;
    vec3 rise = (prism.director[0] + prism.director[1] + prism.director[2]) / 3.0f;
    float thickness = dot(rise, normal);
    float w = thickness != 0.0f ? dot(closest - center, normal) / thickness : 2.0f;
    if (w < 0.0f || w > 1.0f) {
        return spans;
    }
    vec3 p0 = prism.base[0] + prism.director[0] * w;
    vec3 p1 = prism.base[1] + prism.director[1] * w;
    vec3 p2 = prism.base[2] + prism.director[2] * w;
    vec3 area_normal = cross(p1 - p0, p2 - p0);
    float area_squared = dot(area_normal, area_normal);
    // Weights of corner columns 1 and 2 along the ray: start + t slope.
    vec3 to_1 = cross(p2 - p0, area_normal) / area_squared;
    vec3 to_2 = cross(area_normal, p1 - p0) / area_squared;
    vec2 start = vec2(dot(closest - p0, to_1), dot(closest - p0, to_2));
    vec2 slope = vec2(dot(dir, to_1), dot(dir, to_2));
    float t_low = -3.0e38f;
    float t_high = 3.0e38f;
    for (int i = 0; i < 3; ++i) {
        float value = i == 0 ? 1.0f - start.x - start.y : (i == 1 ? start.x : start.y);
        float change = i == 0 ? -slope.x - slope.y : (i == 1 ? slope.x : slope.y);
        if (change == 0.0f) {
            if (value < 0.0f) {
                return spans;
            }
        } else if (change > 0.0f) {
            t_low = max(t_low, -value / change);
        } else {
            t_high = min(t_high, -value / change);
        }
    }
    if (t_low >= t_high) {
        return spans;
    }
    vec3 q_low = vec3(start.x + slope.x * t_low, start.y + slope.y * t_low, w);
    vec3 q_high = vec3(start.x + slope.x * t_high, start.y + slope.y * t_high, w);
    return insert_span(spans, t_center + t_low, t_center + t_high, q_low, q_high);
}

// Every stretch of the ray inside the prism, in front of t_near.
PrismSpans prism_spans(Prism prism, vec3 origin, vec3 dir, float t_near)
{
    PrismSpans spans;
    spans.count = 0;
    PrismPath path = make_prism_path(prism, origin, dir);

    vec3 true_area = cross(prism.base[1] - prism.base[0], prism.base[2] - prism.base[0]);
    float flat_limit = 1.0e-4f * length(true_area);
    float widest = max(max(abs(path_area(path, 0.0f)), abs(path_area(path, 0.5f))), abs(path_area(path, 1.0f)));
    if (widest <= flat_limit) {
        spans = parallel_spans(prism, origin, dir);
    } else {
        float cut[8];
        int count = 1;
        cut[0] = 0.0f;
        for (int i = 0; i < 3; ++i) {
            vec2 roots = quadratic_roots(path.numerator_0[i], path.numerator_1[i], path.numerator_2[i]);
            for (int side = 0; side < 2; ++side) {
                float root = side == 0 ? roots.x : roots.y;
                if (root > 0.0f && root < 1.0f) {
                    int slot = count;
                    while (cut[slot - 1] > root) {
                        cut[slot] = cut[slot - 1];
                        slot -= 1;
                    }
                    cut[slot] = root;
                    count += 1;
                }
            }
        }
        cut[count] = 1.0f;
        // Between two cuts no numerator changes sign: the ray is inside where all three agree. Stretches that touch are one.
        bool open = false;
        float w_open = 0.0f;
        for (int i = 0; i < count; ++i) {
            vec3 n = path_numerators(path, 0.5f * (cut[i] + cut[i + 1]));
            bool inside = min(n.x, min(n.y, n.z)) > 0.0f || max(n.x, max(n.y, n.z)) < 0.0f;
            if (inside && !open) {
                w_open = cut[i];
                open = true;
            }
            bool last = i == count - 1;
            if (open && (!inside || last)) {
                float w_close = inside ? 1.0f : cut[i];
                spans = insert_span(spans, path_depth(path, w_open), path_depth(path, w_close),
                                    path_coordinates(path, w_open), path_coordinates(path, w_close));
                open = false;
            }
        }
    }

    // A camera inside the shell sees it from its near plane on.
    PrismSpans seen;
    seen.count = 0;
    for (int i = 0; i < spans.count; ++i) {
        if (spans.t_out[i] <= t_near) {
            continue;
        }
        float t_in = spans.t_in[i];
        vec3 q_in = spans.q_in[i];
        if (t_in < t_near) {
            float w_before = q_in.z;
            float w_after = spans.q_out[i].z;
            if (widest > flat_limit) {
                // Height is monotone along a span, but its inverse is a rational function: bisect.
                for (int step = 0; step < 24; ++step) {
                    float w = 0.5f * (w_before + w_after);
                    if (path_depth(path, w) < t_near) {
                        w_before = w;
                    } else {
                        w_after = w;
                    }
                }
                q_in = path_coordinates(path, w_after);
            } else {
                q_in = mix(q_in, spans.q_out[i], (t_near - t_in) / (spans.t_out[i] - t_in));
            }
            t_in = t_near;
        }
        seen = insert_span(seen, t_in, spans.t_out[i], q_in, spans.q_out[i]);
    }
    return seen;
}

#endif
