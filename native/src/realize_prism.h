// One prism's part of the realized mesh.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "realize_charts.h"
#include "realize_tile.h"

namespace mesoshell {

struct PrismPoint {
    std::array<double, 3> weight{};  // of the prism's corners; exactly 0 on a fin, with bits that both prisms share
    double w = 0.0;
};

struct PrismTriangle {
    std::array<PrismPoint, 3> corners;
    std::uint32_t tile_triangle = 0;
    glm::ivec2 copy{0};  // whole tiles by which that triangle is moved
    bool cap = false;    // of a fin
};

// Clips triangles of the tile to a prism. Which corner, edge or triangle of the tile lies on which side of the prism's
// columns and fins is asked exactly, of what both prisms at a fin have in common (plane_side.h), so that neighbors cut
// alike: edges of the results that lie on a fin are there twice, once each way. Where base and top have different UVs the
// fins are bent in texture space and answers come from double precision, in one order from both sides; where a tile's edge
// enters through such a fin and leaves through it again, that is not seen, which right beside a column may leave a hole.
class PrismClip {
public:
    // upright: no prism of the shell has other UVs at its top than at its base.
    PrismClip(const ChartPrism& prism, bool upright);

    void add(const Tile& tile, std::uint32_t triangle, const glm::ivec2& copy);

    // Closes the solid where it was cut along open fins.
    void cap_open_fins();

    const std::vector<PrismTriangle>& triangles() const { return triangles_; }

    glm::i64vec2 lower() const { return lower_; }
    glm::i64vec2 upper() const { return upper_; }

private:
    struct Vertex;
    struct Cut {  // on a fin, as the triangle's outline runs
        PrismPoint from, to;
        int group;
        std::uint32_t tile_triangle;
        glm::ivec2 copy;
    };
    struct Crossing {  // of a tile's edge with a fin
        double along;  // from the lesser of the fin's vertices to the greater, 0 to 1 between them
        double w;
    };

    bool corner_inside(int corner, int fin) const;
    bool column_left_of(int edge, int column) const;
    Crossing cross_bent_fin(int fin, int edge) const;
    bool inside(const Vertex& vertex, int fin) const;
    PrismPoint place(const Vertex& vertex) const;
    PrismPoint place_of_corner(const TileCorner& corner) const;
    PrismPoint place_on_fin(int fin, int edge) const;
    PrismPoint place_on_column(int column) const;
    PrismPoint on_fin(int fin, double along_from_lesser, double w) const;
    PrismPoint on_column(int column, double w) const;
    glm::dvec2 uv_at(int column, double w) const;
    double height_at_column(int edge, int column) const;
    void cap_fin(int fin, std::span<const Cut> cuts);

    const ChartPrism& prism_;
    bool upright_;
    glm::i64vec2 lower_;
    glm::i64vec2 upper_;
    std::array<TileCorner, 3> tile_;             // the triangle at hand
    std::array<std::array<bool, 3>, 3> inside_;  // its corners by fin
    std::array<std::array<Crossing, 3>, 3> crossings_;  // its edges by fin, where fins are bent and the edge crosses one
    std::vector<PrismTriangle> triangles_;
    std::array<std::vector<Cut>, 3> cuts_;
};

}  // namespace mesoshell
