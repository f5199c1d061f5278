// Folds: prisms that are turned inside out, or that overlap others, because the surface bends more sharply than the shell is
// thick; and their repair by a locally thinner shell (Porumbescu et al. 2005, "Shell maps").
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/shell.h"

namespace mesoshell {

// Pairs listed, at most; past that many, prisms are marked but not listed.
constexpr std::size_t most_fold_pairs = std::size_t(1) << 20;

struct Folds {
    // One a prism, 0 or 1.
    std::vector<std::uint8_t> inverted;      // its map is inside out somewhere within it
    std::vector<std::uint8_t> intersecting;  // it overlaps another
    std::vector<std::uint8_t> base;          // either, as the surface folds or crosses itself: no thickness mends it
    std::vector<glm::uvec2> pairs;           // prisms that overlap, the smaller first, in ascending order
};

// Inverted: exact (src/fold_jacobian.h), on the corners that the prism table holds.
//
// Intersecting: with no prism inverted, the shell overlaps itself exactly if its boundary does, a map without folds that is
// injective on the boundary being injective; so the triangles of its base and top and its fins along borders are
// intersected, and the fins around inverted prisms, whose own overlaps with one another are not asked for. From there
// overlaps are followed from neighbor to neighbor. Exact for triangles and for plane fins, for others to a 64th of their
// bulge (src/fold_crossing.h); touching is no overlap. Prisms without thickness at all corners have no inside.
//
// The base: surface triangles that cross one another; three prisms at one edge, of which two lie on the same side; prisms
// whose directors lie behind them, at a vertex around which no direction is in front of all faces; prisms that share a
// vertex and overlap at a 128th of their thickness too.
Folds find_folds(const Shell& shell, Job& job);
inline Folds find_folds(const Shell& shell)
{
    Job job;
    return find_folds(shell, job);
}

// The steepest that repair lets the loss of thickness change along an edge of a prism: thickness per length.
constexpr float repair_slope = 0.5f;

// Lowers the thickness of vertices, and turns directors that lie behind faces, until find_folds reports no prism but those
// marked `base`, of which none are inverted: where no direction is in front of all faces the thickness becomes 0. Prisms
// keep a hundredth of their Jacobian on the surface at least. To be called before make_table; what the thickness is at the
// call is what was asked, and no vertex gets more. Along every edge of a prism the kept share of the asked thickness changes
// by at most repair_slope * length / the greatest asked thickness. The result depends on the shell alone, not on threads.
void repair_folds(Shell& shell, Job& job);

}  // namespace mesoshell
