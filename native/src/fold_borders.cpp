#include "fold_borders.h"

#include <algorithm>

#include <oneapi/tbb/parallel_sort.h>

#include "parallel.h"

namespace mesoshell {
namespace {

// An edge of a prism: its vertices in ascending order, then its place, 3 prism + corner.
struct Use {
    std::uint64_t edge;
    std::uint32_t place;
    bool operator<(const Use& other) const { return edge != other.edge ? edge < other.edge : place < other.place; }
};

}  // namespace

FoldBorders find_borders(const ShellTopology& topology, Job& job)
{
    const std::vector<glm::uvec3>& triangles = topology.triangles;
    const auto corner = [&](std::uint32_t place, std::uint32_t next) {
        return triangles[place / 3][static_cast<glm::length_t>((place % 3 + next) % 3)];
    };
    std::vector<Use> uses(3 * triangles.size());
    for (std::uint32_t place = 0; place < uses.size(); ++place) {
        const std::uint64_t a = corner(place, 0);
        const std::uint64_t b = corner(place, 1);
        uses[place] = {std::min(a, b) << 32 | std::max(a, b), place};
    }
    oneapi::tbb::task_arena arena(job.threads() > 0 ? job.threads() : oneapi::tbb::task_arena::automatic);
    arena.execute([&] { oneapi::tbb::parallel_sort(uses.begin(), uses.end()); });

    FoldBorders borders;
    borders.neighbors.assign(triangles.size(), {no_neighbor, no_neighbor, no_neighbor});
    for (std::size_t first = 0, last = 0; first < uses.size(); first = last) {
        while (last < uses.size() && uses[last].edge == uses[first].edge) {
            ++last;
        }
        const auto along = [&](std::size_t i) { return corner(uses[i].place, 0) < corner(uses[i].place, 1); };
        if (last - first == 2 && along(first) != along(first + 1)) {
            const std::uint32_t one = uses[first].place;
            const std::uint32_t other = uses[first + 1].place;
            borders.neighbors[one / 3][one % 3] = other / 3;
            borders.neighbors[other / 3][other % 3] = one / 3;
            continue;
        }
        for (std::size_t i = first; i < last; ++i) {
            // Only against the next on the same side, so that an edge of many prisms has not the square of their number.
            const auto on_same_side = [&](std::size_t j) { return along(i) == along(j); };
            std::size_t j = i + 1;
            while (j < last && !on_same_side(j)) {
                ++j;
            }
            if (j < last && uses[i].place / 3 != uses[j].place / 3) {
                borders.same_side.emplace_back(uses[i].place / 3, uses[j].place / 3);
            }
        }
    }
    const auto ascending = [](const glm::uvec2& a, const glm::uvec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
    std::sort(borders.same_side.begin(), borders.same_side.end(), ascending);
    borders.same_side.erase(std::unique(borders.same_side.begin(), borders.same_side.end()), borders.same_side.end());
    return borders;
}

}  // namespace mesoshell
