// All prisms of a shell that overlap others: crossings of the boundary, and from there to the prisms within.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "box_tree.h"
#include "fold_search.h"
#include "mesoshell/job.h"

namespace mesoshell {

class OverlapFinder {
public:
    // `all_fins`: fins between prisms are pieces too. Needed where prisms are inverted, because then the boundary alone does not
    // tell; some five times the cost.
    OverlapFinder(FoldSearch& search, bool all_fins, Job& job);

    // Finds what overlaps with the shell's thickness as it is: pairs, the smaller first, in ascending order. With `active`, one a
    // prism, only pairs of at least one such prism and what they spread to.
    void find(const std::vector<std::uint8_t>* active = nullptr);
    const std::vector<glm::uvec2>& pairs() const { return pairs_; }
    // Of prisms that overlap very many others, more may be marked than listed.
    bool marked(std::uint32_t prism) const { return marks_[prism].load(std::memory_order_relaxed) != 0; }

private:
    void mark(std::uint32_t a, std::uint32_t b);
    void cross_pieces(const std::vector<std::uint8_t>* active);
    void cross_piece(std::uint32_t piece, std::size_t room, const std::vector<std::uint8_t>* active,
                     std::vector<glm::uvec2>& found);
    void spread();
    std::vector<glm::uvec2> beside(const std::vector<glm::uvec2>& pairs) const;

    FoldSearch& search_;
    bool all_fins_;
    Job& job_;
    std::vector<Box> boxes_;
    std::optional<BoxTree> tree_;
    std::vector<std::atomic<std::uint8_t>> marks_;
    std::vector<glm::uvec2> pairs_;
};

}  // namespace mesoshell
