// `refined`, Mesoshell's own traversal: from cell to cell of the facets, past as many empty ones as a texel knows of.
//
// Nothing converges: where a cell holds planes, the hit is where the segment is first behind them, exactly; a segment that
// comes into the solid elsewhere, where the planes of two cells leave a gap, is hit there.
//
// Fetches: one a box of empty cells, one a cell with planes, two or more a cell that is split; none for what the segment
// before has kept.
#ifndef MESOSHELL_LIB_TRAVERSE_REFINED
#define MESOSHELL_LIB_TRAVERSE_REFINED

#include "facets.glsl"
#include "segment.glsl"
#include "tile.glsl"

// Where start + along * way crosses three planes, one an axis; far away where it never does.
vec3 border_crossings(vec3 start, vec3 way, vec3 border)
{
    vec3 crossing;
    for (int axis = 0; axis < 3; ++axis) {
        crossing[axis] = way[axis] != 0.0f ? (border[axis] - start[axis]) / way[axis] : 3.0e38f;
    }
    return crossing;
}

// The far borders of a cell, or of a box that reaches some cells beyond it.
vec3 far_border(vec3 cell, vec3 way, vec3 reach)
{
    vec3 border;
    for (int axis = 0; axis < 3; ++axis) {
        border[axis] = way[axis] > 0.0f ? cell[axis] + 1.0f + reach[axis] : cell[axis] - reach[axis];
    }
    return border;
}

// The cell behind the borders that are crossed at `along`. No axis ever steps back, whatever rounding does to the place: every
// step leads on.
vec3 cell_behind(vec3 cell, vec3 start, vec3 way, vec3 border, vec3 crossing, float along)
{
    vec3 place = floor(start + way * along);
    vec3 next;
    for (int axis = 0; axis < 3; ++axis) {
        bool crossed = crossing[axis] <= along;
        if (way[axis] > 0.0f) {
            next[axis] = max(place[axis], crossed ? border[axis] : cell[axis]);
        } else {
            next[axis] = min(place[axis], crossed ? border[axis] - 1.0f : cell[axis]);
        }
    }
    return next;
}

float least(vec3 a)
{
    return min(a.x, min(a.y, a.z));
}

// A texel by its number.
vec3 facet_place(int number, vec3 cells)
{
    int width = int(cells.x);
    int height = int(cells.y);
    int row = number / width;
    return vec3(float(number - row * width), float(row - row / height * height), float(row / height));
}

// Whether what a cell's texel says holds in another cell, from which a ray goes on along `way`.
bool reaches_cell(vec4 texel, vec3 cell, vec3 way, vec3 other)
{
    vec3 reach = facet_reach(texel, way);
    bool reached = true;
    for (int axis = 0; axis < 3; ++axis) {
        float steps = way[axis] > 0.0f ? other[axis] - cell[axis] : cell[axis] - other[axis];
        reached = reached && steps >= 0.0f && steps <= reach[axis];
    }
    return reached;
}

// Within a cell that is split; `start` and `way` are in cells, `range` is the cell's. 2 for `along` where nothing is met.
SegmentHit traverse_parts(Tile tile, KeptFacets kept, vec3 cell, vec3 start, vec3 way, vec2 range)
{
    SegmentHit result = nothing_hit();
    result.along = range.x;
    result.kept = kept;
    vec3 side = tile.scale / (tile.facet_cells * 4.0f);
    vec3 start_part = (start - cell) * 4.0f;
    vec3 way_part = way * 4.0f;
    vec3 part = clamp(floor(start_part + way_part * range.x), vec3(0.0f), vec3(3.0f));
    // Ten parts lie along a diagonal.
    for (int step = 0; step < 10; ++step) {
        vec3 border = far_border(part, way, vec3(0.0f));
        vec3 crossing = border_crossings(start_part, way_part, border);
        float leave = max(least(crossing), result.along);
        int number = part_texel(kept.texel, part);
        if (number >= 0) {
            if (number != result.kept.part) {
                result.kept.part = number;
                result.kept.part_texel = fetch_facets(facet_place(number, tile.facet_cells));
                result.fetches += 1;
            }
            vec4 planes = result.kept.part_texel;
            vec3 start_metric = (start_part - part - vec3(0.5f)) * side;
            vec3 way_metric = way_part * side;
            float radius = 0.5f * length(side);
            float found = first_inside(planes, facet_kind(planes), start_metric, way_metric, radius,
                                       vec2(result.along, min(leave, range.y)));
            if (found <= 1.0f) {
                result.hit = true;
                result.along = found;
                result.normal = normal_at(planes, start_metric + way_metric * found, way_metric, radius);
                return result;
            }
        }
        result.along = leave;
        part = cell_behind(part, start_part, way_part, border, crossing, leave);
        if (leave >= range.y || least(part) < 0.0f || max(part.x, max(part.y, part.z)) > 3.0f) {
            break;
        }
    }
    return result;
}

