// The leap table of a tile: how far every ray from a cell, in a bin of directions, runs without meeting a surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/sample.h"

namespace mesoshell {

// Bounds are whole numbers of this, in tile widths. A power of two, so that half floats hold all of them exactly.
constexpr float leap_unit = 1.0f / 256.0f;

struct LeapResolution {
    glm::ivec3 cells{32, 32, 16};  // along u, v and w, each 1 to 64; cell (i, j, k) begins at (i / cx, j / cy, k / cz)
    int directions = 8;            // side of the octahedral map of shaders/lib/octahedral.glsl: even, 2 to 16
};

struct Leaps {
    glm::ivec3 cells{0};  // all 0: no table
    int directions = 0;
    float height = 0.0f;
    float aspect = 1.0f;
    // [directions * directions, cz, cy, cx], in leap units. A ray of metric texture space that starts anywhere in the cell,
    // but not in the solid, with a direction anywhere in the bin, meets no surface within the slab before it has gone this
    // far. No bound is larger than 255, whether there is a surface beyond it or none; nor, where a side of a cell is less
    // than 1/128, than 128 of it.
    std::vector<std::uint8_t> values;

    std::size_t index(int bin, const glm::ivec3& cell) const
    {
        return ((static_cast<std::size_t>(bin) * cells.z + cell.z) * cells.y + cell.y) * cells.x + cell.x;
    }
};

// Throws InvalidArgument for a resolution out of range or one that needs more memory than there is; Cancelled.
Leaps bake_leaps(const Sample& sample, const LeapResolution& resolution, Job& job);

// The bin of a direction of metric texture space (not zero): octahedral_bin of shaders/lib/octahedral.glsl.
int octahedral_bin(const glm::vec3& dir_metric, int directions);

// The bound, in tile widths, of a ray from a point of texture space along a direction of metric texture space (not zero):
// periodic along u and v, clamped along w.
float lookup_leap(const Leaps& leaps, const glm::vec3& pos_texture, const glm::vec3& dir_metric);

// How far a ray may go, as a traversal finds it with shaders/lib/leap.glsl: where the bound is not zero, to the end of the
// cell and as far as the bound from there. The direction has unit length.
float leap_length(const Leaps& leaps, const glm::vec3& pos_texture, const glm::vec3& dir_metric);

// The same of many rays whose directions may have any length. Throws InvalidArgument for spans of different lengths and what
// is not finite or zero.
std::vector<float> leap_lengths(const Leaps& leaps, std::span<const glm::vec3> pos_texture,
                                std::span<const glm::vec3> dir_metric);

}  // namespace mesoshell
