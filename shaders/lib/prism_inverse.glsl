// From a position or a texture position back to prism coordinates: the inverse of the maps in prism.glsl.
//
// The triangle at height w contains the point: (base_0 - point + w director_0) . normal(w) = 0, a cubic in w. Between its
// extrema it is monotone, so that each root is bracketed; a cubic that degenerates (parallel directors: linear) has its
// leading coefficients exactly zero and needs no case of its own. Two Newton steps on the whole map, from its difference to
// the point in twice single precision, then leave a rounding of the coordinates: also of the height within a prism a
// thousand times wider than thick, and of places in one a thousand of its sizes away from the origin.
#ifndef MESOSHELL_LIB_PRISM_INVERSE
#define MESOSHELL_LIB_PRISM_INVERSE

#include "long_sum.glsl"
#include "prism_path.glsl"

struct PrismPlace {
    bool found;
    vec3 q;  // prism coordinates, inside the prism
};

// A position or a texture position, where there is one.
struct PrismPoint {
    bool found;
    vec3 point;
};

// Position of q minus the point, to much more than single precision where the two are close.
vec3 prism_residual(Prism prism, vec3 q, vec3 pos_object)
{
    LongSum residual = long_difference(prism.base[0], pos_object);
    residual = add_scaled(residual, long_difference(prism.base[1], prism.base[0]), q.x);
    residual = add_scaled(residual, long_difference(prism.base[2], prism.base[0]), q.y);
    LongSum director = long_difference(prism.director[0], vec3(0.0f));
    director = add_scaled(director, long_difference(prism.director[1], prism.director[0]), q.x);
    director = add_scaled(director, long_difference(prism.director[2], prism.director[0]), q.y);
    residual = add_scaled(residual, director, q.z);
    return residual.value + residual.rest;
}

float cubic(vec4 c, float w)
{
    return c.x + (c.y + (c.z + c.w * w) * w) * w;
}

// The root of a cubic that is monotone between `low` and `high` and changes its sign there: Newton steps, halved brackets
// where they leave it.
float bracketed_root(vec4 c, float low, float high)
{
    bool rises = cubic(c, high) > cubic(c, low);
    float w = 0.5f * (low + high);
    for (int step = 0; step < 24; ++step) {
        float value = cubic(c, w);
        bool below = rises ? value < 0.0f : value > 0.0f;
        low = below ? w : low;
        high = below ? high : w;
        float slope = c.y + (2.0f * c.z + 3.0f * c.w * w) * w;
        float next = slope != 0.0f ? w - value / slope : low;
        next = next > low && next < high ? next : 0.5f * (low + high);
        if (abs(next - w) <= 1.0e-6f) {
            return next;
        }
        w = next;
    }
    return w;
}

// Weights of columns 1 and 2 where the triangle at height w comes nearest to the point; not finite where it has no area.
vec3 place_at_height(Prism prism, vec3 pos_object, float w)
{
    vec3 p0 = prism.base[0] - pos_object + prism.director[0] * w;
    vec3 edge_1 = (prism.base[1] - prism.base[0]) + (prism.director[1] - prism.director[0]) * w;
    vec3 edge_2 = (prism.base[2] - prism.base[0]) + (prism.director[2] - prism.director[0]) * w;
    vec3 normal = cross(edge_1, edge_2);
    float area = dot(normal, normal);
    return vec3(dot(cross(edge_2, p0), normal) / area, dot(cross(p0, edge_1), normal) / area, w);
}

// The least of a place's weights and of its distances from the bottom and the top.
float place_depth(vec3 q)
{
    return min(min(min(q.x, q.y), 1.0f - q.x - q.y), min(q.z, 1.0f - q.z));
}

// The deeper of `best` and the place at the root between two heights; where there is none, at the end that comes nearest to
// one, as at the apex of a pyramid, where every triangle's plane has the point.
vec3 deeper_place(Prism prism, vec3 pos_object, vec4 c, float low, float high, vec3 best)
{
    float at_low = cubic(c, low);
    float at_high = cubic(c, high);
    float w = abs(at_low) < abs(at_high) ? low : high;
    if (low < high && (at_low < 0.0f) != (at_high < 0.0f)) {
        w = bracketed_root(c, low, high);
    }
    vec3 q = place_at_height(prism, pos_object, w);
    return place_depth(q) > place_depth(best) ? q : best;
}

