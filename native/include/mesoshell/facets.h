// The facets of a tile: a grid of cells, each of which knows the planes that bound the solid there, or how far around it
// nothing is. What the traversal `refined` reads.
#pragma once

#include <cstddef>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/sample.h"

namespace mesoshell {

struct Facets {
    glm::ivec3 cells{0};  // along u, v and w; all 0: there are none
    float height = 0.0f;
    float aspect = 1.0f;
    // [depth, cells.y, cells.x, 4]. In the order of texels: first the cells [cells.z, cells.y, cells.x], then the parts of
    // those that are split; the rest is zero. A texel is 128 bits, which shaders/lib/facets.glsl reads; each of its four
    // words is the pattern of a finite float.
    std::vector<float> texels;

    std::size_t texel_count() const { return texels.size() / 4; }
    int depth() const
    {
        return cells.x == 0 ? 0 : static_cast<int>(texel_count() / (static_cast<std::size_t>(cells.x) * cells.y));
    }
};

// `cells`: along u, 4 to 128; along v and w so many, at most 128, that cells are nearly cubes. A cell is split into 4 x 4 x 4
// parts where four planes put more than 6 of 729 points on the wrong side, or miss the surface by more than 3 % of a 64th
// of a tile width in the mean. Without `boxes` an empty cell knows only of itself: rays meet the same, but fetch cell by cell.
// Throws InvalidArgument for a number out of range or one that needs more memory than there is, or more texels than a texture
// has; Cancelled.
Facets bake_facets(const Sample& sample, int cells, Job& job, bool boxes = true);

// The cells of a tile.
glm::ivec3 facet_cells(int cells, float height, float aspect);

}  // namespace mesoshell
