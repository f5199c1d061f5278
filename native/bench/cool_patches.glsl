// The stretches of a ray in a prism by its crossings with three bilinear patches and two triangles: what
// shaders/lib/prism_path.glsl is measured against. Found by another road, they are also its independent check.
//
// Reshetov 2019, "Cool patches": for each line of a patch from base to top there is one that meets the ray, given by a
// quadratic in where it starts along the base. Here that is dot(p(s), cross(dir, d(s))) = 0 with p and d linear in s.
#include "../../shaders/lib/prism_path.glsl"

// Up to two crossings of a fin: ray parameters (3e38 for none), shares of column j, heights.
struct PatchCrossings {
    vec2 t;
    vec2 along;
    vec2 w;
};

// (t, height) where the ray meets the line p + w up; t = 3e38 outside its heights.
vec2 cross_line(vec3 p, vec3 up, vec3 dir)
{
    vec3 across = cross(dir, up);
    float size = dot(across, across);
    vec3 moment = cross(across, p);
    float w = dot(moment, dir) / size;
    return vec2(w >= 0.0f && w <= 1.0f ? dot(moment, up) / size : 3.0e38f, w);
}

// base_i and base_j are relative to the ray's origin.
PatchCrossings cross_patch(vec3 base_i, vec3 base_j, vec3 director_i, vec3 director_j, vec3 dir)
{
    float at_i = dot(cross(base_i, dir), director_i);
    float at_j = dot(cross(base_j, dir), director_j);
    float bend = dot(cross(base_j - base_i, dir), director_j - director_i);
    vec2 roots = quadratic_roots(at_i, at_j - at_i - bend, bend);
    vec2 first = cross_line(mix(base_i, base_j, roots.x), mix(director_i, director_j, roots.x), dir);
    vec2 second = cross_line(mix(base_i, base_j, roots.y), mix(director_i, director_j, roots.y), dir);
    PatchCrossings result;
    result.t = vec2(roots.x >= 0.0f && roots.x <= 1.0f ? first.x : 3.0e38f, roots.y >= 0.0f && roots.y <= 1.0f ? second.x : 3.0e38f);
    result.along = roots;
    result.w = vec2(first.y, second.y);
    return result;
}

// (t, weights of corners 1 and 2) where the ray meets a triangle, relative to its origin.
vec3 cross_triangle(vec3 p0, vec3 p1, vec3 p2, vec3 dir)
{
    vec3 normal = cross(p1 - p0, p2 - p0);
    float along = dot(normal, dir);
    vec3 moment = cross(dir, p0);
    float q1 = -dot(moment, p2 - p0) / along;
    float q2 = dot(moment, p1 - p0) / along;
    bool inside = along != 0.0f && q1 >= 0.0f && q2 >= 0.0f && q1 + q2 <= 1.0f;
    return vec3(inside ? dot(normal, p0) / along : 3.0e38f, q1, q2);
}

struct CoolPath {
    PatchCrossings fin_0;  // from column 0 to 1
    PatchCrossings fin_1;
    PatchCrossings fin_2;
    vec3 bottom;
    vec3 top;
};

CoolPath make_cool_path(Prism prism, vec3 origin, vec3 dir)
{
    vec3 base_0 = prism.base[0] - origin;
    vec3 base_1 = prism.base[1] - origin;
    vec3 base_2 = prism.base[2] - origin;
    CoolPath path;
    path.fin_0 = cross_patch(base_0, base_1, prism.director[0], prism.director[1], dir);
    path.fin_1 = cross_patch(base_1, base_2, prism.director[1], prism.director[2], dir);
    path.fin_2 = cross_patch(base_2, base_0, prism.director[2], prism.director[0], dir);
    path.bottom = cross_triangle(base_0, base_1, base_2, dir);
    path.top = cross_triangle(base_0 + prism.director[0], base_1 + prism.director[1], base_2 + prism.director[2], dir);
    return path;
}

// (t, prism coordinates) of the nearer of two crossings beyond t_after.
vec4 nearer_crossing(vec4 nearest, float t, vec3 q, float t_after)
{
    return t > t_after && t < nearest.x ? vec4(t, q) : nearest;
}

vec4 next_crossing(CoolPath path, float t_after)
{
    vec4 n = vec4(3.0e38f, 0.0f, 0.0f, 0.0f);
    n = nearer_crossing(n, path.fin_0.t.x, vec3(path.fin_0.along.x, 0.0f, path.fin_0.w.x), t_after);
    n = nearer_crossing(n, path.fin_0.t.y, vec3(path.fin_0.along.y, 0.0f, path.fin_0.w.y), t_after);
    n = nearer_crossing(n, path.fin_1.t.x, vec3(1.0f - path.fin_1.along.x, path.fin_1.along.x, path.fin_1.w.x), t_after);
    n = nearer_crossing(n, path.fin_1.t.y, vec3(1.0f - path.fin_1.along.y, path.fin_1.along.y, path.fin_1.w.y), t_after);
    n = nearer_crossing(n, path.fin_2.t.x, vec3(0.0f, 1.0f - path.fin_2.along.x, path.fin_2.w.x), t_after);
    n = nearer_crossing(n, path.fin_2.t.y, vec3(0.0f, 1.0f - path.fin_2.along.y, path.fin_2.w.y), t_after);
    n = nearer_crossing(n, path.bottom.x, vec3(path.bottom.y, path.bottom.z, 0.0f), t_after);
    return nearer_crossing(n, path.top.x, vec3(path.top.y, path.top.z, 1.0f), t_after);
}

// Crossings come in pairs: one enters, the next leaves.
PrismSpan cool_span(CoolPath path, float t_after)
{
    vec4 enters = next_crossing(path, t_after);
    vec4 leaves = next_crossing(path, enters.x);
    PrismSpan span;
    span.found = leaves.x < 3.0e38f;
    span.last = true;
    span.t_in = enters.x;
    span.t_out = leaves.x;
    span.q_in = vec3(enters.y, enters.z, enters.w);
    span.q_out = vec3(leaves.y, leaves.z, leaves.w);
    return span;
}
