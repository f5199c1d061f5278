#include "tile_space.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <unistd.h>

#include "columns.h"
#include "parallel.h"

namespace mesoshell {
namespace {

// Copies of the tile along one axis; more would take gigabytes of instances.
constexpr float most_copies = 1000.0f;

}  // namespace

TriangleScene::Lattice lattice_within(const Sample& sample, float reach)
{
    return lattice_within(sample.positions(), sample.aspect(), reach);
}

TriangleScene::Lattice lattice_within(std::span<const glm::vec3> positions, float aspect, float reach)
{
    glm::vec3 lower(std::numeric_limits<float>::max());
    glm::vec3 upper(std::numeric_limits<float>::lowest());
    for (const glm::vec3& p : positions) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    TriangleScene::Lattice lattice;
    lattice.period = glm::vec2(1.0f, aspect);
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
    std::vector<float> z(static_cast<std::size_t>(nodes.z));
    for (int k = 0; k < nodes.z; ++k) {
        z[static_cast<std::size_t>(k)] = sample.height() * static_cast<float>(k) / static_cast<float>(nodes.z - 1);
    }
    return classify_by_columns(sample.winding_mesh(), glm::ivec2(nodes), z, job);
}

}  // namespace mesoshell
