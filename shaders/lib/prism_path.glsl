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
    bool level;           // the ray runs along an offset triangle: there is no height to solve for
    float level_height;   // of that triangle
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

// A ray that lies in the triangle at one height is there at all its points: all three numerators vanish at that height, and
// where between roots so near one another the ray is cannot be told. How near, in height: that is where the error of
// dividing by a small seen area outgrows that of the derivative in level_span.
const float LEVEL = 1.0e-3f;

// Whether the seen area comes near zero at any height, as it does where all numerators do.
bool may_be_level(PrismPath path)
{
    float bottom = path_area(path, 0.0f);
    float middle = path_area(path, 0.5f);
    float top = path_area(path, 1.0f);
    float bend = path.numerator_2.x + path.numerator_2.y + path.numerator_2.z;
    vec3 steepness = abs(path.numerator_1) + abs(path.numerator_2) * 2.0f;
    float steepest = max(steepness.x, max(steepness.y, steepness.z));
    float nearest = min(abs(middle), min(abs(bottom), abs(top))) - abs(bend) / 16.0f;
    return nearest <= 3.0f * LEVEL * steepest || bottom * middle <= 0.0f || top * middle <= 0.0f;
}

// How far the numerators are from all vanishing at a root of one, as a change in height.
float level_distance(PrismPath path, float w)
{
    vec3 n = abs(path_numerators(path, w));
    vec3 slope = abs(path.numerator_1 + path.numerator_2 * (2.0f * w));
    vec3 steepness = abs(path.numerator_1) + abs(path.numerator_2) * 2.0f;
    float steep = max(slope.x, max(slope.y, slope.z));
    // Where a ray meets the apex of a pyramid they vanish with their slopes.
    bool flat_there = steep <= 0.01f * max(steepness.x, max(steepness.y, steepness.z));
    return flat_there || abs(w - 0.5f) > 0.5f + LEVEL ? 2.0f : max(n.x, max(n.y, n.z)) / steep;
}

// Twice the area of the triangle at height w, squared.
float area_squared(Prism prism, float w)
{
    vec3 p0 = prism.base[0] + prism.director[0] * w;
    vec3 edge_1 = prism.base[1] + prism.director[1] * w - p0;
    vec3 edge_2 = prism.base[2] + prism.director[2] * w - p0;
    vec3 normal = cross(edge_1, edge_2);
    return dot(normal, normal);
}

