// Ways to find where a segment of texture space meets the tile: the paper's single lookup, sphere tracing, and the choice
// among all.
#ifndef MESOSHELL_LIB_TRAVERSE
#define MESOSHELL_LIB_TRAVERSE

#include "segment.glsl"
#include "tile.glsl"
#include "traverse_march.glsl"
#include "traverse_refined.glsl"
#include "traverse_slices.glsl"

// As mesoshell/traversal.h.
const int TRAVERSAL_GDM = 0;
const int TRAVERSAL_SDF = 1;
const int TRAVERSAL_REFINED = 2;
const int TRAVERSAL_MARCH = 3;
const int TRAVERSAL_SLICES = 4;

// GDM paper, section 3.2: one lookup at the entry. Rays that meet nothing hold the distance to where they leave the slab
// (section 4.1), so the end point is asked whether there is a surface.
SegmentHit traverse_gdm(Tile tile, Tolerance tolerance, vec3 entry_texture, vec3 exit_texture)
{
    SegmentHit result = nothing_hit();
    result.along = 1.0f;
    vec3 span_metric = (exit_texture - entry_texture) * tile.scale;
    float span_length = length(span_metric);
    if (span_length == 0.0f) {
        return result;
    }
    float distance = lookup_gdm(tile, entry_texture, span_metric / span_length);
    result.fetches = 2 * tile.gdm_groups;
    if (distance < span_length) {
        result.along = distance / span_length;
        result.hit = lookup_sdf(tile, mix(entry_texture, exit_texture, result.along)) < tolerance.gdm_hit;
        result.fetches += 1;
    }
    return result;
}

// Hart 1996, "Sphere tracing": a step as long as the distance to the nearest surface crosses none.
SegmentHit traverse_sdf(Tile tile, Tolerance tolerance, vec3 entry_texture, vec3 exit_texture)
{
    SegmentHit result = nothing_hit();
    float span_length = length((exit_texture - entry_texture) * tile.scale);
    float travelled = 0.0f;
    while (result.fetches < tolerance.sdf_steps) {
        float along = span_length > 0.0f ? travelled / span_length : 0.0f;
        float distance = lookup_sdf(tile, mix(entry_texture, exit_texture, along));
        result.fetches += 1;
        if (distance < tolerance.sdf_hit) {
            result.hit = true;
            result.along = along;
            break;
        }
        travelled += distance;
        if (travelled >= span_length) {
            break;
        }
    }
    return result;
}

// Where the segment is at `along`, the ray is along * (1 - along) * bend beside it; `kept` is of a segment that ends at the
// entry. Only `refined` asks for either.
SegmentHit traverse(int traversal, Tile tile, Tolerance tolerance, vec3 entry_texture, vec3 exit_texture, vec3 bend,
                    KeptFacets kept)
{
    if (traversal == TRAVERSAL_GDM) {
        return traverse_gdm(tile, tolerance, entry_texture, exit_texture);
    }
    // A map without facets has sphere tracing to fall back on.
    if (traversal == TRAVERSAL_REFINED && tile.facet_cells.x > 0.0f) {
        return traverse_refined(tile, entry_texture, exit_texture, bend, kept);
    }
    if (traversal == TRAVERSAL_MARCH) {
        return traverse_march(tile, entry_texture, exit_texture);
    }
    if (traversal == TRAVERSAL_SLICES) {
        return traverse_slices(tile, tolerance, entry_texture, exit_texture);
    }
    return traverse_sdf(tile, tolerance, entry_texture, exit_texture);
}

#endif
