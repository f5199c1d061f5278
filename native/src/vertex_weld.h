// Vertices at one place, bit for bit, become one.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

class VertexWeld {
public:
    // Room for about so many; it grows.
    explicit VertexWeld(std::size_t expected) : slots_(std::bit_ceil(2 * expected + 16), empty) {}

    std::uint32_t find_or_add(glm::vec3 p)
    {
        p += 0.0f;  // one zero of two
        for (std::size_t slot = hash(p) & (slots_.size() - 1);; slot = (slot + 1) & (slots_.size() - 1)) {
            if (slots_[slot] == empty) {
                slots_[slot] = static_cast<std::uint32_t>(positions.size());
                positions.push_back(p);
                if (2 * positions.size() > slots_.size()) {
                    grow();
                }
                return static_cast<std::uint32_t>(positions.size() - 1);
            }
            if (positions[slots_[slot]] == p) {
                return slots_[slot];
            }
        }
    }

    std::vector<glm::vec3> positions;

private:
    static constexpr std::uint32_t empty = ~0u;

    static std::size_t hash(const glm::vec3& p)
    {
        std::uint64_t h = std::bit_cast<std::uint32_t>(p.x) * 0x9E3779B97F4A7C15u;
        h = (h ^ h >> 32 ^ std::bit_cast<std::uint32_t>(p.y)) * 0xC2B2AE3D27D4EB4Fu;
        h = (h ^ h >> 32 ^ std::bit_cast<std::uint32_t>(p.z)) * 0x165667B19E3779F9u;
        return static_cast<std::size_t>(h ^ h >> 29);
    }

    void grow()
    {
        slots_.assign(2 * slots_.size(), empty);
        for (std::uint32_t i = 0; i < positions.size(); ++i) {
            std::size_t slot = hash(positions[i]) & (slots_.size() - 1);
            while (slots_[slot] != empty) {
                slot = (slot + 1) & (slots_.size() - 1);
            }
            slots_[slot] = i;
        }
    }

    std::vector<std::uint32_t> slots_;
};

}  // namespace mesoshell
