#include "mesoshell/shell.h"

#include <cmath>
#include <limits>
#include <string>

#include "limit_surface.h"

namespace mesoshell {
namespace {

bool is_finite(const glm::vec3& v)
{
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_surface(const Surface& surface, const ShellOptions& options)
{
    if (!(options.thickness > 0.0f) || !std::isfinite(options.thickness)) {
        throw InvalidArgument("thickness is " + std::to_string(options.thickness) + "; give a positive length");
    }
    if (options.levels < 0 || options.levels > 8) {
        throw InvalidArgument("levels is " + std::to_string(options.levels) + "; give 0 to 8");
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
}

// Prisms before faces without area are left out: a refined face is four of the level before, but an n-gon starts as n quads.
void check_prism_count(const Surface& surface, const ShellOptions& options)
{
    std::int64_t prisms = 0;
    for (const std::int32_t size : surface.face_sizes) {
        const bool triangles = options.scheme == Scheme::loop || options.levels == 0;
        const std::int64_t parts = options.levels > 0 && !triangles ? 2 * std::int64_t(size) : size - 2;
        const int doublings = options.levels > 0 && !triangles ? 2 * (options.levels - 1) : 2 * options.levels;
        prisms += parts << doublings;
        if (prisms > most_prisms) {
            throw InvalidArgument("the shell would have more than " + std::to_string(most_prisms) +
                                  " prisms; use fewer subdivision levels or a coarser mesh");
        }
    }
}

// Face normals weighted by the angle at the vertex, so that triangulation does not matter.
std::vector<glm::vec3> angle_weighted_normals(const Surface& surface)
{
    std::vector<glm::vec3> normals(surface.positions.size(), glm::vec3(0.0f));
    std::size_t first = 0;
    for (const std::int32_t size : surface.face_sizes) {
        for (std::int32_t i = 0; i < size; ++i) {
            const std::int32_t vertex = surface.corners[first + i];
            const glm::vec3& p = surface.positions[vertex];
            const glm::vec3 next = surface.positions[surface.corners[first + (i + 1) % size]] - p;
            const glm::vec3 before = surface.positions[surface.corners[first + (i + size - 1) % size]] - p;
            const glm::vec3 normal = glm::cross(next, before);
            const float area = glm::length(normal);
            if (area > 0.0f) {
                normals[vertex] += normal / area * std::atan2(area, glm::dot(next, before));
            }
        }
        first += static_cast<std::size_t>(size);
    }
    return normals;
}

RefinedSurface unrefined(const Surface& surface)
{
    RefinedSurface same;
    same.positions.assign(surface.positions.begin(), surface.positions.end());
    same.face_sizes.assign(surface.face_sizes.begin(), surface.face_sizes.end());
    same.corners.assign(surface.corners.begin(), surface.corners.end());
    same.uvs.assign(surface.uvs.begin(), surface.uvs.end());
    same.normals = surface.normals.empty() ? angle_weighted_normals(surface)
                                           : std::vector<glm::vec3>(surface.normals.begin(), surface.normals.end());
    for (glm::vec3& normal : same.normals) {
        const float size = glm::length(normal);
        normal = size > 0.0f ? normal / size : glm::vec3(0.0f);
    }
    return same;
}

PrismIndices hull_indices(const PrismTexels& texels, std::uint32_t prism)
{
    const auto corner = [&](int i) { return glm::vec3(texels[i]); };
    std::array<std::uint32_t, 24> local{0, 2, 1, 3, 4, 5};
    std::size_t used = 6;
    for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t j = (i + 1) % 3;
        const glm::vec3 outward = glm::cross(corner(j) - corner(i), corner(j + 3) - corner(i));
        const bool rising = glm::dot(outward, corner(i + 3) - corner(i)) <= 0.0f;
        const std::array<std::uint32_t, 6> fin = rising ? std::array<std::uint32_t, 6>{i, j, j + 3, i, j + 3, i + 3}
                                                        : std::array<std::uint32_t, 6>{i, j, i + 3, j, j + 3, i + 3};
        for (const std::uint32_t index : fin) {
            local[used++] = index;
        }
    }
    for (std::uint32_t& index : local) {
        index += 6 * prism;
    }
    return local;
}

class ShellBuilder {
public:
    ShellBuilder(const RefinedSurface& surface, float thickness) : surface_(surface), thickness_(thickness)
    {
        shell_.lower = glm::vec3(std::numeric_limits<float>::max());
        shell_.upper = glm::vec3(std::numeric_limits<float>::lowest());
    }

    // Three face corners, counterclockwise seen from outside.
    void add_triangle(std::size_t a, std::size_t b, std::size_t c)
    {
        const std::array<std::size_t, 3> corners{a, b, c};
        PrismTexels texels{};
        for (int i = 0; i < 3; ++i) {
            const std::int32_t vertex = surface_.corners[corners[i]];
            const glm::vec3& normal = surface_.normals[vertex];
            if (normal == glm::vec3(0.0f)) {
                throw Error("vertex " + std::to_string(vertex) +
                            " of the surface has no normal; remove zero-area faces, or faces folded onto each other");
            }
            const glm::vec3 base = surface_.positions[vertex];
            const glm::vec3 top = base + normal * thickness_;
            const glm::vec2 uv = surface_.uvs[corners[i]];
            texels[i] = glm::vec4(base, uv.x);
            texels[i + 3] = glm::vec4(top, uv.x);
            texels[6 + i / 4][i % 4] = uv.y;
            texels[6 + (i + 3) / 4][(i + 3) % 4] = uv.y;
            shell_.lower = glm::min(shell_.lower, glm::min(base, top));
            shell_.upper = glm::max(shell_.upper, glm::max(base, top));
        }
        shell_.indices.push_back(hull_indices(texels, static_cast<std::uint32_t>(shell_.prisms.size())));
        shell_.prisms.push_back(texels);
    }

    bool has_area(std::size_t a, std::size_t b, std::size_t c) const
    {
        return glm::cross(at(b) - at(a), at(c) - at(a)) != glm::vec3(0.0f);
    }

    const glm::vec3& at(std::size_t corner) const { return surface_.positions[surface_.corners[corner]]; }

    Shell take() { return std::move(shell_); }

private:
    const RefinedSurface& surface_;
    float thickness_;
    Shell shell_;
};

}  // namespace

Shell build_shell(const Surface& surface, const ShellOptions& options)
{
    check_surface(surface, options);
    check_prism_count(surface, options);
    const RefinedSurface refined =
        options.levels > 0 ? refine(surface, options.levels, options.scheme) : unrefined(surface);
    ShellBuilder builder(refined, options.thickness);
    std::size_t first = 0;
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        if (builder.has_area(a, b, c)) {
            builder.add_triangle(a, b, c);
        }
    };
    for (std::size_t face = 0; face < refined.face_sizes.size(); ++face) {
        const std::int32_t size = refined.face_sizes[face];
        if (size > 4) {
            throw Error("face " + std::to_string(face) + " of the surface has " + std::to_string(size) +
                        " corners; use levels = 1 or more, or triangulate it");
        }
        if (size == 3) {
            add(first, first + 1, first + 2);
        } else {
            const glm::vec3 diagonal_02 = builder.at(first + 2) - builder.at(first);
            const glm::vec3 diagonal_13 = builder.at(first + 3) - builder.at(first + 1);
            if (glm::dot(diagonal_02, diagonal_02) <= glm::dot(diagonal_13, diagonal_13)) {
                add(first, first + 1, first + 2);
                add(first, first + 2, first + 3);
            } else {
                add(first, first + 1, first + 3);
                add(first + 1, first + 2, first + 3);
            }
        }
        first += static_cast<std::size_t>(size);
    }
    Shell shell = builder.take();
    if (shell.prisms.empty()) {
        throw Error("every face of the surface has zero area; choose a mesh with visible faces");
    }
    return shell;
}

}  // namespace mesoshell
