// `march`: fixed steps through the density volume, as volume renderers take them (survey 2014, section 5.1); the measure of
// the other traversals.
//
// A surface is where the density passes 1/2. Samples lie one voxel of the volume apart, that is, one node spacing along the
// segment in node coordinates, from the entry on, and the last is at the exit; the hit is where the line through the values
// of the two samples around the surface is 1/2. So it is less than a voxel along the ray from where the density is 1/2, and
// what is thinner than a voxel along the ray may lie between two samples. A segment that enters in the solid is hit at its
// entry.
//
// Fetches: one at the entry and one a step; where the segment is missed, its length in voxels, rounded up, and one.
#ifndef MESOSHELL_LIB_TRAVERSE_MARCH
#define MESOSHELL_LIB_TRAVERSE_MARCH

#include "segment.glsl"
#include "tile.glsl"

// A segment longer than this many voxels ends there: one through a degenerate prism may have any length.
const int MOST_MARCH_STEPS = 4096;

SegmentHit traverse_march(Tile tile, vec3 entry_texture, vec3 exit_texture)
{
    SegmentHit result = nothing_hit();
    result.fetches = 1;
    float density = lookup_density(tile, entry_texture);
    if (density >= 0.5f) {
        result.hit = true;
        return result;
    }
    vec3 grid = vec3(tile.sdf_nodes.x, tile.sdf_nodes.y, tile.sdf_nodes.z - 1.0f);
    float span_voxels = length((exit_texture - entry_texture) * grid);
    float travelled = 0.0f;
    while (travelled < span_voxels && result.fetches <= MOST_MARCH_STEPS) {
        // Counted, not summed up: a sum of many steps would drift.
        float next = min(float(result.fetches), span_voxels);
        float next_density = lookup_density(tile, mix(entry_texture, exit_texture, next / span_voxels));
        result.fetches += 1;
        if (next_density >= 0.5f) {
            result.hit = true;
            result.along = mix(travelled, next, (0.5f - density) / (next_density - density)) / span_voxels;
            return result;
        }
        travelled = next;
        density = next_density;
    }
    return result;
}

#endif
