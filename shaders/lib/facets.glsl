// Facets: what a texel of their volume says of a cell, and where a segment meets it.
//
// A texel is four floats; their signs are the bits of its kind, the lower 29 bits of each hold the rest:
// - empty: for each octant of directions how many more cells in the three directions are empty too, three codes of 3 bits;
//   three octants a word;
// - planes: one a word, the place of its normal on the octahedral map, 10 and 9 bits, and 8 bits of the distance from the
//   middle of the cell over half its diagonal, in [-1, 1]; in the upper two bits of the first three words, an axis each, 1
//   where the planes hold in one more cell toward smaller coordinates, and toward larger ones;
// - solid: nothing;
// - split: 4 x 4 x 4 parts; a word a layer of 16 bits, 1 where a part has a texel of its own (it is empty otherwise), and the
//   number of the first of these texels in the upper 13 bits of the first two words.
#ifndef MESOSHELL_LIB_FACETS
#define MESOSHELL_LIB_FACETS

#include "octahedral.glsl"

const int FACET_EMPTY = 0;
const int FACET_ALL = 1;    // the solid is behind planes a, b, c and d
const int FACET_ANY = 2;    // behind any of them
const int FACET_TWO_AND_TWO = 3;    // behind a or b, and behind c or d
const int FACET_TWO_OR_TWO = 4;     // behind a and b, or behind c and d
const int FACET_TWO_AND_ANY = 5;    // behind a and b, and behind c or d
const int FACET_ANY_OR_TWO = 6;     // behind a or b, or behind c and d
const int FACET_ONE_OR_THREE = 7;   // behind a, or behind b, c and d
const int FACET_ONE_AND_THREE = 8;  // behind a, and behind b, c or d
const int FACET_SOLID = 9;
const int FACET_SPLIT = 10;

int facet_kind(vec4 texel)
{
    return (texel.x < 0.0f ? 1 : 0) + (texel.y < 0.0f ? 2 : 0) + (texel.z < 0.0f ? 4 : 0) + (texel.w < 0.0f ? 8 : 0);
}

int facet_bits(float word)
{
    return int(floatBitsToUint(word) & 0x1fffffffu);
}

// Cells, by code.
float box_reach(int code)
{
    float near = float(code);
    float far = code == 4 ? 5.0f : code == 5 ? 8.0f : code == 6 ? 13.0f : 31.0f;
    return code < 4 ? near : far;
}

// How many more cells are empty along u, v and w, each in the direction that a ray goes.
vec3 empty_reach(vec4 texel, vec3 way)
{
    int octant = (way.x > 0.0f ? 1 : 0) + (way.y > 0.0f ? 2 : 0) + (way.z > 0.0f ? 4 : 0);
    int bits = facet_bits(octant < 3 ? texel.x : octant < 6 ? texel.y : texel.z);
    int place = octant < 3 ? octant : octant < 6 ? octant - 3 : octant - 6;
    bits = bits >> (9 * place);
    return vec3(box_reach(bits & 7), box_reach((bits >> 3) & 7), box_reach((bits >> 6) & 7));
}

// In how many more cells the planes of a texel hold along u, v and w, each in the direction that a ray goes.
vec3 plane_reach(vec4 texel, vec3 way)
{
    int along_u = facet_bits(texel.x) >> (way.x > 0.0f ? 28 : 27);
    int along_v = facet_bits(texel.y) >> (way.y > 0.0f ? 28 : 27);
    int along_w = facet_bits(texel.z) >> (way.z > 0.0f ? 28 : 27);
    return vec3(float(along_u & 1), float(along_v & 1), float(along_w & 1));
}

// In how many more cells what a texel says holds too.
vec3 facet_reach(vec4 texel, vec3 way)
{
    int kind = facet_kind(texel);
    if (kind == FACET_EMPTY) {
        return empty_reach(texel, way);
    }
    return kind < FACET_SOLID ? plane_reach(texel, way) : vec3(0.0f);
}

// Two ranges of a segment, and what they have in common.
vec2 common_range(vec2 a, vec2 b)
{
    return vec2(max(a.x, b.x), min(a.y, b.y));
}

float nearer_start(float nearest, vec2 range)
{
    return range.x <= range.y ? min(nearest, range.x) : nearest;
}

// The plane of a word: its normal, and its distance from the middle of the cell. `radius` is half the cell's diagonal.
vec4 facet_plane(float word, float radius)
{
    int bits = facet_bits(word);
    vec2 place = vec2(float(bits & 1023) * (2.0f / 1023.0f), float((bits >> 10) & 511) * (2.0f / 511.0f)) - vec2(1.0f);
    vec3 normal = octahedral_direction(place);
    return vec4(normal.x, normal.y, normal.z, (float((bits >> 19) & 255) * (2.0f / 255.0f) - 1.0f) * radius);
}

