// How far a ray may go at once, by the leap table.
#ifndef MESOSHELL_LIB_LEAP
#define MESOSHELL_LIB_LEAP

#include "octahedral.glsl"

// The cell of a point of texture space: periodic along u and v, clamped along w.
vec3 leap_cell(vec3 pos_texture, vec3 cells)
{
    vec3 place = vec3(fract(pos_texture.x), fract(pos_texture.y), pos_texture.z) * cells;
    return clamp(floor(place), vec3(0.0f), cells - vec3(1.0f));
}

// From a point of texture space along a unit direction of metric texture space, of which `scale` is the size, given the
// bound of the point's cell and the direction's bin. Where that is not zero, nothing is to be met before the cell ends
// either: the ray would have nothing left of its bound on the way there. So it goes to the end of the cell, and as far as
// the bound from there.
float leap_length(vec3 pos_texture, vec3 dir_metric, vec3 cells, vec3 scale, float bound)
{
    if (bound <= 0.0f) {
        return 0.0f;
    }
    vec3 place = vec3(fract(pos_texture.x), fract(pos_texture.y), pos_texture.z) * cells;
    vec3 cell = leap_cell(pos_texture, cells);
    float leave = 16.0f;
    for (int axis = 0; axis < 3; ++axis) {
        float speed = dir_metric[axis] / scale[axis] * cells[axis];
        float border = cell[axis] + (speed > 0.0f ? 1.0f : 0.0f);
        if (abs(speed) > 1e-6f) {
            leave = min(leave, (border - place[axis]) / speed);
        }
    }
    return max(leave, 0.0f) + bound;
}

#endif
