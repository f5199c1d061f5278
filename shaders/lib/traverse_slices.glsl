// `slices`: the tile as a stack of textured layers parallel to the base, the peer that the GDM paper measures itself against
// (section 5). Meyer and Neyret 1998, "Interactive volumetric textures", and Lengyel et al. 2001, "Real-time fur over
// arbitrary surfaces", draw such layers one by one and let depth or blending pick; here the ray asks the layers that it
// crosses, nearest first, up to the first that is solid there, which is the same picture.
//
// Layer i of N is the offset surface w = i / (N - 1). It is solid where its density is at least 1/2, and a hit lies on it:
// between layers there is nothing, so that slopes come out as terraces, a nearly level ray passes between layers through
// what is thinner than its way from one to the next, and a level ray meets nothing. Errors fall as 1 / N and fetches grow
// as N: the cost of depth resolution that the paper holds against slices.
//
// Fetches: one a layer crossed, up to the hit.
#ifndef MESOSHELL_LIB_TRAVERSE_SLICES
#define MESOSHELL_LIB_TRAVERSE_SLICES

#include "segment.glsl"
#include "tile.glsl"

SegmentHit traverse_slices(Tile tile, Tolerance tolerance, vec3 entry_texture, vec3 exit_texture)
{
    SegmentHit result = nothing_hit();
    float rise = exit_texture.z - entry_texture.z;
    if (rise == 0.0f) {
        return result;
    }
    float last = float(tolerance.slice_layers - 1);
    // In layers. Neighbors round a shared end alike, so a layer is asked by at least one of them.
    float start = clamp(entry_texture.z, 0.0f, 1.0f) * last;
    float end = clamp(exit_texture.z, 0.0f, 1.0f) * last;
    float direction = rise > 0.0f ? 1.0f : -1.0f;
    float layer = rise > 0.0f ? ceil(start) : floor(start);
    while ((end - layer) * direction >= 0.0f) {
        float along = clamp((layer / last - entry_texture.z) / rise, 0.0f, 1.0f);
        vec3 pos_texture = mix(entry_texture, exit_texture, along);
        result.fetches += 1;
        if (lookup_density(tile, vec3(pos_texture.x, pos_texture.y, layer / last)) >= 0.5f) {
            result.hit = true;
            result.along = along;
            return result;
        }
        layer += direction;
    }
    return result;
}

#endif
