#include "mesoshell/shell.h"

#include <algorithm>
#include <atomic>
#include <string>

#include "director_smoothing.h"
#include "extrusion.h"
#include "mesoshell/folds.h"
#include "parallel.h"
#include "placement.h"
#include "relax.h"
#include "shell_rig.h"
#include "shell_table.h"
#include "surface_check.h"
#include "thickness.h"
#include "triangulation.h"

namespace mesoshell {
namespace {

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
                    " of the surface has no normal; remove zero-area faces, or split faces whose normals cancel there");
    }
}

// What depends on positions, in a build and in an update alike.
void take_pose(Shell& shell, LimitPoints points, Job& job)
{
    const ShellRig& rig = *shell.rig;
    check_normals(*shell.topology, points.normals, job);
    shell.positions = std::move(points.positions);
    shell.directors = std::move(points.normals);
    shell.tangents = std::move(points.tangents);
    smooth_directors(shell.directors, shell.positions, shell.topology->triangles, rig.smoothed, rig.director_smoothing, job);
    if (rig.repair) {
        repair_folds(shell, job);
    }
}

}  // namespace

Shell build_shell(const Surface& surface, const ShellOptions& options, Job& job)
{
    check_surface(surface, options);
    check_extrusion(surface, options);
    auto rig = std::make_shared<ShellRig>(surface, options, job);
    RefinedSurface refined{rig->limit.take_topology(), rig->limit.evaluate(surface.positions, surface.normals, job)};
    ShellTopology topology = triangulate(refined, options.covered);
    rig->full_thickness = image_thickness(options.thickness, options.thickness_image, refined.positions.size(), refined.corners,
                                          refined.uv_corners, refined.uvs);
    rig->thickness = rig->full_thickness;
    if (!options.thickness_factors.empty()) {
        scale_thickness(rig->thickness, rig->limit.interpolate(options.thickness_factors, job));
    }
    leave_out_flat_prisms(topology, rig->thickness);
    place_uvs(topology.uvs, options.placement);
    if (options.director_smoothing > 0) {
        rig->smoothed = covered_faces(refined, options.covered);
    }
    Shell shell;
    shell.topology = std::make_shared<const ShellTopology>(std::move(topology));
    shell.thickness = rig->thickness;
    shell.shift = options.shift;
    shell.rig = std::move(rig);
    in_arena(job, [&] {
        take_pose(shell, std::move(refined), job);
        relax_top_uvs(shell, options.relax_steps, job);
        make_table(shell, job);
    });
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
    moved.top_uvs = shell.top_uvs;  // relaxed once: a pattern that moved with every pose would swim
    in_arena(job, [&] {
        if (!pose.thickness_factors.empty()) {
            moved.thickness = rig.full_thickness;
            scale_thickness(moved.thickness, rig.limit.interpolate(pose.thickness_factors, job));
        }
        take_pose(moved, rig.limit.evaluate(pose.positions, pose.normals, job), job);
        make_table(moved, job);
    });
    return moved;
}

}  // namespace mesoshell
