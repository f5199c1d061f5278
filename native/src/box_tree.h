// A tree of boxes that is asked which of them overlap one box. Embree has no such query (its rtcCollide hands out all pairs
// of two scenes, in no order); here the visits of one box come in a fixed order, may stop early, and boxes may shrink in
// place.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"

namespace mesoshell {

struct Box {
    glm::vec3 lower;
    glm::vec3 upper;
    bool overlaps(const Box& other) const
    {
        return lower.x <= other.upper.x && other.lower.x <= upper.x && lower.y <= other.upper.y &&
               other.lower.y <= upper.y && lower.z <= other.upper.z && other.lower.z <= upper.z;
    }
    void extend(const glm::vec3& point)
    {
        lower = glm::min(lower, point);
        upper = glm::max(upper, point);
    }
};

// Up to 2^31 boxes. Those that are empty (lower > upper) overlap none.
class BoxTree {
public:
    // Sorted along a Morton curve, so that the tree is complete and needs no pointers.
    BoxTree(std::span<const Box> boxes, Job& job);

    // The same boxes, changed. The order stays that of the boxes the tree was made of.
    void refit(std::span<const Box> boxes, Job& job);

    // Calls visit(index) for every box that overlaps `box`, until it returns false.
    template <typename Visit>
    void overlapping(const Box& box, const Visit& visit) const
    {
        if (leaves_ == 0) {
            return;
        }
        std::uint32_t stack[64];
        int used = 0;
        stack[used++] = 1;
        while (used > 0) {
            const std::uint32_t node = stack[--used];
            if (!nodes_[node].overlaps(box)) {
                continue;
            }
            if (node < leaves_) {
                stack[used++] = 2 * node + 1;
                stack[used++] = 2 * node;
                continue;
            }
            const std::size_t first = static_cast<std::size_t>(node - leaves_) * leaf_size;
            for (std::size_t i = first; i < first + leaf_size && i < order_.size(); ++i) {
                if (sorted_[i].overlaps(box) && !visit(order_[i])) {
                    return;
                }
            }
        }
    }

private:
    static constexpr std::size_t leaf_size = 4;

    std::vector<std::uint32_t> order_;  // boxes along the curve
    std::vector<Box> sorted_;           // in that order
    std::vector<Box> nodes_;            // children of i: 2 i and 2 i + 1; the last leaves_ of them are leaves
    std::uint32_t leaves_ = 0;          // a power of two
};

}  // namespace mesoshell
