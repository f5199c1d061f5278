// Which prisms lie around each vertex.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

class VertexPrisms {
public:
    VertexPrisms(std::size_t vertices, const std::vector<glm::uvec3>& triangles) : first_(vertices + 1, 0)
    {
        for (const glm::uvec3& t : triangles) {
            for (int i = 0; i < 3; ++i) {
                ++first_[t[i] + 1];
            }
        }
        for (std::size_t v = 1; v < first_.size(); ++v) {
            first_[v] += first_[v - 1];
        }
        prisms_.resize(first_.back());
        std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
        for (std::size_t p = 0; p < triangles.size(); ++p) {
            for (int i = 0; i < 3; ++i) {
                prisms_[next[triangles[p][i]]++] = static_cast<std::uint32_t>(p);
            }
        }
    }

    // Ascending.
    std::span<const std::uint32_t> around(std::uint32_t vertex) const
    {
        return {prisms_.data() + first_[vertex], first_[vertex + 1] - first_[vertex]};
    }

private:
    std::vector<std::uint32_t> first_;  // one a vertex and one more
    std::vector<std::uint32_t> prisms_;
};

}  // namespace mesoshell
