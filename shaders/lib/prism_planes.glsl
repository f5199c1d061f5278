// Where a ray runs inside a prism whose fins are two planes each, as in the paper: a coarser stand-in for the fins of
// prism_path.glsl.
//
// GDM paper, section 3.2: each fin is two triangles, of which a ray meets the planes. Where they form a convex side the
// nearer plane ends the ray, where they form a concave side the farther. The paper does not say which diagonal divides a
// fin; here both prisms beside it choose the same one, so that no ray is lost between them: what is convex for one is
// concave for the other. The paper rasterizes where rays enter; here the same rule, with the signs turned, says that too.
#ifndef MESOSHELL_LIB_PRISM_PLANES
#define MESOSHELL_LIB_PRISM_PLANES

#include "prism_path.glsl"

// A ray against the two planes of a fin: inside from `low` to `high`, but for a gap where the ray leaves through one side of
// a concave fin and comes back through the other.
struct FinPlanes {
    float low;
    float high;
    float gap_low;  // 3e38 to -3e38 where there is no gap
    float gap_high;
};

// The diagonal begins at the base of the column that comes first in this order.
bool precedes(vec3 a, vec3 b)
{
    if (a.x != b.x) {
        return a.x < b.x;
    }
    return a.y != b.y ? a.y < b.y : a.z < b.z;
}

// The ray parameter, and 1 where the ray leaves through the plane, -1 where it enters.
vec2 meet_plane(vec3 offset, vec3 normal, vec3 dir)
{
    float along = dot(dir, normal);
    along = along == 0.0f ? 1.0e-30f : along;
    return vec2(dot(offset, normal) / along, along > 0.0f ? 1.0f : -1.0f);
}

// base_i is relative to the ray's origin; columns i and j in the prism's order, so that the normals point outward.
FinPlanes meet_fin(vec3 base_i, vec3 base_j, vec3 director_i, vec3 director_j, bool rises, vec3 dir)
{
    vec3 edge = base_j - base_i;
    vec3 across = rises ? edge + director_j : director_i;
    vec3 normal_1 = cross(edge, across);
    vec3 normal_2 = rises ? cross(across, director_i) : cross(director_j, director_i - edge);
    vec3 fourth = rises ? director_i : edge + director_j;
    bool convex = dot(normal_1, fourth) <= 0.0f;
    // A column without height leaves one triangle.
    normal_1 = dot(normal_1, normal_1) == 0.0f ? normal_2 : normal_1;
    normal_2 = dot(normal_2, normal_2) == 0.0f ? normal_1 : normal_2;
    vec2 first = meet_plane(base_i, normal_1, dir);
    vec2 second = meet_plane(rises ? base_i : base_j, normal_2, dir);
    FinPlanes fin;
    float low_1 = first.y < 0.0f ? first.x : -3.0e38f;
    float low_2 = second.y < 0.0f ? second.x : -3.0e38f;
    float high_1 = first.y > 0.0f ? first.x : 3.0e38f;
    float high_2 = second.y > 0.0f ? second.x : 3.0e38f;
    fin.low = convex ? max(low_1, low_2) : min(low_1, low_2);
    fin.high = convex ? min(high_1, high_2) : max(high_1, high_2);
    float gap_low = min(high_1, high_2);
    float gap_high = max(low_1, low_2);
    bool gap = !convex && gap_low < gap_high;
    fin.gap_low = gap ? gap_low : 3.0e38f;
    fin.gap_high = gap ? gap_high : -3.0e38f;
    return fin;
}

// Weights of corners b and c of a triangle at a point in its plane; 0 where it has no area.
vec2 triangle_weights(vec3 a, vec3 b, vec3 c, vec3 point)
{
    vec3 normal = cross(b - a, c - a);
    float area = dot(normal, normal);
    float scale = area > 0.0f ? 1.0f / area : 0.0f;
    return vec2(dot(cross(point - a, c - a), normal) * scale, dot(cross(b - a, point - a), normal) * scale);
}

// How far from column i to column j, and the height, of a point on one of a fin's triangles.
vec2 place_on_fin(vec3 base_i, vec3 base_j, vec3 director_i, vec3 director_j, bool rises, vec3 point)
{
    vec3 top_i = base_i + director_i;
    vec3 top_j = base_j + director_j;
    vec2 first = triangle_weights(base_i, base_j, rises ? top_j : top_i, point);
    vec2 second = rises ? triangle_weights(base_i, top_j, top_i, point) : triangle_weights(base_j, top_j, top_i, point);
    if (rises) {
        return first.x >= 0.0f ? vec2(first.x + first.y, first.y) : vec2(second.x, second.x + second.y);
    }
    return first.x + first.y <= 1.0f ? first : vec2(1.0f - second.y, second.x + second.y);
}

const int FACE_BOTTOM = 3;  // 0 to 2: the fin from that column to the next
const int FACE_TOP = 4;

