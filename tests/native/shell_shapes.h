// Surfaces on which stretch is known or large: their UVs are not in proportion.
#pragma once

#include <cmath>
#include <numbers>

#include "meshes.h"

namespace mesoshell {

// A quad grid bent around the z axis with a profile r(z); u runs around, v along z, `tiles` of each. Normals are exact where
// the profile's slope is given.
template <typename Radius, typename Slope>
SurfaceMesh lathe(int around, int along, float tiles_u, float tiles_v, const Radius& radius, const Slope& slope)
{
    SurfaceMesh mesh;
    for (int j = 0; j <= along; ++j) {
        for (int i = 0; i < around; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / around;
            const double z = static_cast<double>(j) / along;
            const glm::dvec3 out(std::cos(angle), std::sin(angle), 0.0);
            mesh.positions.push_back(glm::vec3(out * radius(z) + glm::dvec3(0.0, 0.0, z)));
            mesh.normals.push_back(glm::vec3(glm::normalize(out - glm::dvec3(0.0, 0.0, slope(z)))));
        }
    }
    for (int j = 0; j < along; ++j) {
        for (int i = 0; i < around; ++i) {
            mesh.face_sizes.push_back(4);
            for (const glm::ivec2 c : {glm::ivec2(i, j), {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}) {
                mesh.corners.push_back(c.y * around + c.x % around);
                mesh.uvs.emplace_back(tiles_u * static_cast<float>(c.x) / static_cast<float>(around),
                                      tiles_v * static_cast<float>(c.y) / static_cast<float>(along));
            }
        }
    }
    return mesh;
}

// Thick at the foot and the belly, thin at the neck.
inline SurfaceMesh vase(int around, int along)
{
    return lathe(around, along, 8.0f, 4.0f, [](double z) { return 0.3 + 0.12 * std::sin(6.0 * z); },
                 [](double z) { return 0.72 * std::cos(6.0 * z); });
}

// The unit sphere without caps around its poles, its z axis from -1 to 1 cut at 0.8.
inline SurfaceMesh ball_zone(int around, int along)
{
    SurfaceMesh mesh = lathe(around, along, 8.0f, 3.0f, [](double) { return 1.0; }, [](double) { return 0.0; });
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const double z = 1.6 * mesh.positions[i].z - 0.8;
        const double across = std::sqrt(1.0 - z * z);
        mesh.positions[i] = glm::vec3(mesh.positions[i].x * across, mesh.positions[i].y * across, z);
        mesh.normals[i] = mesh.positions[i];
    }
    return mesh;
}

}  // namespace mesoshell
