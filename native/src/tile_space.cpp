#include "tile_space.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <unistd.h>

#include "parallel.h"

namespace mesoshell {
namespace {

// Almost vertical, and tilted by ratios that no modeled symmetry has, so that a ray meets no edge of the mesh. Three vote.
constexpr std::array<glm::vec3, 3> probe_directions{glm::vec3(0.05371f, 0.07193f, 0.99596f),
                                                    glm::vec3(-0.08417f, 0.03119f, -0.99596f),
                                                    glm::vec3(0.02713f, -0.09241f, 0.99535f)};

// Copies of the tile along one axis; more would take gigabytes of instances.
constexpr float most_copies = 1000.0f;

bool is_inside(const TriangleScene& scene, const glm::vec3& point, bool oriented)
{
    int votes = 0;
    for (const glm::vec3& dir : probe_directions) {
        const TriangleScene::Crossings crossings = scene.count_crossings(point, dir);
        votes += (oriented ? crossings.winding != 0 : crossings.count % 2 != 0) ? 1 : 0;
    }
    return votes >= 2;
}

}  // namespace

TriangleScene::Lattice lattice_within(const Sample& sample, float reach)
{
    glm::vec3 lower(std::numeric_limits<float>::max());
    glm::vec3 upper(std::numeric_limits<float>::lowest());
    for (const glm::vec3& p : sample.positions()) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    TriangleScene::Lattice lattice;
    lattice.period = glm::vec2(1.0f, sample.aspect());
    for (int axis = 0; axis < 2; ++axis) {
        const float period = lattice.period[axis];
        const float last = std::ceil((period + reach - lower[axis]) / period);
        const float first = std::floor((-reach - upper[axis]) / period);
        if (last - first > most_copies) {
            throw InvalidArgument("the tile's mesh or its reach spans more than " +
                                  std::to_string(static_cast<int>(most_copies)) +
                                  " periods; move the mesh to the tile box, or make the period larger");
        }
        lattice.first[axis] = static_cast<int>(first);
        lattice.last[axis] = static_cast<int>(last);
    }
    return lattice;
}

float slab_exit(float z, float dir_z, float height)
{
    if (std::abs(dir_z) < 1e-6f) {
        return horizon_distance;
    }
    return std::min(dir_z > 0.0f ? (height - z) / dir_z : z / -dir_z, horizon_distance);
}

float farthest_reach(const GdmResolution& resolution, float height)
{
    float reach = 0.0f;
    for (int theta = 0; theta < resolution.ntheta; ++theta) {
        const glm::dvec3 dir = gdm_direction(resolution, theta, 0);
        const float sideways = static_cast<float>(glm::length(glm::dvec2(dir)));
        const float vertical = static_cast<float>(dir.z);
        reach = std::max(reach, sideways * std::max(slab_exit(0.0f, vertical, height), slab_exit(height, vertical, height)));
    }
    return reach;
}

void check_memory(const std::string& what, double bytes, const std::string& remedy)
{
    const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    if (bytes > memory) {
        throw InvalidArgument(what + " would take " + std::to_string(static_cast<long long>(bytes / 1e9)) +
                              " GB, and the machine has " + std::to_string(static_cast<long long>(memory / 1e9)) + "; " +
                              remedy);
    }
}

std::vector<std::uint8_t> classify_inside(const Sample& sample, const glm::ivec3& nodes, Job& job)
{
    float lowest = 0.0f;
    float highest = sample.height();
    for (const glm::vec3& p : sample.positions()) {
        lowest = std::min(lowest, p.z);
        highest = std::max(highest, p.z);
    }
    const float reach = 0.12f * (highest - lowest);  // the probes lean by less than that
    const TriangleScene scene(sample.positions(), sample.triangles(), lattice_within(sample, reach),
                              TriangleScene::Use::crossings);
    std::vector<std::uint8_t> inside(static_cast<std::size_t>(nodes.x) * nodes.y * nodes.z);
    parallel_for(job, nodes.z * nodes.y, [&](int row) {
        const int z = row / nodes.y;
        const int y = row % nodes.y;
        for (int x = 0; x < nodes.x; ++x) {
            const glm::vec3 point(static_cast<float>(x) / nodes.x, sample.aspect() * static_cast<float>(y) / nodes.y,
                                  sample.height() * static_cast<float>(z) / (nodes.z - 1));
            inside[static_cast<std::size_t>(row) * nodes.x + x] = is_inside(scene, point, sample.oriented()) ? 1 : 0;
        }
    });
    return inside;
}

}  // namespace mesoshell
