#include "surface_check.h"

#include <cmath>
#include <string>

namespace mesoshell {
namespace {

bool is_finite(const glm::vec3& v)
{
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Prisms before faces without area are left out: a refined face is four of the level before, but an n-gon starts as n quads.
void check_prism_count(const Surface& surface, const ShellOptions& options)
{
    std::int64_t prisms = 0;
    for (const std::int32_t size : surface.face_sizes) {
        const bool triangles = options.refinement.scheme == Scheme::loop || options.refinement.levels == 0;
        const std::int64_t parts = options.refinement.levels > 0 && !triangles ? 2 * std::int64_t(size) : size - 2;
        const int doublings = options.refinement.levels > 0 && !triangles ? 2 * (options.refinement.levels - 1) : 2 * options.refinement.levels;
        prisms += parts << doublings;
        if (prisms > most_prisms) {
            throw InvalidArgument("the shell would have more than " + std::to_string(most_prisms) +
                                  " prisms; use fewer subdivision levels or a coarser mesh");
        }
    }
}

}  // namespace

void check_surface(const Surface& surface, const ShellOptions& options)
{
    if (!(options.thickness > 0.0f) || !std::isfinite(options.thickness)) {
        throw InvalidArgument("thickness is " + std::to_string(options.thickness) + "; give a positive length");
    }
    if (options.refinement.levels < 0 || options.refinement.levels > 8) {
        throw InvalidArgument("levels is " + std::to_string(options.refinement.levels) + "; give 0 to 8");
    }
    if (surface.face_sizes.empty()) {
        throw InvalidArgument("the surface has no faces; choose a mesh with faces");
    }
    for (std::size_t i = 0; i < surface.positions.size(); ++i) {
        if (!is_finite(surface.positions[i])) {
            throw InvalidArgument("vertex " + std::to_string(i) +
                                  " of the surface is not finite; remove it or repair the modifier that makes it");
        }
    }
    std::size_t corners = 0;
    for (std::size_t face = 0; face < surface.face_sizes.size(); ++face) {
        const std::int32_t size = surface.face_sizes[face];
        if (size < 3) {
            throw InvalidArgument("face " + std::to_string(face) + " of the surface has " + std::to_string(size) +
                                  " corners; a face has at least 3");
        }
        corners += static_cast<std::size_t>(size);
    }
    if (corners != surface.corners.size()) {
        throw InvalidArgument("the face sizes add up to " + std::to_string(corners) + " corners, but there are " +
                              std::to_string(surface.corners.size()));
    }
    for (std::size_t i = 0; i < corners; ++i) {
        if (surface.corners[i] < 0 || static_cast<std::size_t>(surface.corners[i]) >= surface.positions.size()) {
            throw InvalidArgument("corner " + std::to_string(i) + " of the surface uses vertex " +
                                  std::to_string(surface.corners[i]) + ", but there are only " +
                                  std::to_string(surface.positions.size()) + " vertices");
        }
    }
    if (surface.uvs.size() != corners) {
        throw InvalidArgument("the surface has " + std::to_string(surface.uvs.size()) + " UVs for " +
                              std::to_string(corners) + " corners; unwrap it");
    }
    for (std::size_t i = 0; i < corners; ++i) {
        if (!std::isfinite(surface.uvs[i].x) || !std::isfinite(surface.uvs[i].y)) {
            throw InvalidArgument("the UV of corner " + std::to_string(i) + " of the surface is not finite; unwrap it again");
        }
    }
    if (!surface.normals.empty() && surface.normals.size() != surface.positions.size()) {
        throw InvalidArgument("the surface has " + std::to_string(surface.normals.size()) + " normals for " +
                              std::to_string(surface.positions.size()) + " vertices; give one a vertex");
    }
    for (std::size_t i = 0; i < surface.normals.size(); ++i) {
        if (!is_finite(surface.normals[i])) {
            throw InvalidArgument("the normal of vertex " + std::to_string(i) + " of the surface is not finite");
        }
    }
    check_prism_count(surface, options);
}

}  // namespace mesoshell
