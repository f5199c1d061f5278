#include "repair.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "groups.h"

namespace mesoshell {
namespace {

using Corner = std::tuple<std::uint32_t, int, int>;  // place, periods from the first corner
using Key = std::array<Corner, 3>;

// The same for triangles with the same corners in any order, modulo a common period.
Key unordered_key(const PeriodicMesh& mesh, const glm::uvec3& t)
{
    Key least;
    for (int first = 0; first < 3; ++first) {
        const glm::ivec2 origin = mesh.shift[t[first]];
        Key key;
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t vertex = t[(first + i) % 3];
            const glm::ivec2 shift = mesh.shift[vertex] - origin;
            key[i] = {mesh.place[vertex], shift.x, shift.y};
        }
        std::sort(key.begin() + 1, key.end());
        if (first == 0 || key < least) {
            least = key;
        }
    }
    return least;
}

std::size_t erase_marked(std::vector<glm::uvec3>& triangles, const std::vector<bool>& marked)
{
    std::size_t kept = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (!marked[i]) {
            triangles[kept++] = triangles[i];
        }
    }
    const std::size_t erased = triangles.size() - kept;
    triangles.resize(kept);
    return erased;
}

}  // namespace

std::size_t drop_degenerate(PeriodicMesh& mesh)
{
    std::vector<bool> degenerate(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::uvec3& t = mesh.triangles[i];
        const auto same = [&](std::uint32_t a, std::uint32_t b) {
            return mesh.place[a] == mesh.place[b] && mesh.shift[a] == mesh.shift[b];
        };
        degenerate[i] = same(t.x, t.y) || same(t.y, t.z) || same(t.z, t.x);
    }
    return erase_marked(mesh.triangles, degenerate);
}

std::size_t drop_duplicates(PeriodicMesh& mesh)
{
    std::vector<std::pair<Key, std::uint32_t>> keys;
    keys.reserve(mesh.triangles.size());
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        keys.emplace_back(unordered_key(mesh, mesh.triangles[i]), i);
    }
    std::sort(keys.begin(), keys.end());
    std::vector<bool> dropped(mesh.triangles.size());
    std::vector<std::uint32_t> copies(mesh.triangles.size(), 1);
    bool any = false;
    for (std::size_t i = 1, kept = 0; i < keys.size(); ++i) {
        if (keys[i].first != keys[kept].first) {
            kept = i;
            continue;
        }
        dropped[keys[i].second] = true;
        copies[keys[kept].second] += 1;
        any = true;
    }
    if (!any) {
        return 0;
    }

    // Patches of the even ones: as a chain modulo two they are nothing, and the mesh may be better without them.
    const std::vector<Side> sides = sorted_sides(mesh);
    const auto even = [&](const Side& s) { return !dropped[s.triangle] && copies[s.triangle] % 2 == 0; };
    Groups patches(mesh.triangles.size());
    for_each_edge(sides, [&](std::span<const Side> edge) {
        if (std::all_of(edge.begin(), edge.end(), [&](const Side& s) { return even(s) || dropped[s.triangle]; })) {
            std::uint32_t first = ~0u;
            for (const Side& s : edge) {
                if (even(s)) {
                    first = first == ~0u ? s.triangle : first;
                    patches.join(first, s.triangle);
                }
            }
        }
    });
    std::vector<int> votes(mesh.triangles.size());  // of a patch: edges that close without it less those it closes
    for_each_edge(sides, [&](std::span<const Side> edge) {
        int others = 0;
        for (const Side& s : edge) {
            others += !dropped[s.triangle] && !even(s) ? 1 : 0;
        }
        for (const Side& s : edge) {
            if (even(s) && others > 0) {
                votes[patches.find(s.triangle)] += others % 2 == 0 ? 1 : -1;
            }
        }
    });
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        if (!dropped[i] && copies[i] % 2 == 0 && votes[patches.find(i)] > 0) {
            dropped[i] = true;
        }
    }
    return erase_marked(mesh.triangles, dropped);
}

Components make_coherent(PeriodicMesh& mesh)
{
    struct Neighbor {
        std::uint32_t triangle;
        bool turned;        // seen from here, it has the other side
        glm::ivec2 offset;  // of the neighbor, where this one's is zero
    };
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    constexpr std::uint32_t no_triangle = ~0u;
    std::vector<std::array<Neighbor, 3>> neighbors(count);
    for (auto& of_triangle : neighbors) {
        of_triangle.fill({no_triangle, false, glm::ivec2(0)});
    }
    for_each_edge(sorted_sides(mesh), [&](std::span<const Side> edge) {
        if (edge.size() != 2 || edge[0].triangle == edge[1].triangle) {
            return;
        }
        const auto low_shift = [&](const Side& s) {
            return mesh.shift[mesh.triangles[s.triangle][s.forward ? s.corner : (s.corner + 1) % 3]];
        };
        const bool turned = edge[0].forward == edge[1].forward;
        const glm::ivec2 offset = low_shift(edge[0]) - low_shift(edge[1]);
        neighbors[edge[0].triangle][edge[0].corner] = {edge[1].triangle, turned, offset};
        neighbors[edge[1].triangle][edge[1].corner] = {edge[0].triangle, turned, -offset};
    });

    Components components;
    components.of_triangle.assign(count, no_triangle);
    components.offset.assign(count, glm::ivec2(0));
    std::vector<bool> turned(count);
    for (std::uint32_t seed = 0; seed < count; ++seed) {
        if (components.of_triangle[seed] != no_triangle) {
            continue;
        }
        const auto component = static_cast<std::uint32_t>(components.triangles.size());
        std::vector<std::uint32_t> members{seed};
        components.of_triangle[seed] = component;
        bool wraps = false;
        double kept_area = 0.0;
        double turned_area = 0.0;
        for (std::size_t i = 0; i < members.size(); ++i) {
            const std::uint32_t t = members[i];
            (turned[t] ? turned_area : kept_area) += glm::length(area_vector(mesh, mesh.triangles[t]));
            for (const Neighbor& neighbor : neighbors[t]) {
                if (neighbor.triangle == no_triangle) {
                    continue;
                }
                const glm::ivec2 offset = components.offset[t] + neighbor.offset;
                if (components.of_triangle[neighbor.triangle] == no_triangle) {
                    components.of_triangle[neighbor.triangle] = component;
                    components.offset[neighbor.triangle] = offset;
                    turned[neighbor.triangle] = turned[t] != neighbor.turned;
                    members.push_back(neighbor.triangle);
                } else {
                    wraps = wraps || components.offset[neighbor.triangle] != offset;
                }
            }
        }
        const bool turn_kept = turned_area > kept_area;
        for (const std::uint32_t t : members) {
            if (turned[t] != turn_kept) {
                std::swap(mesh.triangles[t].y, mesh.triangles[t].z);
            }
        }
        components.triangles.push_back(std::move(members));
        components.wraps.push_back(wraps);
    }
    return components;
}

}  // namespace mesoshell
