// All prisms of a shell that overlap others: crossings of the boundary, and from there to the prisms within.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "box_tree.h"
#include "fold_parts.h"
#include "fold_search.h"
#include "mesoshell/job.h"

namespace mesoshell {

class OverlapFinder {
public:
    // `inverted`: one mark a prism, or none at all; must outlive this. Without such prisms the boundary tells whether
    // anything overlaps; what is left of the shell without them has the fins around them as boundary too. Of two inverted
    // prisms nothing is asked.
    OverlapFinder(FoldSearch& search, const std::vector<std::uint8_t>& inverted, Job& job);

    // Finds what overlaps with the shell's thickness as it is: pairs, the smaller first, in ascending order. With `active`,
    // one a prism, only pairs of at least one such prism and what they spread to.
    void find(const std::vector<std::uint8_t>* active = nullptr);
    const std::vector<glm::uvec2>& pairs() const { return pairs_; }
    // Of prisms that overlap very many others, more may be marked than listed.
    bool marked(std::uint32_t prism) const { return marks_[prism].load(std::memory_order_relaxed) != 0; }

private:
    bool both_inverted(std::uint32_t a, std::uint32_t b) const;
    void mark(std::uint32_t a, std::uint32_t b);
    void cross_pieces(const std::vector<std::uint8_t>* active);
    void cross_piece(std::uint32_t piece, std::size_t room, const std::vector<std::uint8_t>* active,
                     std::vector<glm::uvec2>& found);
    void spread();
    std::vector<glm::uvec2> beside(const std::vector<glm::uvec2>& pairs) const;

    FoldSearch& search_;
    const std::vector<std::uint8_t>& inverted_;
    Job& job_;
    FoldParts parts_;
    std::vector<Box> boxes_;
    std::optional<BoxTree> tree_;
    std::vector<std::atomic<std::uint8_t>> marks_;
    std::vector<glm::uvec2> pairs_;
};

}  // namespace mesoshell