vec3 place_on_face(Prism prism, int face, vec3 point)
{
    if (face == FACE_BOTTOM) {
        return vec3(triangle_weights(prism.base[0], prism.base[1], prism.base[2], point), 0.0f);
    }
    if (face == FACE_TOP) {
        return vec3(triangle_weights(prism.base[0] + prism.director[0], prism.base[1] + prism.director[1],
                                     prism.base[2] + prism.director[2], point), 1.0f);
    }
    if (face == 0) {
        vec2 place = place_on_fin(prism.base[0], prism.base[1], prism.director[0], prism.director[1],
                                  precedes(prism.base[0], prism.base[1]), point);
        return vec3(place.x, 0.0f, place.y);
    }
    if (face == 1) {
        vec2 place = place_on_fin(prism.base[1], prism.base[2], prism.director[1], prism.director[2],
                                  precedes(prism.base[1], prism.base[2]), point);
        return vec3(1.0f - place.x, place.x, place.y);
    }
    vec2 place = place_on_fin(prism.base[2], prism.base[0], prism.director[2], prism.director[0],
                              precedes(prism.base[2], prism.base[0]), point);
    return vec3(0.0f, 1.0f - place.x, place.y);
}

struct FaceHit {
    float t;
    int face;
};

FaceHit farther_of(FaceHit a, float t, int face)
{
    FaceHit b;
    b.t = t;
    b.face = face;
    return t > a.t ? b : a;
}

FaceHit nearer_of(FaceHit a, float t, int face)
{
    FaceHit b;
    b.t = t;
    b.face = face;
    return t < a.t ? b : a;
}

bool in_gap(FinPlanes fin, float t)
{
    return t >= fin.gap_low && t < fin.gap_high;
}

// The nearest stretch of the ray inside the prism that ends beyond t_after.
PrismSpan plane_span(Prism prism, vec3 origin, vec3 dir, float t_after)
{
    vec3 base_0 = prism.base[0] - origin;
    vec3 base_1 = prism.base[1] - origin;
    vec3 base_2 = prism.base[2] - origin;
    bool rises_0 = precedes(prism.base[0], prism.base[1]);
    bool rises_1 = precedes(prism.base[1], prism.base[2]);
    bool rises_2 = precedes(prism.base[2], prism.base[0]);
    FinPlanes fin_0 = meet_fin(base_0, base_1, prism.director[0], prism.director[1], rises_0, dir);
    FinPlanes fin_1 = meet_fin(base_1, base_2, prism.director[1], prism.director[2], rises_1, dir);
    FinPlanes fin_2 = meet_fin(base_2, base_0, prism.director[2], prism.director[0], rises_2, dir);
    vec3 edge_1 = base_1 - base_0;
    vec3 edge_2 = base_2 - base_0;
    vec2 bottom = meet_plane(base_0, cross(edge_2, edge_1), dir);
    vec2 top = meet_plane(base_0 + prism.director[0], cross(edge_1 + prism.director[1] - prism.director[0],
                                                            edge_2 + prism.director[2] - prism.director[0]), dir);
    FaceHit begin;
    begin.t = fin_0.low;
    begin.face = 0;
    begin = farther_of(farther_of(begin, fin_1.low, 1), fin_2.low, 2);
    begin = farther_of(begin, bottom.y < 0.0f ? bottom.x : -3.0e38f, FACE_BOTTOM);
    begin = farther_of(begin, top.y < 0.0f ? top.x : -3.0e38f, FACE_TOP);
    FaceHit end;
    end.t = fin_0.high;
    end.face = 0;
    end = nearer_of(nearer_of(end, fin_1.high, 1), fin_2.high, 2);
    end = nearer_of(end, bottom.y > 0.0f ? bottom.x : 3.0e38f, FACE_BOTTOM);
    end = nearer_of(end, top.y > 0.0f ? top.x : 3.0e38f, FACE_TOP);

    PrismSpan span;
    span.found = false;
    span.last = true;
    span.t_in = 3.0e38f;
    span.t_out = 3.0e38f;
    span.q_in = vec3(0.0f);
    span.q_out = vec3(0.0f);
    // It begins there or where a gap ends; each of three gaps may hold the end of another.
    for (int i = 0; i < 3; ++i) {
        if (begin.t <= t_after || in_gap(fin_0, begin.t) || in_gap(fin_1, begin.t) || in_gap(fin_2, begin.t)) {
            float least = max(begin.t, t_after);
            begin.t = 3.0e38f;
            begin = nearer_of(begin, fin_0.gap_high > least ? fin_0.gap_high : 3.0e38f, 0);
            begin = nearer_of(begin, fin_1.gap_high > least ? fin_1.gap_high : 3.0e38f, 1);
            begin = nearer_of(begin, fin_2.gap_high > least ? fin_2.gap_high : 3.0e38f, 2);
        }
    }
    // Prisms that fold may have no plane that ends them.
    if (begin.t <= t_after || begin.t >= end.t || end.t >= 3.0e38f || in_gap(fin_0, begin.t) || in_gap(fin_1, begin.t) ||
        in_gap(fin_2, begin.t)) {
        return span;
    }
    float whole = end.t;
    end = nearer_of(end, fin_0.gap_low > begin.t ? fin_0.gap_low : 3.0e38f, 0);
    end = nearer_of(end, fin_1.gap_low > begin.t ? fin_1.gap_low : 3.0e38f, 1);
    end = nearer_of(end, fin_2.gap_low > begin.t ? fin_2.gap_low : 3.0e38f, 2);
    span.found = true;
    span.last = end.t == whole;
    span.t_in = begin.t;
    span.t_out = end.t;
    span.q_in = clamp_place(place_on_face(prism, begin.face, origin + dir * begin.t));
    span.q_out = clamp_place(place_on_face(prism, end.face, origin + dir * end.t));
    return span;
}

#endif
