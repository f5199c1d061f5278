// What Embree alone does with the rays of a GDM bake: rtcIntersect16 on coherent packets over instances of the tile, and
// rtcIntersect1. For ./dev bench bake; the rays, their order and the threads are those of bake_gdm.
//
//     bake_rays MESH nx ny nz ntheta nphi height aspect ROUNDS
//
// MESH holds int32 vertex count, int32 triangle count, float32 positions, uint32 indices. Prints, a line each round:
// seconds and rays of bake_gdm, of the packets, of single rays.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "embree_scene.h"
#include "mesoshell/bake.h"
#include "parallel.h"
#include "tile_space.h"

namespace {

using namespace mesoshell;
using Clock = std::chrono::steady_clock;

Sample read_sample(const char* path, float height, float aspect)
{
    std::ifstream file(path, std::ios::binary);
    std::int32_t counts[2] = {0, 0};
    file.read(reinterpret_cast<char*>(counts), sizeof counts);
    std::vector<glm::vec3> positions(static_cast<std::size_t>(counts[0]));
    std::vector<glm::uvec3> triangles(static_cast<std::size_t>(counts[1]));
    file.read(reinterpret_cast<char*>(positions.data()), static_cast<std::streamsize>(positions.size() * sizeof(glm::vec3)));
    file.read(reinterpret_cast<char*>(triangles.data()), static_cast<std::streamsize>(triangles.size() * sizeof(glm::uvec3)));
    if (!file) {
        std::fprintf(stderr, "bake_rays: %s is no mesh\n", path);
        std::exit(1);
    }
    return Sample(std::move(positions), std::move(triangles), height, aspect);
}

// Every ray that bake_gdm casts, in its order: a strip of four rows for one azimuth at a time.
template <typename Cast>
std::uint64_t for_each_packet(const Gdm& gdm, const Cast& cast)
{
    const GdmResolution& r = gdm.resolution;
    const int strips = (r.nodes.y + 3) / 4;
    std::atomic<std::uint64_t> rays = 0;
    Job job;
    parallel_for(job, r.nphi * strips, [&](int task) {
        std::uint64_t cast_here = 0;
        for (int x_first = 0; x_first < r.nodes.x; x_first += 4) {
            for (int theta = 0; theta < r.ntheta; ++theta) {
                const glm::vec3 dir(gdm_direction(r, theta, task / strips));
                for (int z = 0; z < r.nodes.z; ++z) {
                    alignas(64) std::int32_t valid[16];
                    RayPacket16 rays16{};
                    const float w = gdm.height * static_cast<float>(z) / static_cast<float>(r.nodes.z - 1);
                    const float limit = slab_exit(w, dir.z, gdm.height);
                    for (int lane = 0; lane < 16; ++lane) {
                        const int x = x_first + lane % 4;
                        const int y = task % strips * 4 + lane / 4;
                        const bool exists = x < r.nodes.x && y < r.nodes.y;
                        // A zero distance is a node inside the solid, from which no ray is cast.
                        const bool casts =
                            exists && limit > 0.0f && gdm.values[gdm.index(task / strips, y, x, theta, z)] > 0.0f;
                        valid[lane] = casts ? -1 : 0;
                        cast_here += casts ? 1 : 0;
                        rays16.org_x[lane] = static_cast<float>(x) / static_cast<float>(r.nodes.x);
                        rays16.org_y[lane] = gdm.aspect * static_cast<float>(y) / static_cast<float>(r.nodes.y);
                        rays16.org_z[lane] = w;
                        rays16.dir_x[lane] = dir.x;
                        rays16.dir_y[lane] = dir.y;
                        rays16.dir_z[lane] = dir.z;
                        rays16.tfar[lane] = limit;
                        rays16.mask[lane] = ~0u;
                        rays16.geometry[lane] = ~0u;
                        rays16.instance[lane] = ~0u;
                    }
                    cast(valid, rays16);
                }
            }
        }
        rays += cast_here;
    });
    return rays;
}

double seconds_since(Clock::time_point start)
{
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

int main(int argc, char** argv)
{
    if (argc != 10) {
        std::fprintf(stderr, "bake_rays MESH nx ny nz ntheta nphi height aspect ROUNDS\n");
        return 2;
    }
    const Sample sample = read_sample(argv[1], std::strtof(argv[7], nullptr), std::strtof(argv[8], nullptr));
    GdmResolution resolution;
    resolution.nodes = glm::ivec3(std::atoi(argv[2]), std::atoi(argv[3]), std::atoi(argv[4]));
    resolution.ntheta = std::atoi(argv[5]);
    resolution.nphi = std::atoi(argv[6]);
    std::printf("bake_seconds packet_seconds single_seconds bake_rays packet_rays single_rays\n");
    for (int round = 0; round < std::atoi(argv[9]); ++round) {
        Job job;
        Clock::time_point start = Clock::now();
        const Gdm gdm = bake_gdm(sample, resolution, job);
        const double bake_seconds = seconds_since(start);

        const TriangleScene scene(sample.positions(), sample.triangles(),
                                  lattice_within(sample, farthest_reach(resolution, sample.height())));
        start = Clock::now();
        const std::uint64_t packet_rays =
            for_each_packet(gdm, [&](const std::int32_t* valid, RayPacket16& rays) { scene.intersect16(valid, rays); });
        const double packet_seconds = seconds_since(start);

        start = Clock::now();
        const std::uint64_t single_rays = for_each_packet(gdm, [&](const std::int32_t* valid, RayPacket16& rays) {
            for (int lane = 0; lane < 16; ++lane) {
                if (valid[lane] != 0) {
                    scene.intersect1(glm::vec3(rays.org_x[lane], rays.org_y[lane], rays.org_z[lane]),
                                     glm::vec3(rays.dir_x[lane], rays.dir_y[lane], rays.dir_z[lane]), 0.0f, rays.tfar[lane]);
                }
            }
        });
        std::printf("%.6f %.6f %.6f %llu %llu %llu\n", bake_seconds, packet_seconds, seconds_since(start),
                    static_cast<unsigned long long>(gdm.ray_count), static_cast<unsigned long long>(packet_rays),
                    static_cast<unsigned long long>(single_rays));
        std::fflush(stdout);
    }
    return 0;
}
