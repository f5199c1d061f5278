// Bins of directions: the octahedron unfolded to a square (Cigolle et al. 2014, "A survey of efficient representations for
// independent unit vectors"), which is cut into side x side bins, side even. A bin never crosses one of the planes x = 0 and
// y = 0; its edges are arcs of great circles.
#ifndef MESOSHELL_LIB_OCTAHEDRAL
#define MESOSHELL_LIB_OCTAHEDRAL

// The place in [-1, 1]^2 of a direction of any length but zero: +w is the center, -w every corner, +u and +v are the middles
// of the sides.
vec2 octahedral_place(vec3 dir)
{
    float sum = abs(dir.x) + abs(dir.y) + abs(dir.z);
    vec2 place = vec2(dir.x / sum, dir.y / sum);
    if (dir.z < 0.0f) {
        vec2 folded = vec2(1.0f - abs(place.y), 1.0f - abs(place.x));
        place = vec2(place.x < 0.0f ? -folded.x : folded.x, place.y < 0.0f ? -folded.y : folded.y);
    }
    return place;
}

// The bin of a direction: row * side + column.
int octahedral_bin(vec3 dir, int side)
{
    vec2 place = octahedral_place(dir);
    int column = clamp(int((0.5f + 0.5f * place.x) * float(side)), 0, side - 1);
    int row = clamp(int((0.5f + 0.5f * place.y) * float(side)), 0, side - 1);
    return row * side + column;
}

#endif
