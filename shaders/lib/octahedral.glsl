// Unit vectors as places of a square: the octahedron unfolded (Cigolle et al. 2014, "A survey of efficient representations for
// independent unit vectors").
#ifndef MESOSHELL_LIB_OCTAHEDRAL
#define MESOSHELL_LIB_OCTAHEDRAL

// The other way round the corner for the lower half: where the square's corners are folded to.
vec2 octahedral_fold(vec2 place)
{
    vec2 folded = vec2(1.0f - abs(place.y), 1.0f - abs(place.x));
    return vec2(place.x < 0.0f ? -folded.x : folded.x, place.y < 0.0f ? -folded.y : folded.y);
}

// The place in [-1, 1]^2 of a direction of any length but zero: +w is the center, -w every corner, +u and +v are the middles
// of the sides.
vec2 octahedral_place(vec3 dir)
{
    float sum = abs(dir.x) + abs(dir.y) + abs(dir.z);
    vec2 place = vec2(dir.x / sum, dir.y / sum);
    return dir.z < 0.0f ? octahedral_fold(place) : place;
}

// The unit vector of a place.
vec3 octahedral_direction(vec2 place)
{
    float height = 1.0f - abs(place.x) - abs(place.y);
    vec2 unfolded = height < 0.0f ? octahedral_fold(place) : place;
    return normalize(vec3(unfolded.x, unfolded.y, height));
}

#endif
