// A map's volumes as textures hold them: periodic axes and the upper end of w repeat nodes behind their last, so that a
// trilinear fetch is eight loads without a remainder, and densities are computed once.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/compress.h"

namespace mesoshell {

class PaddedVolume {
public:
    PaddedVolume() = default;

    // value_of(a value of the array [nz, ny, nx]).
    template <typename Value>
    PaddedVolume(const std::vector<float>& values, const glm::ivec3& nodes, const Value& value_of)
        : nodes_(nodes), row_(static_cast<std::size_t>(nodes.x) + 2), slice_(row_ * (static_cast<std::size_t>(nodes.y) + 2))
    {
        padded_.reserve(slice_ * (static_cast<std::size_t>(nodes.z) + 1));
        for (int z = 0; z <= nodes.z; ++z) {
            for (int y = 0; y < nodes.y + 2; ++y) {
                const std::size_t line =
                    (static_cast<std::size_t>(std::min(z, nodes.z - 1)) * nodes.y + y % nodes.y) * nodes.x;
                for (int x = 0; x < nodes.x + 2; ++x) {
                    padded_.push_back(value_of(values[line + static_cast<std::size_t>(x % nodes.x)]));
                }
            }
        }
    }

    // Trilinear, at node coordinates in [0, nx], [0, ny] and [0, nz - 1]. Others are clamped; no number gives no number.
    float at(const glm::vec3& node) const
    {
        const Place x = place(node.x, nodes_.x);
        const Place y = place(node.y, nodes_.y);
        const Place z = place(node.z, nodes_.z - 1);
        const float* const corner = padded_.data() + z.low * slice_ + y.low * row_ + x.low;
        const auto row = [&](std::size_t offset) { return glm::mix(corner[offset], corner[offset + 1], x.share); };
        const float low = glm::mix(row(0), row(row_), y.share);
        const float high = glm::mix(row(slice_), row(slice_ + row_), y.share);
        return glm::mix(low, high, z.share);
    }

private:
    struct Place {
        std::size_t low;
        float share;  // of the node after it
    };

    static Place place(float node, int last)
    {
        const float inside = node >= 0.0f ? std::min(node, static_cast<float>(last)) : 0.0f;
        const auto low = static_cast<std::size_t>(static_cast<int>(inside));
        return {low, node == node ? inside - static_cast<float>(low) : node};
    }

    glm::ivec3 nodes_{0};
    std::size_t row_ = 0;
    std::size_t slice_ = 0;
    std::vector<float> padded_;  // [nz + 1, ny + 2, nx + 2]
};

// The distance field, and the density that is made from it, where it is asked for.
struct MapVolumes {
    PaddedVolume sdf;
    PaddedVolume density;

    enum class Parts { sdf, sdf_and_density };

    MapVolumes() = default;
    MapVolumes(const Map& map, Parts parts) : sdf(map.sdf, map.sdf_nodes, [](float value) { return value; })
    {
        if (parts == Parts::sdf_and_density) {
            const auto voxels = static_cast<float>(map.sdf_nodes.x);
            density = PaddedVolume(map.sdf, map.sdf_nodes, [voxels](float value) {
                return std::nearbyint(256.0f * glm::clamp(0.5f - value * voxels, 0.0f, 1.0f)) / 256.0f;
            });
        }
    }
};

}  // namespace mesoshell
