// The tile as `realize` warps it: the repaired mesh within the slab, in exact texture coordinates, capped where the slab
// cuts it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/sample.h"

namespace mesoshell {

struct TileCorner {
    glm::i64vec2 uv{0};  // 2^-24 tiles (plane_side.h)
    double w = 0.0;      // 0 to 1
    friend bool operator==(const TileCorner&, const TileCorner&) = default;
};

// Of the input mesh: what a triangle of the tile shows.
struct TileSource {
    std::uint32_t triangle = 0;  // of Sample::input_triangles
    glm::vec2 offset{0.0f};      // metric, whole periods: the input triangle's copy that lies here
    bool parallel = false;       // to that triangle: it is as smooth as that is
};

// Triangles whose copies by whole tiles meet in equal corners, edge to edge: a chain without boundary, but for what lies in
// w = 0 and w = 1 where there are no caps.
struct Tile {
    std::vector<std::array<TileCorner, 3>> triangles;
    std::vector<TileSource> sources;  // one a triangle
    std::vector<int> groups;          // one a triangle: solids of one group do not cross one another
};

// caps: whether the slab's cuts through the solid are closed. Where solids cross one another each is capped by itself.
// most_bend: edges are halved while their rise in w times their length in tiles exceeds this; infinite: never.
Tile tile_in_slab(const Sample& sample, bool caps, double most_bend, Job& job);

}  // namespace mesoshell
