// What the two engines of a GDM bake share: the tile, its nodes, and which of them lie in the solid.
#pragma once

#include <cstdint>
#include <vector>

#include "mesoshell/bake.h"
#include "mesoshell/sample.h"

namespace mesoshell {

// Throws InvalidArgument for numbers of nodes or directions out of range.
void check_resolution(const GdmResolution& resolution);

struct GdmTask {
    const Sample& sample;
    GdmResolution resolution;
    std::vector<std::uint8_t> inside;  // [nz, ny, nx]

    float node_z(int z) const { return sample.height() * static_cast<float>(z) / (resolution.nodes.z - 1); }
    // At the poles all azimuths are one direction.
    bool is_pole(int theta) const { return theta == 0 || theta == resolution.ntheta - 1; }
    std::size_t azimuth_size() const
    {
        const glm::ivec3& n = resolution.nodes;
        return static_cast<std::size_t>(n.x) * n.y * n.z * resolution.ntheta;
    }
    // Of the values of one node in a block that begins with azimuth `first`.
    std::size_t offset(int phi, int y, int x, int theta) const
    {
        const glm::ivec3& n = resolution.nodes;
        return (((static_cast<std::size_t>(phi) * n.y + y) * n.x + x) * resolution.ntheta + theta) * n.z;
    }
};

}  // namespace mesoshell