// Where start + along * way is behind the plane of a word: the part of a range of `along`. `start` and `way` are metric, from
// the middle of the cell.
vec2 range_behind(float word, vec3 start, vec3 way, float radius, vec2 range)
{
    vec4 plane = facet_plane(word, radius);
    vec3 normal = vec3(plane.x, plane.y, plane.z);
    float height = dot(normal, start) - plane.w;
    float slope = dot(normal, way);
    float crossing = slope != 0.0f ? -height / slope : 0.0f;
    float low = slope < 0.0f ? max(range.x, crossing) : range.x;
    float high = slope > 0.0f ? min(range.y, crossing) : range.y;
    return slope == 0.0f && height > 0.0f ? vec2(1.0f, -1.0f) : vec2(low, high);
}

// Where in a range of `along` a segment first is in the solid of a texel of planes; 2 where it is not.
float first_inside(vec4 texel, int kind, vec3 start, vec3 way, float radius, vec2 range)
{
    vec2 a = range_behind(texel.x, start, way, radius, range);
    vec2 b = range_behind(texel.y, start, way, radius, range);
    vec2 c = range_behind(texel.z, start, way, radius, range);
    vec2 d = range_behind(texel.w, start, way, radius, range);
    float nearest = 2.0f;
    if (kind == FACET_ALL) {
        nearest = nearer_start(nearest, common_range(common_range(a, b), common_range(c, d)));
    } else if (kind == FACET_ANY) {
        nearest = nearer_start(nearer_start(nearer_start(nearer_start(nearest, a), b), c), d);
    } else if (kind == FACET_TWO_AND_TWO) {
        nearest = nearer_start(nearer_start(nearest, common_range(a, c)), common_range(a, d));
        nearest = nearer_start(nearer_start(nearest, common_range(b, c)), common_range(b, d));
    } else if (kind == FACET_TWO_OR_TWO) {
        nearest = nearer_start(nearer_start(nearest, common_range(a, b)), common_range(c, d));
    } else if (kind == FACET_TWO_AND_ANY) {
        vec2 both = common_range(a, b);
        nearest = nearer_start(nearer_start(nearest, common_range(both, c)), common_range(both, d));
    } else if (kind == FACET_ANY_OR_TWO) {
        nearest = nearer_start(nearer_start(nearer_start(nearest, a), b), common_range(c, d));
    } else if (kind == FACET_ONE_OR_THREE) {
        nearest = nearer_start(nearer_start(nearest, a), common_range(common_range(b, c), d));
    } else {
        nearest = nearer_start(nearer_start(nearest, common_range(a, b)), common_range(a, c));
        nearest = nearer_start(nearest, common_range(a, d));
    }
    return nearest;
}

// The normal of the plane of a texel in which a point lies: of those that `way` enters, the nearest; zero where it enters none.
// `point` and `way` are metric, from the middle of the cell.
vec3 normal_at(vec4 texel, vec3 point, vec3 way, float radius)
{
    vec3 found = vec3(0.0f);
    float nearest = 3.0e38f;
    for (int i = 0; i < 4; ++i) {
        vec4 plane = facet_plane(texel[i], radius);
        vec3 normal = vec3(plane.x, plane.y, plane.z);
        float distance = abs(dot(normal, point) - plane.w);
        if (distance < nearest && dot(normal, way) < 0.0f) {
            nearest = distance;
            found = normal;
        }
    }
    return found;
}

// Of the lower 16 bits.
int count_ones(int bits)
{
    int pairs = (bits & 0x5555) + ((bits >> 1) & 0x5555);
    int fours = (pairs & 0x3333) + ((pairs >> 2) & 0x3333);
    int eights = (fours & 0x0f0f) + ((fours >> 4) & 0x0f0f);
    return (eights & 0xff) + (eights >> 8);
}

// The number of the texel of a part of a cell that is split, -1 where the part is empty.
int part_texel(vec4 texel, vec3 part)
{
    int word_0 = facet_bits(texel.x);
    int word_1 = facet_bits(texel.y);
    int layer_0 = word_0 & 0xffff;
    int layer_1 = word_1 & 0xffff;
    int layer_2 = facet_bits(texel.z) & 0xffff;
    int layer_3 = facet_bits(texel.w) & 0xffff;
    int height = int(part.z);
    int layer = height < 1 ? layer_0 : height < 2 ? layer_1 : height < 3 ? layer_2 : layer_3;
    int bit = 1 << (int(part.y) * 4 + int(part.x));
    int before = count_ones(layer & (bit - 1));
    before += height > 0 ? count_ones(layer_0) : 0;
    before += height > 1 ? count_ones(layer_1) : 0;
    before += height > 2 ? count_ones(layer_2) : 0;
    return (layer & bit) != 0 ? (word_0 >> 16) + (word_1 >> 16) * 8192 + before : -1;
}

#endif
