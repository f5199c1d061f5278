#include "boundary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <unordered_map>

namespace mesoshell {
namespace {

struct Edge {
    std::uint32_t from = 0, to = 0;  // places
    glm::ivec2 across{0};            // periods from the one to the other, beyond their places
};

std::vector<Edge> open_edges(const PeriodicMesh& mesh)
{
    std::vector<Edge> edges;
    for_each_edge(sorted_sides(mesh), [&](std::span<const Side> sides) {
        const int sum = balance(sides);
        const Side& s = sides.front();
        const glm::ivec2 across(s.across_x, s.across_y);
        for (int i = 0; i < std::abs(sum); ++i) {
            edges.push_back(sum > 0 ? Edge{s.high, s.low, -across} : Edge{s.low, s.high, across});
        }
    });
    return edges;
}

// Which edge goes on after which, at every place: the turn through the hole, which lies to the left, is the least.
class Pairing {
public:
    Pairing(const PeriodicMesh& mesh, const std::vector<Edge>& edges) : mesh_(mesh), edges_(edges), next_(edges.size())
    {
        struct Meeting {
            std::vector<std::uint32_t> in, out;
            glm::dvec3 normal{0.0};
        };
        std::unordered_map<std::uint32_t, Meeting> meetings;
        for (std::uint32_t i = 0; i < edges.size(); ++i) {
            meetings[edges[i].to].in.push_back(i);
            meetings[edges[i].from].out.push_back(i);
        }
        for (const glm::uvec3& t : mesh.triangles) {
            const glm::dvec3 area = area_vector(mesh, t);
            for (int i = 0; i < 3; ++i) {
                const auto found = meetings.find(mesh.place[t[i]]);
                if (found != meetings.end()) {
                    found->second.normal += area;
                }
            }
        }
        for (auto& [place, meeting] : meetings) {
            pair(meeting.in, meeting.out, meeting.normal);
        }
    }

    std::uint32_t next(std::uint32_t edge) const { return next_[edge]; }

private:
    void pair(const std::vector<std::uint32_t>& in, const std::vector<std::uint32_t>& out, const glm::dvec3& normal)
    {
        if (in.size() == 1) {
            next_[in[0]] = out[0];
            return;
        }
        glm::dvec3 u(0.0);
        u[std::abs(normal.x) < std::abs(normal.y) ? (std::abs(normal.x) < std::abs(normal.z) ? 0 : 2)
                                                  : (std::abs(normal.y) < std::abs(normal.z) ? 1 : 2)] = 1.0;
        u = glm::cross(u, normal);
        const glm::dvec3 v = glm::cross(normal, u) / std::max(glm::length(normal), 1e-300);
        const auto angle = [&](const glm::dvec3& d) { return std::atan2(glm::dot(d, v), glm::dot(d, u)); };
        std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> turns;
        for (const std::uint32_t i : in) {
            const double back = angle(-along(i));
            for (const std::uint32_t o : out) {
                double turn = back - angle(along(o));
                turn += turn <= 0.0 ? 2.0 * std::numbers::pi : 0.0;
                turns.emplace_back(turn, i, o);
            }
        }
        std::sort(turns.begin(), turns.end());
        constexpr std::uint32_t none = ~0u;
        for (const std::uint32_t i : in) {
            next_[i] = none;
        }
        std::vector<bool> taken(out.size(), false);
        for (const auto& [turn, i, o] : turns) {
            const auto slot = static_cast<std::size_t>(std::find(out.begin(), out.end(), o) - out.begin());
            if (next_[i] == none && !taken[slot]) {
                next_[i] = o;
                taken[slot] = true;
            }
        }
    }

    glm::dvec3 along(std::uint32_t edge) const
    {
        const Edge& e = edges_[edge];
        return glm::dvec3(mesh_.positions[e.to]) + glm::dvec3(mesh_.period(e.across)) - glm::dvec3(mesh_.positions[e.from]);
    }

