// The shell's prisms as `realize` clips to them: texture coordinates exact, and the same on both sides of a fin wherever the
// pattern continues.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/shell.h"

namespace mesoshell {

struct ChartCorner {
    std::uint32_t vertex = 0;  // of the shell
    glm::i64vec2 uv{0};        // at the base, 2^-24 tiles (plane_side.h)
    glm::i64vec2 uv_top{0};
    glm::dvec3 base{0.0};
    glm::dvec3 rise{0.0};      // from base to top
};

struct ChartPrism {
    std::array<ChartCorner, 3> corners;  // counterclockwise in (u, v)
    std::uint32_t index = 0;             // of the shell's prism
    bool mirrored = false;               // clockwise in (u, v): corners 1 and 2 have changed places
    std::array<bool, 3> open{};          // side i, from corner i to the next: no prism continues the pattern there
};

struct Charts {
    std::vector<ChartPrism> prisms;  // without those whose UVs have no area
    bool upright = true;             // top and base have equal UVs everywhere
    double tile_width = 1.0;         // object units, in the mean
    double tiles = 0.0;              // how many the prisms cover at the base
    // How UVs change from base to top: the most that corners move, tiles, and the most that the UVs of a prism are
    // stretched or turned against one another.
    double most_slant = 0.0;
    double most_twist = 0.0;
};

// Corners whose UVs are whole tiles apart to within seam_tolerance (seams.h) get UVs exactly whole tiles apart. Throws
// InvalidArgument for UVs that span too many tiles in one prism, or that turn over between base and top.
Charts charts_of(const Shell& shell, float aspect);

}  // namespace mesoshell
