#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "embree_scene.h"
#include "mesoshell/bake.h"
#include "parallel.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

constexpr std::uint32_t no_geometry = ~0u;
constexpr int block = 4;  // a packet is 4 x 4 neighboring nodes: rays of one direction, side by side

void check_resolution(const GdmResolution& r)
{
    const auto refuse = [](const std::string& what, int value, int least) {
        throw InvalidArgument(what + " is " + std::to_string(value) + "; give at least " + std::to_string(least));
    };
    for (int axis = 0; axis < 3; ++axis) {
        if (r.nodes[axis] < 2) {
            refuse("a GDM resolution", r.nodes[axis], 2);
        }
    }
    if (r.ntheta < 2) {
        refuse("the number of polar directions", r.ntheta, 2);
    }
    if (r.nphi < 1) {
        refuse("the number of azimuth directions", r.nphi, 1);
    }
    if (std::int64_t(r.ntheta) * r.nodes.z > most_columns) {
        throw InvalidArgument("polar directions times nodes in height are " +
                              std::to_string(std::int64_t(r.ntheta) * r.nodes.z) + "; give at most " +
                              std::to_string(most_columns) + ", or compression takes too long");
    }
    const double bytes = 4.0 * r.nodes.x * r.nodes.y * r.nodes.z * r.ntheta * r.nphi;
    check_memory("the raw GDM", bytes, "lower the resolution or the number of directions");
}

// Rays of one azimuth from a 4-row strip of nodes, for every polar angle and height.
class StripBaker {
public:
    StripBaker(const TriangleScene& scene, const std::vector<std::uint8_t>& inside, Gdm& gdm)
        : scene_(scene), inside_(inside), gdm_(gdm)
    {
    }

    // Returns the number of rays cast.
    std::uint64_t bake(int phi, int y_first) const
    {
        const GdmResolution& r = gdm_.resolution;
        std::uint64_t rays = 0;
        for (int x_first = 0; x_first < r.nodes.x; x_first += block) {
            for (int theta = 0; theta < r.ntheta; ++theta) {
                const glm::vec3 dir(gdm_direction(r, theta, phi));
                for (int z = 0; z < r.nodes.z; ++z) {
                    rays += bake_packet(phi, y_first, x_first, theta, z, dir);
                }
            }
        }
        return rays;
    }

private:
    std::uint64_t bake_packet(int phi, int y_first, int x_first, int theta, int z, const glm::vec3& dir) const
    {
        const GdmResolution& r = gdm_.resolution;
        alignas(64) std::int32_t valid[16];
        RayPacket16 rays;
        const float height = gdm_.height * static_cast<float>(z) / (r.nodes.z - 1);
        const float limit = slab_exit(height, dir.z, gdm_.height);
        std::uint64_t cast = 0;
        for (int lane = 0; lane < 16; ++lane) {
            const int x = x_first + lane % block;
            const int y = y_first + lane / block;
            const bool exists = x < r.nodes.x && y < r.nodes.y;
            const bool solid = exists && inside_[(static_cast<std::size_t>(z) * r.nodes.y + y) * r.nodes.x + x] != 0;
            valid[lane] = exists && !solid && limit > 0.0f ? -1 : 0;
            cast += valid[lane] != 0 ? 1 : 0;
            rays.org_x[lane] = static_cast<float>(x) / r.nodes.x;
            rays.org_y[lane] = gdm_.aspect * static_cast<float>(y) / r.nodes.y;
            rays.org_z[lane] = height;
            rays.dir_x[lane] = dir.x;
            rays.dir_y[lane] = dir.y;
            rays.dir_z[lane] = dir.z;
            rays.tnear[lane] = 0.0f;
            rays.tfar[lane] = solid ? 0.0f : limit;
            rays.time[lane] = 0.0f;
            rays.mask[lane] = ~0u;
            rays.id[lane] = 0;
            rays.flags[lane] = 0;
            rays.geometry[lane] = no_geometry;
            rays.instance[lane] = no_geometry;
        }
        if (cast > 0) {
            scene_.intersect16(valid, rays);
        }
        for (int lane = 0; lane < 16; ++lane) {
            const int x = x_first + lane % block;
            const int y = y_first + lane / block;
            if (x < r.nodes.x && y < r.nodes.y) {
                gdm_.values[gdm_.index(phi, y, x, theta, z)] = rays.tfar[lane];
            }
        }
        return cast;
    }

    const TriangleScene& scene_;
    const std::vector<std::uint8_t>& inside_;
    Gdm& gdm_;
};

}  // namespace

glm::dvec3 gdm_direction(const GdmResolution& resolution, int theta, int phi)
{
    const double polar = std::numbers::pi * theta / (resolution.ntheta - 1);
    const double azimuth = 2.0 * std::numbers::pi * phi / resolution.nphi;
    if (theta == 0 || theta == resolution.ntheta - 1) {
        return glm::dvec3(0.0, 0.0, theta == 0 ? 1.0 : -1.0);
    }
    return glm::dvec3(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
}

Gdm bake_gdm(const Sample& sample, const GdmResolution& resolution, Job& job)
{
    check_resolution(resolution);
    Gdm gdm;
    gdm.resolution = resolution;
    gdm.height = sample.height();
    gdm.aspect = sample.aspect();
    const glm::ivec3& nodes = resolution.nodes;

    job.stage(0.0f, 0.05f);
    const std::vector<std::uint8_t> inside = classify_inside(sample, nodes, job);
    const TriangleScene scene(sample.positions(), sample.triangles(),
                              lattice_within(sample, farthest_reach(resolution, sample.height())));
    gdm.values.resize(static_cast<std::size_t>(nodes.x) * nodes.y * nodes.z * resolution.ntheta * resolution.nphi);

    job.stage(0.05f, 1.0f);
    const StripBaker baker(scene, inside, gdm);
    const int strips = (nodes.y + block - 1) / block;
    std::atomic<std::uint64_t> rays = 0;
    parallel_for(job, resolution.nphi * strips,
                 [&](int task) { rays += baker.bake(task / strips, task % strips * block); });
    gdm.ray_count = rays;
    return gdm;
}

}  // namespace mesoshell
