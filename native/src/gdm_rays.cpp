#include "gdm_rays.h"

#include "parallel.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

constexpr std::uint32_t no_geometry = ~0u;
constexpr int block = 4;  // a packet is 4 x 4 neighboring nodes

}  // namespace

RayBaker::RayBaker(const GdmTask& task)
    : task_(task), scene_(task.sample.positions(), task.sample.triangles(),
                          lattice_within(task.sample, farthest_reach(task.resolution, task.sample.height())))
{
}

void RayBaker::bake(int first, int count, float* values, Job& job) const
{
    const GdmResolution& r = task_.resolution;
    const int strips = (r.nodes.y + block - 1) / block;
    parallel_for(job, count * strips, [&](int index) {
        const int phi = index / strips;
        float* const of_azimuth = values + task_.offset(phi, 0, 0, 0);
        for (int theta = 0; theta < r.ntheta; ++theta) {
            if (!task_.is_pole(theta)) {
                bake_packets(first + phi, theta, index % strips * block, 1, of_azimuth);
            } else if (phi == 0) {
                bake_packets(first, theta, index % strips * block, count, values);
            }
        }
    });
}

void RayBaker::bake_direction(int phi, int theta, int count, float* values) const
{
    for (int y = 0; y < task_.resolution.nodes.y; y += block) {
        bake_packets(phi, theta, y, task_.is_pole(theta) ? count : 1, values);
    }
}

void RayBaker::bake_packets(int phi, int theta, int y_first, int copies, float* values) const
{
    const GdmResolution& r = task_.resolution;
    const glm::vec3 dir(gdm_direction(r, theta, phi));
    const float aspect = task_.sample.aspect();
    alignas(64) std::int32_t valid[16];
    RayPacket16 rays;
    for (int lane = 0; lane < 16; ++lane) {
        rays.dir_x[lane] = dir.x;
        rays.dir_y[lane] = dir.y;
        rays.dir_z[lane] = dir.z;
        rays.tnear[lane] = 0.0f;
        rays.time[lane] = 0.0f;
        rays.mask[lane] = ~0u;
        rays.id[lane] = 0;
        rays.flags[lane] = 0;
        rays.org_y[lane] = aspect * static_cast<float>(y_first + lane / block) / r.nodes.y;
    }
    for (int x_first = 0; x_first < r.nodes.x; x_first += block) {
        for (int lane = 0; lane < 16; ++lane) {
            rays.org_x[lane] = static_cast<float>(x_first + lane % block) / r.nodes.x;
        }
        for (int z = 0; z < r.nodes.z; ++z) {
            const float height = task_.node_z(z);
            const float limit = slab_exit(height, dir.z, task_.sample.height());
            bool any = false;
            for (int lane = 0; lane < 16; ++lane) {
                const int x = x_first + lane % block;
                const int y = y_first + lane / block;
                const bool exists = x < r.nodes.x && y < r.nodes.y;
                const bool solid = exists && task_.inside[(static_cast<std::size_t>(z) * r.nodes.y + y) * r.nodes.x + x] != 0;
                valid[lane] = exists && !solid && limit > 0.0f ? -1 : 0;
                any = any || valid[lane] != 0;
                rays.org_z[lane] = height;
                rays.tfar[lane] = solid ? 0.0f : limit;
                rays.geometry[lane] = no_geometry;
                rays.instance[lane] = no_geometry;
            }
            if (any) {
                scene_.intersect16(valid, rays);
            }
            for (int lane = 0; lane < 16; ++lane) {
                const int x = x_first + lane % block;
                const int y = y_first + lane / block;
                if (x < r.nodes.x && y < r.nodes.y) {
                    for (int copy = 0; copy < copies; ++copy) {
                        values[task_.offset(copy, y, x, theta) + z] = rays.tfar[lane];
                    }
                }
            }
        }
    }
}

}  // namespace mesoshell
