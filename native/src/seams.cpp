#include "mesoshell/seams.h"

#include <algorithm>
#include <tuple>

namespace mesoshell {
namespace {

// One edge of one prism, from its lesser vertex to its greater.
struct HalfEdge {
    std::uint32_t low;
    std::uint32_t high;
    std::uint32_t prism;
    std::uint8_t low_corner;
    std::uint8_t high_corner;
};

bool whole_tiles_apart(const glm::vec2& a, const glm::vec2& b, glm::vec2& tiles)
{
    const glm::vec2 difference = b - a;
    tiles = glm::round(difference);
    const glm::vec2 rest = glm::abs(difference - tiles);
    return rest.x <= seam_tolerance && rest.y <= seam_tolerance;
}

double signed_area(const std::vector<glm::vec2>& uvs, const glm::uvec3& t)
{
    const glm::dvec2 a(uvs[t.x]);
    const glm::dvec2 e1 = glm::dvec2(uvs[t.y]) - a;
    const glm::dvec2 e2 = glm::dvec2(uvs[t.z]) - a;
    return e1.x * e2.y - e1.y * e2.x;
}

bool continues(const std::vector<glm::vec2>& uvs, const glm::uvec3& here, const glm::uvec3& there, const SharedEdge& edge)
{
    if (here[edge.ends[0]] == there[edge.other_ends[0]] && here[edge.ends[1]] == there[edge.other_ends[1]]) {
        return true;
    }
    glm::vec2 first;
    glm::vec2 second;
    return whole_tiles_apart(uvs[here[edge.ends[0]]], uvs[there[edge.other_ends[0]]], first) &&
           whole_tiles_apart(uvs[here[edge.ends[1]]], uvs[there[edge.other_ends[1]]], second) && first == second;
}

}  // namespace

std::vector<SharedEdge> shared_edges(const ShellTopology& topology)
{
    std::vector<HalfEdge> halves;
    halves.reserve(3 * topology.triangles.size());
    for (std::uint32_t p = 0; p < topology.triangles.size(); ++p) {
        const glm::uvec3& t = topology.triangles[p];
        for (std::uint8_t i = 0; i < 3; ++i) {
            const std::uint8_t j = static_cast<std::uint8_t>((i + 1) % 3);
            const bool rising = t[i] < t[j];
            halves.push_back({std::min(t[i], t[j]), std::max(t[i], t[j]), p, rising ? i : j, rising ? j : i});
        }
    }
    std::sort(halves.begin(), halves.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::tie(a.low, a.high, a.prism) < std::tie(b.low, b.high, b.prism);
    });
    std::vector<SharedEdge> edges;
    for (std::size_t first = 0, i = 0; i < halves.size(); ++i) {
        const HalfEdge& a = halves[first];
        const HalfEdge& b = halves[i];
        if (a.low != b.low || a.high != b.high) {
            first = i;
        } else if (i != first) {
            edges.push_back({a.prism, b.prism, {a.low_corner, a.high_corner}, {b.low_corner, b.high_corner}});
        }
    }
    return edges;
}

bool pattern_continues(const Shell& shell, const SharedEdge& edge)
{
    const ShellTopology& topology = *shell.topology;
    const glm::uvec3& here = topology.uv_triangles[edge.prism];
    const glm::uvec3& there = topology.uv_triangles[edge.other];
    // Across an edge that both prisms walk the same way (a face turned over), alike means opposite.
    const bool turned = (edge.ends[1] + 3 - edge.ends[0]) % 3 == (edge.other_ends[1] + 3 - edge.other_ends[0]) % 3;
    const double winding = signed_area(topology.uvs, here) * signed_area(topology.uvs, there);
    if (turned ? winding > 0.0 : winding < 0.0) {
        return false;
    }
    return continues(topology.uvs, here, there, edge) &&
           (shell.top_uvs.empty() || continues(shell.top_uvs, here, there, edge));
}

Seams find_seams(const Shell& shell)
{
    Seams seams;
    for (const SharedEdge& edge : shared_edges(*shell.topology)) {
        if (!pattern_continues(shell, edge)) {
            const glm::uvec3& t = shell.topology->triangles[edge.prism];
            seams.edges.push_back({shell.base(t[edge.ends[0]]), shell.base(t[edge.ends[1]])});
            seams.tops.push_back({shell.top(t[edge.ends[0]]), shell.top(t[edge.ends[1]])});
        }
    }
    return seams;
}

}  // namespace mesoshell
