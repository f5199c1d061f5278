// A ray against the mesostructure inside one prism: the unit of work of a fragment, and of a leaf of the reference renderer.
#ifndef MESOSHELL_LIB_SHELL_HIT
#define MESOSHELL_LIB_SHELL_HIT

#include "prism_path.glsl"
#include "prism_planes.glsl"
#include "traverse.glsl"

// A ray leaves a prism through a fin and comes back at most once for each fin.
const int MOST_SPANS = 4;

// How the fins bound a prism: mode.z of the uniform block.
const int FINS_EXACT = 0;   // bilinear patches
const int FINS_PAPER = 1;  // two planes each, as in the paper

struct ShellHit {
    bool hit;
    float t;              // ray parameter
    vec3 q;               // prism coordinates
    vec3 pos_texture;
    int fetches;
};

// Rays and prisms are in object space; dir has unit length.
ShellHit trace_prism(Prism prism, vec3 origin, vec3 dir, float t_near, int fins, int traversal, Tile tile,
                     Tolerance tolerance)
{
    ShellHit result;
    result.hit = false;
    result.t = 0.0f;
    result.q = vec3(0.0f);
    result.pos_texture = vec3(0.0f);
    result.fetches = 0;
    bool planes = fins == FINS_PAPER;
    PrismPath path;
    path.level = true;
    if (!planes) {
        path = make_prism_path(prism, origin, dir);
    }
    float t_after = -3.0e38f;
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
        vec3 entry_texture = prism_texture(prism, span.q_in);
        vec3 exit_texture = prism_texture(prism, span.q_out);
        SegmentHit segment = traverse(traversal, tile, tolerance, entry_texture, exit_texture);
        result.fetches += segment.fetches;
        if (segment.hit) {
            // The chord in texture space is not quite the ray; the hit is its foot on the ray, so that depth stays on the pixel.
            result.hit = true;
            result.q = mix(span.q_in, span.q_out, segment.along);
            result.pos_texture = mix(entry_texture, exit_texture, segment.along);
            float foot = dot(prism_position(prism, result.q) - origin, dir);
            result.t = planes ? mix(span.t_in, span.t_out, segment.along) : clamp(foot, span.t_in, span.t_out);
            break;
        }
        if (last) {
            break;
        }
    }
    return result;
}

// Outward unit normal in object space at a hit.
vec3 hit_normal(Prism prism, ShellHit hit, Tile tile)
{
    vec3 normal = prism_normal(prism, hit.q, tile.scale, sdf_gradient(tile, hit.pos_texture));
    float size = length(normal);
    return size > 0.0f ? normal / size : vec3(0.0f, 0.0f, 1.0f);
}

#endif
