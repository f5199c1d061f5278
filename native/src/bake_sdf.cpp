#include <algorithm>
#include <cmath>
#include <string>

#include "embree_scene.h"
#include "mesoshell/bake.h"
#include "parallel.h"
#include "tile_space.h"

namespace mesoshell {

Sdf bake_sdf(const Sample& sample, const glm::ivec3& nodes, Job& job)
{
    for (int axis = 0; axis < 3; ++axis) {
        if (nodes[axis] < 2 || nodes[axis] > 4096) {
            throw InvalidArgument("an SDF resolution is " + std::to_string(nodes[axis]) + "; give 2 to 4096 nodes");
        }
    }
    check_memory("the SDF", 5.0 * nodes.x * nodes.y * nodes.z, "lower its resolution");
    Sdf sdf;
    sdf.nodes = nodes;
    sdf.height = sample.height();
    sdf.aspect = sample.aspect();

    job.stage(0.0f, 0.3f);
    const std::vector<std::uint8_t> inside = classify_inside(sample, nodes, job);
    job.stage(0.3f, 1.0f);
    // Something of the tile lies in every period, so no node is farther from it than this.
    const float farthest = std::sqrt(1.0f + sample.aspect() * sample.aspect() + sample.height() * sample.height());
    const TriangleScene scene(sample.slab_positions(), sample.slab_triangles(), lattice_within(sample, farthest));
    sdf.values.resize(inside.size());
    parallel_for(job, nodes.z * nodes.y, [&](int row) {
        const float z = sample.height() * static_cast<float>(row / nodes.y) / (nodes.z - 1);
        const float y = sample.aspect() * static_cast<float>(row % nodes.y) / nodes.y;
        for (int x = 0; x < nodes.x; ++x) {
            const std::size_t i = static_cast<std::size_t>(row) * nodes.x + x;
            const float distance = scene.distance(glm::vec3(static_cast<float>(x) / nodes.x, y, z), farthest);
            // The caps that clip a solid at the slab are its surface too; outside it they are never the nearest part.
            sdf.values[i] = inside[i] != 0 ? -std::min(distance, std::min(z, sample.height() - z)) : distance;
        }
    });
    return sdf;
}

}  // namespace mesoshell