// Object space to prism coordinates, for prisms that do not fold. A point counts as inside where rounding its coordinates
// may have taken it out.
PrismPlace place_of_position(Prism prism, vec3 pos_object)
{
    vec3 offset = prism.base[0] - pos_object;
    vec3 edge_1 = prism.base[1] - prism.base[0];
    vec3 edge_2 = prism.base[2] - prism.base[0];
    vec3 turn_1 = prism.director[1] - prism.director[0];
    vec3 turn_2 = prism.director[2] - prism.director[0];
    vec3 normal_0 = cross(edge_1, edge_2);
    vec3 normal_1 = cross(edge_1, turn_2) + cross(turn_1, edge_2);
    vec3 normal_2 = cross(turn_1, turn_2);
    vec4 c = vec4(dot(offset, normal_0), dot(offset, normal_1) + dot(prism.director[0], normal_0),
                  dot(offset, normal_2) + dot(prism.director[0], normal_1), dot(prism.director[0], normal_2));

    // The heights of a thin prism come to a hundredth before the Newton steps.
    float low = -0.0625f;
    float high = 1.0625f;
    vec2 extrema = quadratic_roots(c.y, 2.0f * c.z, 3.0f * c.w);
    float first = clamp(min(extrema.x, extrema.y), low, high);
    float second = clamp(max(extrema.x, extrema.y), low, high);
    vec3 q = deeper_place(prism, pos_object, c, low, first, vec3(-1.0e30f));
    q = deeper_place(prism, pos_object, c, first, second, q);
    q = deeper_place(prism, pos_object, c, second, high, q);
    PrismPlace place;
    place.found = false;
    place.q = vec3(0.0f);
    if (q.x == -1.0e30f) {
        return place;
    }
    q = newton_step(place_slopes(prism, q), q, prism_residual(prism, q, pos_object));
    PlaceSlopes slopes = place_slopes(prism, q);
    vec3 residual = prism_residual(prism, q, pos_object);
    q = newton_step(slopes, q, residual);
    place.q = clamp_place(q);

    float reach = max(max(length(offset), length(prism.base[1] - pos_object)), length(prism.base[2] - pos_object));
    reach += max(max(length(prism.director[0]), length(prism.director[1])), length(prism.director[2]));
    float rounding = 2.5e-7f * (reach + max(abs(pos_object.x), max(abs(pos_object.y), abs(pos_object.z))));
    bool inside = q.x >= -1.0e-6f - rounding * length(slopes.q1) && q.y >= -1.0e-6f - rounding * length(slopes.q2) &&
                  q.x + q.y <= 1.000001f + rounding * length(slopes.q0) &&
                  abs(q.z - 0.5f) <= 0.500001f + rounding * length(slopes.w);
    // Where the steps converge, the last one is short. Where columns meet, some coordinate means nothing: any place will do.
    place.found = (inside && length(residual) <= 1.0e-4f * reach) ||
                  length(prism_residual(prism, place.q, pos_object)) <= rounding;
    return place;
}

// Texture space to prism coordinates; not found outside the prism's texture triangle, or where that has no area.
PrismPlace place_of_texture(Prism prism, vec3 pos_texture)
{
    PrismPlace place;
    place.found = false;
    place.q = vec3(0.0f);
    float w = clamp(pos_texture.z, 0.0f, 1.0f);
    vec2 edge_1 = (prism.uv_base[1] - prism.uv_base[0]) + (prism.uv_rise[1] - prism.uv_rise[0]) * w;
    vec2 edge_2 = (prism.uv_base[2] - prism.uv_base[0]) + (prism.uv_rise[2] - prism.uv_rise[0]) * w;
    vec2 offset = (vec2(pos_texture.x, pos_texture.y) - prism.uv_base[0]) - prism.uv_rise[0] * w;
    float area = cross_2d(edge_1, edge_2);
    float size = max(length(edge_1), length(edge_2));
    // Cancellation leaves rounding errors of an area that there is not.
    if (abs(area) <= 1.0e-6f * size * size) {
        return place;
    }
    place.q = clamp_place(vec3(cross_2d(offset, edge_2) / area, cross_2d(edge_1, offset) / area, w));
    float rounding = 4.0e-7f * (size + max(abs(pos_texture.x), abs(pos_texture.y)));
    vec2 residual = edge_1 * place.q.x + edge_2 * place.q.y - offset;
    place.found = max(length(residual), abs(pos_texture.z - w)) <= rounding;
    return place;
}

PrismPoint prism_texture_of_position(Prism prism, vec3 pos_object)
{
    PrismPlace place = place_of_position(prism, pos_object);
    PrismPoint result;
    result.found = place.found;
    result.point = prism_texture(prism, place.q);
    return result;
}

PrismPoint prism_position_of_texture(Prism prism, vec3 pos_texture)
{
    PrismPlace place = place_of_texture(prism, pos_texture);
    PrismPoint result;
    result.found = place.found;
    result.point = prism_position(prism, place.q);
    return result;
}

#endif
