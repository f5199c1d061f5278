// The curve of a straight ray in texture space, by chords.
//
// Ogaki 2023: at height w the ray's barycentric numerators are quadratics, so texture coordinates are cubics over their sum,
// and quadratics where base and top have equal UVs.
#ifndef MESOSHELL_LIB_CURVED_PATH
#define MESOSHELL_LIB_CURVED_PATH

#include "prism_path.glsl"

// Of one stretch at most: where a bound asks for more, the ray is nearly level.
const int MOST_PIECES = 8;

// Prism coordinates at a share of a stretch's heights.
vec3 curve_place(PrismPath path, PrismSpan span, float share)
{
    return path_coordinates(path, mix(span.q_in.z, span.q_out.z, share));
}

// Numerator of the curve's offset from a chord's first end, less what is along the chord; its denominator is the seen area.
vec3 chord_offset(Prism prism, PrismPath path, float w, vec3 first, vec3 along, vec3 scale)
{
    vec3 n = path_numerators(path, w);
    vec2 uv = (prism.uv_base[0] + prism.uv_rise[0] * w) * n.x + (prism.uv_base[1] + prism.uv_rise[1] * w) * n.y +
              (prism.uv_base[2] + prism.uv_rise[2] * w) * n.z;
    float area = n.x + n.y + n.z;
    vec3 offset = (vec3(uv.x, uv.y, w * area) - first * area) * scale;
    return offset - along * dot(offset, along);
}

// How many chords, at equal steps of height, stay within `most` (tile widths) of the curve of a stretch. The offset's numerator
// is a cubic that is zero at both ends: its two other Bernstein coefficients bound it, those of the seen area the denominator,
// and the offset falls with the square of the number.
int curve_pieces(Prism prism, PrismPath path, PrismSpan span, vec3 scale, float most)
{
    float w_in = span.q_in.z;
    float w_out = span.q_out.z;
    vec3 first = prism_texture(prism, span.q_in);
    vec3 chord = (prism_texture(prism, span.q_out) - first) * scale;
    float size = length(chord);
    if (size <= most) {
        return 1;
    }
    vec3 along = chord / size;
    vec3 third = chord_offset(prism, path, mix(w_in, w_out, 1.0f / 3.0f), first, along, scale);
    vec3 two_thirds = chord_offset(prism, path, mix(w_in, w_out, 2.0f / 3.0f), first, along, scale);
    vec3 inner_1 = third * 3.0f - two_thirds * 1.5f;
    vec3 inner_2 = two_thirds * 3.0f - third * 1.5f;
    float area_in = path_area(path, w_in);
    float area_out = path_area(path, w_out);
    float area_inner = 2.0f * path_area(path, 0.5f * (w_in + w_out)) - 0.5f * (area_in + area_out);
    float least_area = min(abs(area_inner), min(abs(area_in), abs(area_out)));
    float offset = 0.75f * max(length(inner_1), length(inner_2));
    if (offset >= most * float(MOST_PIECES * MOST_PIECES) * least_area) {
        return MOST_PIECES;
    }
    return max(int(ceil(sqrt(offset / (most * least_area)))), 1);
}

// Where the curve between two places meets the plane that its chord meets at `share`: two steps of Newton's method by the
// chord's slope. `normal_texture` is the plane's covector in texture space.
vec3 curve_in_plane(Prism prism, PrismPath path, vec3 q_in, vec3 q_out, float share, vec3 point_texture, vec3 normal_texture)
{
    float slope = dot(normal_texture, prism_texture(prism, q_out) - prism_texture(prism, q_in));
    vec3 q = mix(q_in, q_out, share);
    float met = share;
    for (int step = 0; step < 2 && slope < 0.0f; ++step) {
        q = path_coordinates(path, mix(q_in.z, q_out.z, met));
        met = clamp(met - dot(normal_texture, prism_texture(prism, q) - point_texture) / slope, 0.0f, 1.0f);
    }
    return slope < 0.0f ? path_coordinates(path, mix(q_in.z, q_out.z, met)) : q;
}

#endif
