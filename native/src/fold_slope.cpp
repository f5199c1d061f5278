#include "fold_slope.h"

#include <functional>
#include <queue>
#include <utility>

namespace mesoshell {

std::vector<std::uint32_t> limit_slope(const Shell& shell, const VertexPrisms& around, float slope,
                                       std::span<const std::uint32_t> lowered, std::vector<float>& shares)
{
    using Entry = std::pair<float, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
    std::vector<std::uint32_t> changed(lowered.begin(), lowered.end());
    std::vector<std::uint8_t> is_changed(shares.size(), 0);
    for (const std::uint32_t vertex : lowered) {
        queue.emplace(shares[vertex], vertex);
        is_changed[vertex] = 1;
    }
    while (!queue.empty()) {
        const auto [share, vertex] = queue.top();
        queue.pop();
        if (share > shares[vertex]) {
            continue;
        }
        for (const std::uint32_t p : around.around(vertex)) {
            const glm::uvec3& triangle = shell.topology->triangles[p];
            for (int i = 0; i < 3; ++i) {
                const std::uint32_t other = triangle[i];
                const float most = share + slope * glm::length(shell.positions[other] - shell.positions[vertex]);
                if (most < shares[other]) {
                    shares[other] = most;
                    queue.emplace(most, other);
                    if (is_changed[other] == 0) {
                        is_changed[other] = 1;
                        changed.push_back(other);
                    }
                }
            }
        }
    }
    return changed;
}

}  // namespace mesoshell
