// A ray against the mesostructure inside one prism: the unit of work of a fragment, and of a leaf of the reference renderer.
#ifndef MESOSHELL_LIB_SHELL_HIT
#define MESOSHELL_LIB_SHELL_HIT

#include "curved_path.glsl"
#include "prism_planes.glsl"
#include "traverse.glsl"

// A ray leaves a prism through a fin and comes back at most once for each fin.
const int MOST_SPANS = 4;

// How the fins bound a prism: mode.z of the uniform block.
const int FINS_EXACT = 0;   // bilinear patches
const int FINS_PAPER = 1;  // two planes each, as in the paper

// How far a chord may lie from the ray's curve: in voxels of the distance field or, where a traversal reads more exact facets,
// in cells of these. There the chord only picks the cells; within one, `refined` knows how the curve bends.
const float CHORD_VOXELS = 0.25f;
const float CHORD_CELLS = 0.0625f;

struct ShellHit {
    bool hit;
    float t;              // ray parameter
    vec3 q;               // prism coordinates
    vec3 pos_texture;
    bool at_entry;        // where the ray enters the prism: in the solid
    vec3 normal;          // metric texture space, out of the solid; zero: ask the distance field
    int fetches;
};

// The paper's single lookup wants the whole stretch.
bool follows_curve(int traversal)
{
    return traversal != TRAVERSAL_GDM;
}

// Rays and prisms are in object space; dir has unit length. A stretch of the ray is a curve in texture space: it is followed by
// chords, each of which a traversal sees as one segment. Rays level with an offset triangle and those clipped by the paper's
// planes have one chord.
ShellHit trace_prism(Prism prism, vec3 origin, vec3 dir, float t_near, int fins, int traversal, Tile tile,
                     Tolerance tolerance)
{
    ShellHit result;
    result.hit = false;
    result.t = 0.0f;
    result.q = vec3(0.0f);
    result.pos_texture = vec3(0.0f);
    result.at_entry = false;
    result.normal = vec3(0.0f);
    result.fetches = 0;
    bool planes = fins == FINS_PAPER;
    PrismPath path;
    path.level = true;
    if (!planes) {
        path = make_prism_path(prism, origin, dir);
    }
    float t_after = -3.0e38f;
    KeptFacets kept = nothing_kept();
    for (int i = 0; i < MOST_SPANS; ++i) {
        PrismSpan span;
        if (planes) {
            span = plane_span(prism, origin, dir, t_after);
        } else if (path.level) {
            span = level_span(prism, origin, dir, path.level_height);
        } else {
            span = next_span(path, t_after);
        }
        if (!span.found) {
            break;
        }
        bool last = span.last;
        t_after = span.t_out;
        span = clip_span(path, span, t_near);
        if (!span.found && last) {
            break;
        }
        if (!span.found) {
            continue;
        }
        CurveChords chords = single_chord();
        if (follows_curve(traversal) && !path.level) {
            bool by_cells = traversal == TRAVERSAL_REFINED && tile.facet_cells.x > 0.0f;
            float most = by_cells ? CHORD_CELLS / tile.facet_cells.x : CHORD_VOXELS / tile.sdf_nodes.x;
            chords = curve_chords(prism, path, span, tile.scale, most);
        }
        int pieces = chords.pieces;
        vec3 q_in = span.q_in;
        vec3 entry_texture = prism_texture(prism, q_in);
        for (int piece = 1; piece <= pieces && !result.hit; ++piece) {
            vec3 q_out = piece == pieces ? span.q_out : curve_place(path, span, float(piece) / float(pieces));
            vec3 exit_texture = prism_texture(prism, q_out);
            SegmentHit segment = traverse(traversal, tile, tolerance, entry_texture, exit_texture,
                                          piece_bend(chords, piece), kept);
            result.fetches += segment.fetches;
            kept = segment.kept;
            if (segment.hit) {
                result.hit = true;
                result.at_entry = piece == 1 && segment.along == 0.0f;
                result.q = mix(q_in, q_out, segment.along);
                result.pos_texture = mix(entry_texture, exit_texture, segment.along) + segment.aside;
                result.normal = segment.normal;
                if (!path.level && segment.normal != vec3(0.0f)) {
                    // The traversal knows the plane that the chord meets; the curve meets it nearby.
                    result.q = curve_in_plane(prism, path, q_in, q_out, segment.along, result.pos_texture,
                                              segment.normal * tile.scale);
                    result.pos_texture = prism_texture(prism, result.q);
                }
                // The chord in texture space is not quite the ray; the hit is its foot on the ray, so that depth stays on the
                // pixel.
                float foot = dot(prism_position(prism, result.q) - origin, dir);
                result.t = planes ? mix(span.t_in, span.t_out, segment.along) : clamp(foot, span.t_in, span.t_out);
            }
            q_in = q_out;
            entry_texture = exit_texture;
        }
        if (result.hit) {
            break;
        }
        if (last) {
            break;
        }
    }
    return result;
}

// A hit where a ray enters its prism, so near a side of it, in prism coordinates, and so deep in the solid, in voxels, is a
// cut: there the shell's border, its bottom or top, or a seam of its UVs goes through the solid.
// Where a ray goes on from prism to prism it is less deep, but for one hit in a hundred thousand.
const float CUT_RIM = 1.0e-4f;
const float CUT_DEPTH = 0.05f;

// A side of a prism that a place is near, as its normal outward, not normalized, and the place's distance from it in prism
// coordinates.
vec4 nearest_side(Prism prism, vec3 q)
{
    PlaceSlopes slopes = place_slopes(prism, q);
    float q0 = 1.0f - q.x - q.y;
    vec4 side = vec4(-slopes.q0, q0);
    side = q.x < side.w ? vec4(-slopes.q1, q.x) : side;
    side = q.y < side.w ? vec4(-slopes.q2, q.y) : side;
    side = q.z < side.w ? vec4(-slopes.w, q.z) : side;
    return 1.0f - q.z < side.w ? vec4(slopes.w, 1.0f - q.z) : side;
}

// Outward unit normal in object space at a hit. `gdm` misses surfaces and enters the next prism below them, which is no cut.
vec3 hit_normal(Prism prism, ShellHit hit, int traversal, Tile tile)
{
    vec3 gradient = hit.normal;
    if (gradient == vec3(0.0f)) {
        gradient = sdf_gradient(tile, hit.pos_texture);
    }
    vec3 normal = prism_normal(prism, hit.q, tile.scale, gradient);
    if (hit.at_entry && traversal != TRAVERSAL_GDM && lookup_sdf(tile, hit.pos_texture) < -CUT_DEPTH / tile.sdf_nodes.x) {
        vec4 side = nearest_side(prism, hit.q);
        normal = side.w < CUT_RIM ? vec3(side.x, side.y, side.z) : normal;
    }
    float size = length(normal);
    return size > 0.0f ? normal / size : vec3(0.0f, 0.0f, 1.0f);
}

#endif