PrismPath find_level(PrismPath path, Prism prism)
{
    vec3 distance_a = vec3(level_distance(path, path.root_a.x), level_distance(path, path.root_a.y),
                           level_distance(path, path.root_a.z));
    vec3 distance_b = vec3(level_distance(path, path.root_b.x), level_distance(path, path.root_b.y),
                           level_distance(path, path.root_b.z));
    float nearest = LEVEL;
    path.level = false;
    for (int i = 0; i < 3; ++i) {
        if (distance_a[i] <= nearest) {
            nearest = distance_a[i];
            path.level_height = path.root_a[i];
            path.level = true;
        }
        if (distance_b[i] <= nearest) {
            nearest = distance_b[i];
            path.level_height = path.root_b[i];
            path.level = true;
        }
    }
    path.level_height = clamp(path.level_height, 0.0f, 1.0f);
    // At the apex of a pyramid they all vanish for any ray.
    float middle_area = area_squared(prism, 0.5f);
    path.level = path.level && area_squared(prism, path.level_height) > 1.0e-6f * middle_area;
    return path;
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

    path.level_height = 0.0f;
    path.level = may_be_level(path);
    if (path.level) {
        path = find_level(path, prism);
    }
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

// The part of a range of ray parameters where value + change * t is not negative; ends cross where there is none.
vec2 clip_range(vec2 range, float value, float change)
{
    float crossing = change != 0.0f ? -value / change : 0.0f;
    float low = change > 0.0f ? max(range.x, crossing) : range.x;
    float high = change < 0.0f ? min(range.y, crossing) : range.y;
    return change == 0.0f && value < 0.0f ? vec2(1.0f, -1.0f) : vec2(low, high);
}

// How far, in prism coordinates, two prisms share a ray that runs along the edge between them, so that neither loses it.
const float SHARED_RIM = 5.0e-6f;

// The stretch of a ray that runs along the triangle at height w: clipped in the ray's own parameter, by the map's derivative
// where the ray comes nearest to the middle of that triangle.
PrismSpan level_span(Prism prism, vec3 origin, vec3 dir, float w)
{
    PrismSpan span;
    span.found = false;
    span.last = true;
    vec3 middle = vec3(1.0f / 3.0f, 1.0f / 3.0f, w);
    vec3 center = prism_position(prism, middle);
    PlaceSlopes slopes = place_slopes(prism, middle);
    vec3 offset = origin + dir * dot(center - origin, dir) - center;
    // Again from where the ray comes nearest, as along an edge columns lean otherwise than in the middle.
    middle = clamp_place(middle + vec3(dot(slopes.q1, offset), dot(slopes.q2, offset), dot(slopes.w, offset)));
    center = prism_position(prism, middle);
    slopes = place_slopes(prism, middle);
    float t_center = dot(center - origin, dir);
    offset = origin + dir * t_center - center;
    vec4 start = vec4(1.0f - middle.x - middle.y + dot(slopes.q0, offset), middle.x + dot(slopes.q1, offset),
                      middle.y + dot(slopes.q2, offset), middle.z + dot(slopes.w, offset));
    vec4 slope = vec4(dot(slopes.q0, dir), dot(slopes.q1, dir), dot(slopes.q2, dir), dot(slopes.w, dir));
    // Along the ray columns lean otherwise than where the derivative is taken, by as much as directors differ.
    float turn = length(prism.director[1] - prism.director[0]) + length(prism.director[2] - prism.director[0]);
    float rim = SHARED_RIM + 0.25f * turn * abs(slope.w);
    vec2 range = vec2(-3.0e38f, 3.0e38f);
    range = clip_range(range, start.x + rim, slope.x);
    range = clip_range(range, start.y + rim, slope.y);
    range = clip_range(range, start.z + rim, slope.z);
    range = clip_range(range, start.w, slope.w);
    range = clip_range(range, 1.0f - start.w, -slope.w);
    // A prism without volume bounds nothing.
    if (range.x >= range.y || range.x == -3.0e38f || range.y == 3.0e38f) {
        return span;
    }
    span.found = true;
    span.t_in = t_center + range.x;
    span.t_out = t_center + range.y;
    vec4 q_in = start + slope * range.x;
    vec4 q_out = start + slope * range.y;
    // Columns lean otherwise at the ends than in the middle.
    span.q_in = nearer_place(prism, clamp_place(vec3(q_in.y, q_in.z, q_in.w)), center + offset + dir * range.x);
    span.q_out = nearer_place(prism, clamp_place(vec3(q_out.y, q_out.z, q_out.w)), center + offset + dir * range.y);
    return span;
}

// Where to evaluate the end of a stretch: at its height, unless the offset triangle has shrunk to rounding errors there, as
// at the apex of a pyramid; then a sixty-fourth inside.
float end_height(PrismPath path, float w, float w_inside)
{
    float area_middle = path_area(path, 0.5f * (w + w_inside));
    return abs(path_area(path, w)) > 1.0e-5f * abs(area_middle) ? w : mix(w, w_inside, 1.0f / 64.0f);
}

// The nearest stretch of the ray inside the prism that ends beyond t_after. (Two may begin where one of them also ends.)
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
            float t_out = climbs ? t_close : t_open;
            if (t_out > t_after) {
                span.last = !span.found;
                if (t_out < span.t_out) {
                    vec3 q_open = path_coordinates(path, w_low);
                    vec3 q_close = path_coordinates(path, w_high);
                    span.found = true;
                    span.t_in = climbs ? t_open : t_close;
                    span.t_out = t_out;
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
    if (path.level) {
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
