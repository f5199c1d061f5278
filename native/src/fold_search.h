// What both the report and the repair of folds ask of a shell: its prisms' corners, and which pieces of its boundary cross.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "box_tree.h"
#include "fold_borders.h"
#include "fold_crossing.h"
#include "fold_jacobian.h"
#include "mesoshell/job.h"
#include "mesoshell/shell.h"

namespace mesoshell {

inline bool ascending(const glm::uvec2& a, const glm::uvec2& b)
{
    return a.x != b.x ? a.x < b.x : a.y < b.y;
}

class FoldSearch {
public:
    // The shell must outlive this; its topology, positions and shift must stay.
    FoldSearch(const Shell& shell, Job& job);

    std::size_t prisms() const { return triangles_.size(); }
    std::size_t vertex_count() const { return shell_.positions.size(); }
    const glm::uvec3& vertices(std::uint32_t prism) const { return triangles_[prism]; }

    // Corners as make_table has them, with all thicknesses scaled.
    PrismCorners corners(std::uint32_t prism, float scale = 1.0f) const;
    bool empty(std::uint32_t prism) const;
    // Bit i: the corner i has a thickness, and its director does not lie in front of the prism's triangle. Exact.
    std::uint32_t hidden_directors(std::uint32_t prism) const;

    // Prisms whose surface triangles cross, and those on the same side of an edge: overlaps that no thickness
    // mends. Ascending.
    const std::vector<glm::uvec2>& crossing_surfaces() const { return crossing_surfaces_; }
    const std::vector<glm::uvec2>& same_side() const { return borders_.same_side; }

    std::uint32_t neighbor(std::uint32_t prism, std::uint32_t side) const { return borders_.neighbors[prism][side]; }

    // The boundary's pieces: base and top of every prism, and fins along the border and around prisms that are inverted (one
    // mark a prism, or none at all).
    void make_pieces(const std::vector<std::uint8_t>& inverted);
    std::size_t pieces() const { return 2 * prisms() + fins_.size(); }
    std::uint32_t prism_of(std::uint32_t piece) const;
    void piece_boxes(std::vector<Box>& boxes, Job& job) const;
    bool pieces_cross(std::uint32_t a, std::uint32_t b) const;

    // Whether two prisms overlap, with all thicknesses scaled: any of their faces cross, or one holds the middle of the
    // other's base. Of prisms that share a vertex, fins between prisms are left out: those meet by right.
    bool prisms_overlap(std::uint32_t a, std::uint32_t b, float scale) const;
    bool share_vertex(std::uint32_t a, std::uint32_t b) const;

    // Whether an overlap of two prisms is one that no thickness mends.
    bool of_base(std::uint32_t a, std::uint32_t b) const;

private:
    struct Fin {
        std::uint32_t prism;
        std::uint32_t side;
    };
    void cross_surfaces(Job& job);
    Triangle surface(std::uint32_t prism) const;
    bool is_border(const Fin& fin) const { return neighbor(fin.prism, fin.side) == no_neighbor; }
    bool fins_cross(const Fin& fin, const PrismCorners& prism_a, const Fin& other, const PrismCorners& prism_b) const;

    const Shell& shell_;
    const std::vector<glm::uvec3>& triangles_;
    FoldBorders borders_;
    std::vector<Fin> fins_;
    std::vector<glm::uvec2> crossing_surfaces_;
};

}  // namespace mesoshell
