#include "mesoshell/shell.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <string>

#include "parallel.h"
#include "shell_rig.h"
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
        const std::size_t most = surface_.corners.size() - 2 * surface_.face_sizes.size();
        topology_.triangles.reserve(most);
        topology_.uv_triangles.reserve(most);
        topology_.faces.reserve(most);
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

void check_normals(const ShellTopology& topology, const std::vector<glm::vec3>& normals, Job& job)
{
    constexpr std::size_t prisms_per_task = 16384;
    const std::size_t count = topology.triangles.size();
    std::atomic<std::size_t> first_without{count};
    parallel_for(job, static_cast<int>((count + prisms_per_task - 1) / prisms_per_task), [&](int task) {
        const std::size_t first = static_cast<std::size_t>(task) * prisms_per_task;
        for (std::size_t p = first; p < std::min(count, first + prisms_per_task); ++p) {
            for (int i = 0; i < 3; ++i) {
                if (normals[topology.triangles[p][i]] == glm::vec3(0.0f)) {
                    std::size_t seen = first_without.load();
                    while (p < seen && !first_without.compare_exchange_weak(seen, p)) {
                    }
                    return;
                }
            }
        }
    }, 0.0f);
    if (first_without < count) {
        const glm::uvec3& triangle = topology.triangles[first_without];
        const int i = normals[triangle[0]] == glm::vec3(0.0f) ? 0 : normals[triangle[1]] == glm::vec3(0.0f) ? 1 : 2;
        throw Error("vertex " + std::to_string(triangle[i]) +
                    " of the surface has no normal; remove zero-area faces, or faces folded onto each other");
    }
}

// What depends on positions, in a build and in an update alike.
void take_pose(Shell& shell, LimitPoints points, Job& job)
{
    check_normals(*shell.topology, points.normals, job);
    shell.positions = std::move(points.positions);
    shell.directors = std::move(points.normals);
    shell.tangents = std::move(points.tangents);
    make_table(shell, job);
}

}  // namespace

Shell build_shell(const Surface& surface, const ShellOptions& options, Job& job)
{
    check_surface(surface, options);
    auto rig = std::make_shared<ShellRig>(surface, options, job);
    RefinedSurface refined{rig->limit.take_topology(), rig->limit.evaluate(surface.positions, surface.normals, job)};
    auto topology = std::make_shared<const ShellTopology>(Triangulation(refined).run());
    if (topology->triangles.empty()) {
        throw Error("every face of the surface has zero area; choose a mesh with visible faces");
    }
    Shell shell;
    shell.topology = std::move(topology);
    shell.thickness.assign(refined.positions.size(), options.thickness);
    rig->full_thickness = shell.thickness;
    rig->thickness = shell.thickness;
    shell.rig = std::move(rig);
    take_pose(shell, std::move(refined), job);
    return shell;
}

Shell update_shell(const Shell& shell, const Pose& pose, Job& job)
{
    const ShellRig& rig = *shell.rig;
    check_pose(pose, rig.limit.vertices());
    Shell moved;
    moved.topology = shell.topology;
    moved.rig = shell.rig;
    moved.shift = shell.shift;
    moved.thickness = rig.thickness;
    if (!pose.thickness_factors.empty()) {
        moved.thickness = rig.limit.interpolate(pose.thickness_factors, job);
        std::transform(rig.full_thickness.begin(), rig.full_thickness.end(), moved.thickness.begin(),
                       moved.thickness.begin(),
                       std::multiplies<>());
    }
    take_pose(moved, rig.limit.evaluate(pose.positions, pose.normals, job), job);
    return moved;
}

}  // namespace mesoshell
