// What every traversal is asked and what it answers: a segment of texture space, its ends inside one prism.
#ifndef MESOSHELL_LIB_SEGMENT
#define MESOSHELL_LIB_SEGMENT

struct Tolerance {
    float gdm_hit;     // tile widths: how far from the surface the end of a GDM lookup may lie and still be a hit
    float sdf_hit;     // tile widths: sphere tracing ends this close to the surface
    int sdf_steps;     // at most
    int slice_layers;  // offset layers of `slices`, base and top included; 2 to 4096
};

struct SegmentHit {
    bool hit;
    float along;  // 0 where the segment enters, 1 where it leaves
    int fetches;  // texture instructions
    vec3 normal;  // metric, out of the solid; zero where the traversal does not know it
};

#endif
