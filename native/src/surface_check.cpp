#include "surface_check.h"

#include <cmath>
#include <string>
#include <utility>

namespace mesoshell {
namespace {

bool is_finite(const glm::vec3& v)
{
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_finite(std::span<const glm::vec3> positions)
{
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (!is_finite(positions[i])) {
            throw InvalidArgument("vertex " + std::to_string(i) +
                                  " of the surface is not finite; remove it or repair the modifier that makes it");
        }
    }
}

void check_normals(std::span<const glm::vec3> normals, std::size_t vertices)
{
    if (!normals.empty() && normals.size() != vertices) {
        throw InvalidArgument("the surface has " + std::to_string(normals.size()) + " normals for " +
                              std::to_string(vertices) +
                              " vertices; give one a vertex");
    }
    for (std::size_t i = 0; i < normals.size(); ++i) {
        if (!is_finite(normals[i])) {
            throw InvalidArgument("the normal of vertex " + std::to_string(i) + " of the surface is not finite");
        }
    }
}

// `what` is an edge or a vertex, with its number.
void check_sharpness(float sharpness, const std::string& what)
{
    if (!(sharpness >= 0.0f) || !std::isfinite(sharpness)) {
        throw InvalidArgument("the sharpness of " + what + " is " + std::to_string(sharpness) +
                              "; give 0 (smooth) to 10 (sharp)");
    }
}

void check_creases(const Surface& surface)
{
    const auto require_vertex = [&](std::int32_t vertex, const std::string& what) {
        if (vertex < 0 || static_cast<std::size_t>(vertex) >= surface.positions.size()) {
            throw InvalidArgument(what + " uses vertex " + std::to_string(vertex) + ", but there are only " +
                                  std::to_string(surface.positions.size()) + " vertices");
        }
    };
    if (surface.crease_edges.size() != surface.crease_sharpness.size()) {
        throw InvalidArgument("there are " + std::to_string(surface.crease_sharpness.size()) + " sharpnesses for " +
                              std::to_string(surface.crease_edges.size()) + " creased edges; give one an edge");
    }
    for (std::size_t i = 0; i < surface.crease_edges.size(); ++i) {
        const std::string what = "creased edge " + std::to_string(i);
        require_vertex(surface.crease_edges[i].x, what);
        require_vertex(surface.crease_edges[i].y, what);
        if (surface.crease_edges[i].x == surface.crease_edges[i].y) {
            throw InvalidArgument(what + " has vertex " + std::to_string(surface.crease_edges[i].x) + " at both ends");
        }
        check_sharpness(surface.crease_sharpness[i], what);
    }
    if (surface.corner_vertices.size() != surface.corner_sharpness.size()) {
        throw InvalidArgument("there are " + std::to_string(surface.corner_sharpness.size()) + " sharpnesses for " +
                              std::to_string(surface.corner_vertices.size()) + " sharp corners; give one a corner");
    }
    for (std::size_t i = 0; i < surface.corner_vertices.size(); ++i) {
        const std::string what = "sharp corner " + std::to_string(i);
        require_vertex(surface.corner_vertices[i], what);
        check_sharpness(surface.corner_sharpness[i], what);
    }
}

void check_refinement(const Refinement& refinement)
{
    if (refinement.levels < 0 || refinement.levels > 8) {
        throw InvalidArgument("levels is " + std::to_string(refinement.levels) + "; give 0 to 8");
    }
    for (const auto& [name, length] : {std::pair("edge_length", refinement.edge_length),
        {"edge_pixels", refinement.edge_pixels}}) {
        if (!(length >= 0.0f) || !std::isfinite(length)) {
            throw InvalidArgument(std::string(name) + " is " + std::to_string(length) +
                                  "; give a positive length, or 0 for none");
        }
    }
    if (refinement.edge_pixels > 0.0f) {
        if (refinement.screen.x < 1 || refinement.screen.y < 1) {
            throw InvalidArgument("edge_pixels needs a screen of at least one pixel; give its width and height");
        }
        for (int i = 0; i < 16; ++i) {
            if (!std::isfinite(refinement.clip_from_object[i / 4][i % 4])) {
                throw InvalidArgument("clip_from_object is not finite; give the camera's projection");
            }
        }
    }
}

// Prisms before faces without area are left out: a refined face is four of the level before, but an n-gon starts as n quads.
void check_prism_count(const Surface& surface, const ShellOptions& options)
{
    std::int64_t prisms = 0;
    for (const std::int32_t size : surface.face_sizes) {
        const bool triangles = options.refinement.scheme == Scheme::loop || options.refinement.levels == 0;
        const std::int64_t parts = options.refinement.levels > 0 && !triangles ? 2 * std::int64_t(size) : size - 2;
        const int doublings = options.refinement.levels > 0 && !triangles
            ? 2 * (options.refinement.levels - 1) : 2 * options.refinement.levels;
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
    check_refinement(options.refinement);
    if (surface.face_sizes.empty()) {
        throw InvalidArgument("the surface has no faces; choose a mesh with faces");
    }
    check_finite(surface.positions);
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
            throw InvalidArgument("the UV of corner " + std::to_string(i) +
                                  " of the surface is not finite; unwrap it again");
        }
    }
    check_normals(surface.normals, surface.positions.size());
    check_creases(surface);
    if (options.refinement.edge_length == 0.0f &&
        options.refinement.edge_pixels == 0.0f) {  // else counted when edges are known
        check_prism_count(surface, options);
    }
}

void check_pose(const Pose& pose, std::size_t vertices)
{
    if (pose.positions.size() != vertices) {
        throw InvalidArgument("the shell was built over " + std::to_string(vertices) + " vertices, but there are " +
                              std::to_string(pose.positions.size()) +
                                  " positions; build it again where vertices come or go");
    }
    check_finite(pose.positions);
    check_normals(pose.normals, vertices);
    if (!pose.thickness_factors.empty() && pose.thickness_factors.size() != vertices) {
        throw InvalidArgument("there are " + std::to_string(pose.thickness_factors.size()) + " thickness factors for " +
                              std::to_string(vertices) + " vertices; give one a vertex");
    }
    for (std::size_t i = 0; i < pose.thickness_factors.size(); ++i) {
        if (!(pose.thickness_factors[i] >= 0.0f && pose.thickness_factors[i] <= 1.0f)) {
            throw InvalidArgument("the thickness factor of vertex " + std::to_string(i) + " is " +
                                  std::to_string(pose.thickness_factors[i]) + "; give 0 to 1");
        }
    }
}

}  // namespace mesoshell
