// What the shader text must know of a map's grids.
#pragma once

#include <glm/glm.hpp>

#include "mesoshell/compress.h"

namespace mesoshell {

// Nodes of the azimuth along the weights and the eigenmaps; 0 where they have no such axis.
inline glm::vec2 azimuth_axes(const Map& map)
{
    const auto axis = [](int azimuths) { return azimuths > 1 ? static_cast<float>(azimuths) : 0.0f; };
    return glm::vec2(axis(map.weight_azimuths()), axis(map.eigen_azimuths()));
}

// Throws InvalidArgument for a map without a distance field.
inline void check_sdf(const Map& map)
{
    if (map.sdf.empty()) {
        throw InvalidArgument("the map has no distance field; bake one and pass it to compress(..., sdf=...)");
    }
}

}  // namespace mesoshell
