#include "mesoshell/shell.h"

#include <string>

#include "limit_surface.h"
#include "mesoshell/folds.h"
#include "shell_table.h"
#include "surface_check.h"

namespace mesoshell {
namespace {

// Triangles of a refined surface: quads are cut along their shorter diagonals, faces without area are left out.
class Triangulation {
public:
    explicit Triangulation(const RefinedSurface& surface) : surface_(surface) {}

    ShellTopology run()
    {
        topology_.uvs = surface_.uvs;
        std::size_t first = 0;
        for (std::size_t face = 0; face < surface_.face_sizes.size(); ++face) {
            const std::int32_t size = surface_.face_sizes[face];
            if (size > 4) {
                throw Error("face " + std::to_string(face) + " of the surface has " + std::to_string(size) +
                            " corners; use levels = 1 or more, or triangulate it");
            }
            const glm::vec3 diagonal_02 = at(first + 2) - at(first);
            const glm::vec3 diagonal_13 = size == 4 ? at(first + 3) - at(first + 1) : glm::vec3(0.0f);
            if (size == 3) {
                add(face, first, first + 1, first + 2);
            } else if (glm::dot(diagonal_02, diagonal_02) <= glm::dot(diagonal_13, diagonal_13)) {
                add(face, first, first + 1, first + 2);
                add(face, first, first + 2, first + 3);
            } else {
                add(face, first, first + 1, first + 3);
                add(face, first + 1, first + 2, first + 3);
            }
            first += static_cast<std::size_t>(size);
        }
        return std::move(topology_);
    }

private:
    const glm::vec3& at(std::size_t corner) const { return surface_.positions[surface_.corners[corner]]; }

    void add(std::size_t face, std::size_t a, std::size_t b, std::size_t c)
    {
        if (glm::cross(at(b) - at(a), at(c) - at(a)) == glm::vec3(0.0f)) {
            return;
        }
        topology_.triangles.emplace_back(surface_.corners[a], surface_.corners[b], surface_.corners[c]);
        topology_.uv_triangles.emplace_back(surface_.uv_corners[a], surface_.uv_corners[b], surface_.uv_corners[c]);
        topology_.faces.push_back(surface_.faces[face]);
    }

    const RefinedSurface& surface_;
    ShellTopology topology_;
};

void check_normals(const ShellTopology& topology, const std::vector<glm::vec3>& normals)
{
    for (const glm::uvec3& triangle : topology.triangles) {
        for (int i = 0; i < 3; ++i) {
            if (normals[triangle[i]] == glm::vec3(0.0f)) {
                throw Error("vertex " + std::to_string(triangle[i]) +
                            " of the surface has no normal; remove zero-area faces, or faces folded onto each other");
            }
        }
    }
}

}  // namespace

Shell build_shell(const Surface& surface, const ShellOptions& options, Job& job)
{
    check_surface(surface, options);
    RefinedSurface refined = refine(surface, options.refinement);
    auto topology = std::make_shared<const ShellTopology>(Triangulation(refined).run());
    if (topology->triangles.empty()) {
        throw Error("every face of the surface has zero area; choose a mesh with visible faces");
    }
    check_normals(*topology, refined.normals);
    Shell shell;
    shell.topology = std::move(topology);
    shell.positions = std::move(refined.positions);
    shell.directors = std::move(refined.normals);
    shell.thickness.assign(shell.positions.size(), options.thickness);
    shell.shift = options.shift;
    if (options.repair) {
        repair_folds(shell, job);
    }
    make_table(shell, job);
    return shell;
}

}  // namespace mesoshell