    const PeriodicMesh& mesh_;
    const std::vector<Edge>& edges_;
    std::vector<std::uint32_t> next_;
};

struct Nearest {
    std::size_t a = 0, b = 0;  // corners
    glm::ivec2 shift{0};       // of the second loop, to lie beside the first
    double distance = std::numeric_limits<double>::max();
};

Nearest nearest_corners(const PeriodicMesh& mesh, const Loop& a, const Loop& b)
{
    // Long loops are asked at some of their corners.
    const auto stride = [](const Loop& loop) { return std::max<std::size_t>(1, loop.corners.size() / 512); };
    const auto place_of = [&](const LoopCorner& c) {
        return glm::dvec3(mesh.positions[c.place]) + glm::dvec3(mesh.period(c.shift));
    };
    Nearest nearest;
    for (std::size_t i = 0; i < a.corners.size(); i += stride(a)) {
        const glm::dvec3 p = place_of(a.corners[i]);
        for (std::size_t j = 0; j < b.corners.size(); j += stride(b)) {
            const glm::dvec3 offset = p - place_of(b.corners[j]);
            const glm::dvec2 periods(std::round(offset.x), std::round(offset.y / mesh.aspect));
            const double distance = glm::length(offset - glm::dvec3(periods.x, periods.y * mesh.aspect, 0.0));
            if (distance < nearest.distance) {
                nearest = {i, j, glm::ivec2(periods), distance};
            }
        }
    }
    return nearest;
}

// All corners from one on, around, up to that one again.
void append_turn(std::vector<LoopCorner>& corners, const Loop& loop, std::size_t first, const glm::ivec2& shift)
{
    for (std::size_t k = 0; k <= loop.corners.size(); ++k) {
        const std::size_t i = first + k;
        const bool around = i >= loop.corners.size();
        const LoopCorner& c = loop.corners[around ? i - loop.corners.size() : i];
        corners.push_back({c.place, c.shift + shift + (around ? loop.period : glm::ivec2(0))});
    }
}

}  // namespace

std::vector<Loop> boundary_loops(const PeriodicMesh& mesh)
{
    const std::vector<Edge> edges = open_edges(mesh);
    const Pairing pairing(mesh, edges);
    std::vector<bool> seen(edges.size(), false);
    std::vector<Loop> loops;
    for (std::uint32_t first = 0; first < edges.size(); ++first) {
        if (seen[first]) {
            continue;
        }
        Loop loop;
        for (std::uint32_t e = first; !seen[e]; e = pairing.next(e)) {
            seen[e] = true;
            loop.corners.push_back({edges[e].from, loop.period});
            loop.period += edges[e].across;
        }
        loops.push_back(std::move(loop));
    }
    return loops;
}

double distance_between(const PeriodicMesh& mesh, const Loop& a, const Loop& b)
{
    return nearest_corners(mesh, a, b).distance;
}

Loop joined(const PeriodicMesh& mesh, const Loop& a, const Loop& b)
{
    const Nearest nearest = nearest_corners(mesh, a, b);
    Loop loop;
    append_turn(loop.corners, a, nearest.a, glm::ivec2(0));
    append_turn(loop.corners, b, nearest.b, nearest.shift + a.period);
    loop.period = a.period + b.period;
    return loop;
}

void join_periodic_loops(const PeriodicMesh& mesh, std::vector<Loop>& loops)
{
    std::vector<Loop> periodic;
    std::vector<Loop> closed;
    for (Loop& loop : loops) {
        (loop.period == glm::ivec2(0) ? closed : periodic).push_back(std::move(loop));
    }
    // The periods of all boundaries of a mesh sum to zero, so that the last one finds a partner.
    while (periodic.size() > 1) {
        const Loop loop = std::move(periodic.back());
        periodic.pop_back();
        std::size_t partner = 0;
        double least = std::numeric_limits<double>::max();
        bool opposite = false;
        for (std::size_t i = 0; i < periodic.size(); ++i) {
            const bool cancels = periodic[i].period == -loop.period;
            if (cancels < opposite) {
                continue;
            }
            const double distance = distance_between(mesh, loop, periodic[i]);
            if (cancels > opposite || distance < least) {
                opposite = cancels;
                least = distance;
                partner = i;
            }
        }
        Loop both = joined(mesh, loop, periodic[partner]);
        periodic.erase(periodic.begin() + static_cast<std::ptrdiff_t>(partner));
        (both.period == glm::ivec2(0) ? closed : periodic).push_back(std::move(both));
    }
    loops = std::move(closed);
}

}  // namespace mesoshell
