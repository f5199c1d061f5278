// What every traversal is asked and what it answers: a segment of texture space, its ends inside one prism.
#ifndef MESOSHELL_LIB_SEGMENT
#define MESOSHELL_LIB_SEGMENT

struct Tolerance {
    float gdm_hit;     // tile widths: how far from the surface the end of a GDM lookup may lie and still be a hit
    float sdf_hit;     // tile widths: sphere tracing ends this close to the surface
    int sdf_steps;     // at most
    int slice_layers;  // offset layers of `slices`, base and top included; 2 to 4096
};

// What `refined` fetched last, for the segment that begins where this one ends.
struct KeptFacets {
    vec3 cell;        // of all copies of the tile; z is -1 where nothing is kept
    vec4 texel;       // the cell's
    int part;         // number of the texel of a part of a cell that is split, -1 where none is kept
    vec4 part_texel;
};

struct SegmentHit {
    bool hit;
    float along;  // 0 where the segment enters, 1 where it leaves
    int fetches;  // texture instructions
    vec3 normal;  // metric, out of the solid; zero where the traversal does not know it
    vec3 aside;   // texture space: how far beside the segment the hit lies, on the ray's curve
    KeptFacets kept;
};

KeptFacets nothing_kept()
{
    KeptFacets kept;
    kept.cell = vec3(-1.0f);
    kept.texel = vec4(0.0f);
    kept.part = -1;
    kept.part_texel = vec4(0.0f);
    return kept;
}

// What every traversal starts from.
SegmentHit nothing_hit()
{
    SegmentHit result;
    result.hit = false;
    result.along = 0.0f;
    result.fetches = 0;
    result.normal = vec3(0.0f);
    result.aside = vec3(0.0f);
    result.kept = nothing_kept();
    return result;
}

#endif
