// What a GDM bake costs, engine by engine, beside bare loops of Embree over the very same rays. For ./dev bench bake.
//
//     bake_rays MESH nx ny nz ntheta nphi height aspect THREADS ROUNDS WHAT…
//
// MESH holds int32 vertex count, int32 triangle count, float32 positions, uint32 indices. WHAT, any number of them, run one
// after another in every round: "slices" and "embree" (bake_gdm with that engine, everything included), "stream" (the slice
// engine, azimuth by azimuth into the same memory), "packets" (rtcIntersect16, coherent, over instances) and "singles"
// (rtcIntersect1) over the bake's rays. A WHAT may end in "@N" for N threads. Prints the number of rays, then a line of seconds
// a round.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "embree_scene.h"
#include "gdm_baker.h"
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
void for_each_packet(const Gdm& gdm, int threads, const Cast& cast)
{
    const GdmResolution& r = gdm.resolution;
    const int strips = (r.nodes.y + 3) / 4;
    Job job(threads);
    parallel_for(job, r.nphi * strips, [&](int task) {
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
    });
}

class Bench {
public:
    Bench(const Sample& sample, const GdmResolution& resolution)
        : sample_(sample), resolution_(resolution),
          scene_(sample.positions(), sample.triangles(), lattice_within(sample, farthest_reach(resolution, sample.height())))
    {
    }

    double seconds(const std::string& what, int threads)
    {
        Job job(threads);
        if (what == "packets" || what == "singles") {
            // Which rays there are; not measured.
            if (gdm_.values.empty()) {
                Job any;
                gdm_ = bake_gdm(sample_, resolution_, Engine::automatic, any);
            }
        }
        const Clock::time_point start = Clock::now();
        if (what == "slices" || what == "embree") {
            bake_gdm(sample_, resolution_, what == "slices" ? Engine::slices : Engine::embree, job);
        } else if (what == "stream") {
            stream(job);
        } else if (what == "packets") {
            for_each_packet(gdm_, threads,
                            [&](const std::int32_t* valid, RayPacket16& rays) { scene_.intersect16(valid, rays); });
        } else if (what == "singles") {
            for_each_packet(gdm_, threads, [&](const std::int32_t* valid, RayPacket16& rays) { cast_singly(valid, rays); });
        } else {
            std::fprintf(stderr, "bake_rays: there is no %s\n", what.c_str());
            std::exit(2);
        }
        return std::chrono::duration<double>(Clock::now() - start).count();
    }

    std::uint64_t rays() const
    {
        Job job;
        return GdmBaker(sample_, resolution_, Engine::slices, job).rays_per_azimuth() *
               static_cast<std::uint64_t>(resolution_.nphi);
    }

private:
    void stream(Job& job) const
    {
        const GdmBaker baker(sample_, resolution_, Engine::slices, job);
        UninitializedVector<float> values(std::size_t(resolution_.nodes.x) * resolution_.nodes.y * resolution_.nodes.z *
                                          resolution_.ntheta);
        for (int phi = 0; phi < resolution_.nphi; ++phi) {
            baker.bake(phi, 1, values.data(), job);
        }
    }

    void cast_singly(const std::int32_t* valid, RayPacket16& rays) const
    {
        for (int lane = 0; lane < 16; ++lane) {
            if (valid[lane] != 0) {
                scene_.intersect1(glm::vec3(rays.org_x[lane], rays.org_y[lane], rays.org_z[lane]),
                                  glm::vec3(rays.dir_x[lane], rays.dir_y[lane], rays.dir_z[lane]), 0.0f, rays.tfar[lane]);
            }
        }
    }

    const Sample& sample_;
    GdmResolution resolution_;
    TriangleScene scene_;
    Gdm gdm_;
};

}  // namespace

int main(int argc, char** argv)
{
    if (argc < 12) {
        std::fprintf(stderr, "bake_rays MESH nx ny nz ntheta nphi height aspect THREADS ROUNDS WHAT…\n");
        return 2;
    }
    const Sample sample = read_sample(argv[1], std::strtof(argv[7], nullptr), std::strtof(argv[8], nullptr));
    GdmResolution resolution;
    resolution.nodes = glm::ivec3(std::atoi(argv[2]), std::atoi(argv[3]), std::atoi(argv[4]));
    resolution.ntheta = std::atoi(argv[5]);
    resolution.nphi = std::atoi(argv[6]);
    Bench bench(sample, resolution);
    std::printf("%llu\n", static_cast<unsigned long long>(bench.rays()));
    for (int round = 0; round < std::atoi(argv[10]); ++round) {
        for (int i = 11; i < argc; ++i) {
            const char* at = std::strchr(argv[i], '@');
            const std::string what = at != nullptr ? std::string(argv[i], static_cast<std::size_t>(at - argv[i])) : argv[i];
            std::printf("%.6f ", bench.seconds(what, at != nullptr ? std::atoi(at + 1) : std::atoi(argv[9])));
        }
        std::printf("\n");
        std::fflush(stdout);
    }
    return 0;
}
