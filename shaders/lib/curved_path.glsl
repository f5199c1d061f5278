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

// Numerator of the curve's offset from a chord's first end, metric, and its denominator, the seen area.
vec4 chord_offset(Prism prism, PrismPath path, float w, vec3 first, vec3 scale)
{
    vec3 n = path_numerators(path, w);
    vec2 uv = (prism.uv_base[0] + prism.uv_rise[0] * w) * n.x + (prism.uv_base[1] + prism.uv_rise[1] * w) * n.y +
              (prism.uv_base[2] + prism.uv_rise[2] * w) * n.z;
    float area = n.x + n.y + n.z;
    vec3 offset = (vec3(uv.x, uv.y, w * area) - first * area) * scale;
    return vec4(offset, area);
}

// A stretch as chords at equal steps of height.
struct CurveChords {
    int pieces;
    vec3 bend;       // texture space: at a share s of the stretch's heights the curve lies beside its single chord by
    vec3 bend_rise;  // s * (1 - s) * (bend + (s - 1/2) * bend_rise), exactly at its thirds
};

CurveChords single_chord()
{
    CurveChords chords;
    chords.pieces = 1;
    chords.bend = vec3(0.0f);
    chords.bend_rise = vec3(0.0f);
    return chords;
}

// How a chord's curve bends, as a parabola: along * (1 - along) of this.
vec3 piece_bend(CurveChords chords, int piece)
{
    float pieces = float(chords.pieces);
    float middle = (float(piece) - 0.5f) / pieces;
    return (chords.bend + chords.bend_rise * (3.0f * middle - 1.5f)) / (pieces * pieces);
}

// The chords, at equal steps of height, that stay within `most` (tile widths) of the curve of a stretch. The offset's numerator
// is a cubic that is zero at both ends: its two other Bernstein coefficients bound it, those of the seen area the denominator,
// and the offset falls with the square of the number. Where the bound asks for too many, the ray is nearly level, and how it
// bends is not said.
CurveChords curve_chords(Prism prism, PrismPath path, PrismSpan span, vec3 scale, float most)
{
    CurveChords chords = single_chord();
    float w_in = span.q_in.z;
    float w_out = span.q_out.z;
    vec3 first = prism_texture(prism, span.q_in);
    vec3 chord = (prism_texture(prism, span.q_out) - first) * scale;
    float size = length(chord);
    if (size <= most) {
        return chords;
    }
    vec3 along = chord / size;
    vec4 first_third = chord_offset(prism, path, mix(w_in, w_out, 1.0f / 3.0f), first, scale);
    vec4 last_third = chord_offset(prism, path, mix(w_in, w_out, 2.0f / 3.0f), first, scale);
    vec3 offset_1 = vec3(first_third.x, first_third.y, first_third.z);
    vec3 offset_2 = vec3(last_third.x, last_third.y, last_third.z);
    vec3 third = offset_1 - along * dot(offset_1, along);
    vec3 two_thirds = offset_2 - along * dot(offset_2, along);
    vec3 inner_1 = third * 3.0f - two_thirds * 1.5f;
    vec3 inner_2 = two_thirds * 3.0f - third * 1.5f;
    float area_in = path_area(path, w_in);
    float area_out = path_area(path, w_out);
    float area_inner = 2.0f * path_area(path, 0.5f * (w_in + w_out)) - 0.5f * (area_in + area_out);
    float least_area = min(abs(area_inner), min(abs(area_in), abs(area_out)));
    float offset = 0.75f * max(length(inner_1), length(inner_2));
    if (offset >= most * float(MOST_PIECES * MOST_PIECES) * least_area) {
        chords.pieces = MOST_PIECES;
        return chords;
    }
    chords.pieces = max(int(ceil(sqrt(offset / (most * least_area)))), 1);
    vec3 beside_1 = (offset_1 / first_third.w - chord / 3.0f) / scale;
    vec3 beside_2 = (offset_2 / last_third.w - chord * (2.0f / 3.0f)) / scale;
    chords.bend = (beside_1 + beside_2) * 2.25f;
    chords.bend_rise = (beside_2 - beside_1) * 13.5f;
    return chords;
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
