#include "corner_fans.h"

#include <cmath>
#include <limits>

namespace mesoshell {

CornerFans::CornerFans(std::span<const std::int32_t> face_sizes, std::span<const std::int32_t> corners,
                       const std::vector<bool>& chosen)
{
    constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> fan_of(chosen.size(), none);
    for (std::size_t vertex = 0; vertex < chosen.size(); ++vertex) {
        if (chosen[vertex]) {
            fan_of[vertex] = static_cast<std::uint32_t>(vertices_.size());
            vertices_.push_back(static_cast<std::uint32_t>(vertex));
        }
    }
    if (vertices_.empty()) {
        return;
    }
    firsts_.assign(vertices_.size() + 1, 0);
    for (const std::int32_t corner : corners) {
        if (fan_of[corner] != none) {
            ++firsts_[fan_of[corner] + 1];
        }
    }
    for (std::size_t fan = 0; fan < vertices_.size(); ++fan) {
        firsts_[fan + 1] += firsts_[fan];
    }
    sides_.resize(firsts_.back());
    std::vector<std::uint32_t> used(firsts_.begin(), firsts_.end() - 1);
    std::size_t first = 0;
    for (const std::int32_t size : face_sizes) {
        for (std::int32_t i = 0; i < size; ++i) {
            const std::uint32_t fan = fan_of[corners[first + i]];
            if (fan != none) {
                sides_[used[fan]++] = {static_cast<std::uint32_t>(corners[first + (i + 1) % size]),
                                       static_cast<std::uint32_t>(corners[first + (i + size - 1) % size])};
            }
        }
        first += static_cast<std::size_t>(size);
    }
}

glm::vec3 CornerFans::normal(std::size_t fan, std::span<const glm::vec3> positions) const
{
    const glm::vec3& p = positions[vertices_[fan]];
    glm::vec3 sum(0.0f);
    for (std::uint32_t i = firsts_[fan]; i < firsts_[fan + 1]; ++i) {
        const glm::vec3 next = positions[sides_[i].next] - p;
        const glm::vec3 before = positions[sides_[i].before] - p;
        const glm::vec3 normal = glm::cross(next, before);
        const float area = glm::length(normal);
        if (area > 0.0f) {
            sum += normal / area * std::atan2(area, glm::dot(next, before));
        }
    }
    const float size = glm::length(sum);
    return size > 0.0f && std::isfinite(size) ? sum / size : glm::vec3(0.0f);
}

}  // namespace mesoshell