// A segment that meets more cells ends there: one through a degenerate prism may have any length.
const int MOST_CELLS = 1024;

// `bend` is as for `traverse`. `kept` may be of any segment; it spares a fetch where this one begins in a cell of which it
// says enough.
SegmentHit traverse_refined(Tile tile, vec3 entry_texture, vec3 exit_texture, vec3 bend, KeptFacets kept)
{
    SegmentHit result = nothing_hit();
    vec3 cells = tile.facet_cells;
    vec3 side = tile.scale / cells;
    float radius = 0.5f * length(side);
    vec3 start = vec3(fract(entry_texture.x), fract(entry_texture.y), entry_texture.z) * cells;
    vec3 way = (exit_texture - entry_texture) * cells;
    vec3 bend_cells = bend * cells;
    vec3 origin = vec3(floor(entry_texture.x), floor(entry_texture.y), 0.0f) * cells;
    vec3 cell = floor(start);
    cell.z = clamp(cell.z, 0.0f, cells.z - 1.0f);
    bool known = kept.cell.z >= 0.0f && reaches_cell(kept.texel, kept.cell - origin, way, cell);
    cell = known ? kept.cell - origin : cell;
    result.kept = kept;
    for (int step = 0; step < MOST_CELLS; ++step) {
        if (!known) {
            vec3 copy = vec3(floor(cell.x / cells.x), floor(cell.y / cells.y), 0.0f) * cells;
            result.kept.texel = fetch_facets(clamp(cell - copy, vec3(0.0f), cells - vec3(1.0f)));
            result.kept.cell = cell + origin;
            result.fetches += 1;
        }
        known = false;
        vec4 texel = result.kept.texel;
        int kind = facet_kind(texel);
        vec3 border = far_border(cell, way, facet_reach(texel, way));
        vec3 crossing = border_crossings(start, way, border);
        float leave = max(least(crossing), result.along);
        vec2 range = vec2(result.along, min(leave, 1.0f));
        if (kind == FACET_SOLID) {
            result.hit = true;
            return result;
        }
        // The segment says which cells are met; within one, the ray is the secant of its parabola.
        float share = range.x * range.y;
        float share_along = 1.0f - range.x - range.y;
        vec3 secant_start = start + bend_cells * share;
        vec3 secant_way = way + bend_cells * share_along;
        if (kind == FACET_SPLIT) {
            SegmentHit inner = traverse_parts(tile, result.kept, cell, secant_start, secant_way, range);
            result.fetches += inner.fetches;
            result.kept = inner.kept;
            if (inner.hit) {
                result.hit = true;
                result.along = inner.along;
                result.normal = inner.normal;
                result.aside = bend * (share + share_along * inner.along);
                return result;
            }
        } else if (kind != FACET_EMPTY) {
            vec3 start_metric = (secant_start - cell - vec3(0.5f)) * side;
            vec3 way_metric = secant_way * side;
            float found = first_inside(texel, kind, start_metric, way_metric, radius, range);
            if (found <= 1.0f) {
                result.hit = true;
                result.along = found;
                result.normal = normal_at(texel, start_metric + way_metric * found, way_metric, radius);
                result.aside = bend * (share + share_along * found);
                return result;
            }
        }
        if (leave >= 1.0f) {
            break;
        }
        result.along = leave;
        cell = cell_behind(cell, start, way, border, crossing, leave);
        if (cell.z < 0.0f || cell.z > cells.z - 1.0f) {
            break;
        }
    }
    return result;
}

#endif
