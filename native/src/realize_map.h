// A prism's part of the tile, mapped into space: split until its edges follow the map, with what corners say of the tile.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/realize.h"
#include "realize_charts.h"
#include "realize_prism.h"
#include "realize_tile.h"
#include "vertex_weld.h"

namespace mesoshell {

// Triangles of some prisms, welded among themselves.
struct RealizedPart {
    VertexWeld vertices{1024};
    RealizedMesh mesh;                    // without positions
    std::vector<glm::vec3> tile_normals;  // of every corner, before they are mapped; zero where it is none of the input's
};

// Adds a prism's triangles to a part. Two prisms at a fin map what they share to the same bits and halve its edges alike.
// tile_width: object units, in which options.error is meant.
void map_prism(const ChartPrism& prism, std::span<const PrismTriangle> triangles, const Sample& sample, const Tile& tile,
               const RealizeOptions& options, double tile_width, RealizedPart& part);

}  // namespace mesoshell
