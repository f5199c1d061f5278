#include "sheets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace mesoshell {
namespace {

constexpr float least_cosine = 0.5f;  // between a vertex normal and its faces, for the length of an offset

// Corners of triangles that move together: joined across edges that exactly two triangles share, one each way. So sheets
// that only touch, or that meet three at an edge, move each on its own.
class CornerGroups {
public:
    explicit CornerGroups(const PeriodicMesh& mesh) : joined(mesh.triangles.size() * 3, false), parent_(joined.size())
    {
        std::iota(parent_.begin(), parent_.end(), 0u);
        for_each_edge(sorted_sides(mesh), [&](std::span<const Side> edge) {
            if (edge.size() == 2 && edge[0].forward != edge[1].forward) {
                const auto corner = [](const Side& s, bool low) {
                    return 3 * s.triangle + (s.forward == low ? s.corner : (s.corner + 1u) % 3u);
                };
                join(corner(edge[0], true), corner(edge[1], true));
                join(corner(edge[0], false), corner(edge[1], false));
                joined[3 * edge[0].triangle + edge[0].corner] = true;
                joined[3 * edge[1].triangle + edge[1].corner] = true;
            }
        });
    }

    std::uint32_t find(std::uint32_t i)
    {
        while (parent_[i] != i) {
            i = parent_[i] = parent_[parent_[i]];
        }
        return i;
    }

    std::vector<bool> joined;  // of every side: whether another triangle goes on there

private:
    void join(std::uint32_t a, std::uint32_t b)
    {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

    std::vector<std::uint32_t> parent_;
};

// Offsets of every group, of unit distance from the faces.
std::vector<glm::vec3> group_offsets(const PeriodicMesh& mesh, CornerGroups& groups)
{
    std::vector<glm::dvec3> normals(mesh.triangles.size() * 3, glm::dvec3(0.0));
    const auto unit = [](const glm::dvec3& v) { return glm::length(v) > 0.0 ? glm::normalize(v) : v; };
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::dvec3 normal = unit(area_vector(mesh, mesh.triangles[t]));
        for (std::uint32_t i = 0; i < 3; ++i) {
            const auto edge_to = [&](std::uint32_t k) {
                return unit(glm::dvec3(mesh.positions[mesh.triangles[t][k % 3]] - mesh.positions[mesh.triangles[t][i]]));
            };
            const double angle = std::acos(std::clamp(glm::dot(edge_to(i + 1), edge_to(i + 2)), -1.0, 1.0));
            normals[groups.find(3 * t + i)] += normal * angle;
        }
    }
    std::vector<double> cosines(normals.size(), 1.0);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::dvec3 normal = unit(area_vector(mesh, mesh.triangles[t]));
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t group = groups.find(3 * t + i);
            if (glm::length(normal) > 0.0) {
                cosines[group] = std::min(cosines[group], glm::dot(unit(normals[group]), normal));
            }
        }
    }
    std::vector<glm::vec3> offsets(normals.size());
    for (std::size_t i = 0; i < normals.size(); ++i) {
        offsets[i] = glm::vec3(unit(normals[i]) / std::max(cosines[i], static_cast<double>(least_cosine)));
    }
    return offsets;
}

}  // namespace

std::size_t thicken(PeriodicMesh& mesh, const Components& components, float thickness)
{
    CornerGroups groups(mesh);
    std::vector<bool> open(components.triangles.size(), false);
    double covered = 0.0;
    std::vector<double> covered_by(components.triangles.size(), 0.0);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const double seen = area_vector(mesh, mesh.triangles[t]).z * 0.5 / mesh.aspect;
        covered += seen;
        covered_by[components.of_triangle[t]] += seen;
    }
    for_each_edge(sorted_sides(mesh), [&](std::span<const Side> edge) {
        if (edge.size() == 2 && edge[0].forward != edge[1].forward) {
            return;  // then both are of one component
        }
        std::map<std::uint32_t, int> balances;
        for (const Side& s : edge) {
            balances[components.of_triangle[s.triangle]] += s.forward ? 1 : -1;
        }
        for (const auto& [component, sum] : balances) {
            open[component] = open[component] || sum != 0;
        }
    });
    for (std::size_t i = 0; i < open.size(); ++i) {
        open[i] = open[i] || (std::abs(covered) > 0.5 && std::abs(covered_by[i]) > 0.5);
    }
    const auto count = static_cast<std::size_t>(std::count(open.begin(), open.end(), true));
    if (count == 0) {
        return 0;
    }

    const std::vector<glm::vec3> offsets = group_offsets(mesh, groups);
    std::vector<glm::vec3> positions = mesh.positions;
    std::vector<glm::uvec3> triangles;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> above;  // of a group and a vertex; what lies below follows
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!open[components.of_triangle[t]]) {
            triangles.push_back(mesh.triangles[t]);
            continue;
        }
        glm::uvec3 top;
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t group = groups.find(3 * t + i);
            const std::uint32_t vertex = mesh.triangles[t][i];
            const auto [found, added] = above.try_emplace({group, vertex}, static_cast<std::uint32_t>(positions.size()));
            if (added) {
                // From the place all copies share, so that theirs differ by whole periods.
                const glm::vec3 place = mesh.positions[mesh.place[vertex]];
                const glm::vec3 offset = offsets[group] * (0.5f * thickness);
                positions.push_back(place + offset + mesh.period(mesh.shift[vertex]));
                positions.push_back(place - offset + mesh.period(mesh.shift[vertex]));
            }
            top[i] = found->second;
        }
        const glm::uvec3 bottom = top + 1u;
        triangles.push_back(top);
        triangles.emplace_back(bottom.x, bottom.z, bottom.y);
        for (std::uint32_t i = 0; i < 3; ++i) {
            if (!groups.joined[3 * t + i]) {
                const std::uint32_t next = (i + 1) % 3;
                triangles.emplace_back(top[next], top[i], bottom[i]);
                triangles.emplace_back(top[next], bottom[i], bottom[next]);
            }
        }
    }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return count;
}

}  // namespace mesoshell
