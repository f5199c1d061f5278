#include "cap_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace mesoshell {
namespace {

constexpr double finest_edge = 0.015;         // tile widths: about a voxel
constexpr double edges_across = 6.0;          // at least so many fit across a cap that is not finer than that
constexpr double edges_of_rim = 0.75;         // the mean edge around a cap, as a cap's own edges may be long
constexpr double largest_count = 800.0;       // of squares of an edge's length in a cap
constexpr std::size_t most_vertices = 40000;  // that splitting may add
constexpr std::uint32_t none = ~0u;

double length_of(const PeriodicMesh& mesh, const Side& s)
{
    const glm::uvec3& t = mesh.triangles[s.triangle];
    return glm::length(glm::dvec3(mesh.positions[t[(s.corner + 1) % 3]]) - glm::dvec3(mesh.positions[t[s.corner]]));
}

// Edge lengths that each cap wants.
std::vector<double> wanted_lengths(const PeriodicMesh& mesh, const std::vector<std::uint32_t>& cap_of)
{
    std::uint32_t caps = 0;
    for (const std::uint32_t cap : cap_of) {
        caps = cap == no_cap ? caps : std::max(caps, cap + 1);
    }
    std::vector<double> area(caps, 0.0);
    std::vector<double> rim(caps, 0.0);
    std::vector<double> rim_edges(caps, 0.0);
    for (std::size_t t = 0; t < cap_of.size(); ++t) {
        if (cap_of[t] != no_cap) {
            area[cap_of[t]] += 0.5 * glm::length(area_vector(mesh, mesh.triangles[t]));
        }
    }
    for_each_edge(sorted_sides(mesh), [&](std::span<const Side> edge) {
        if (std::any_of(edge.begin(), edge.end(), [&](const Side& s) { return cap_of[s.triangle] == no_cap; })) {
            for (const Side& s : edge) {
                if (cap_of[s.triangle] != no_cap) {
                    rim[cap_of[s.triangle]] += length_of(mesh, s);
                    rim_edges[cap_of[s.triangle]] += 1.0;
                }
            }
        }
    });
    std::vector<double> wanted(caps);
    for (std::uint32_t i = 0; i < caps; ++i) {
        const double across = std::sqrt(area[i]);
        const double like_rim = edges_of_rim * rim[i] / std::max(rim_edges[i], 1.0);
        wanted[i] = std::max({std::min(like_rim, across / edges_across), finest_edge, across / std::sqrt(largest_count)});
    }
    return wanted;
}

class Refinement {
public:
    Refinement(PeriodicMesh& mesh, std::vector<std::uint32_t>& cap_of)
        : mesh_(mesh), cap_of_(cap_of), wanted_(wanted_lengths(mesh, cap_of)), first_(mesh.positions.size())
    {
        for (int round = 0; round < 12 && mesh_.positions.size() < first_ + most_vertices && split_long_edges(); ++round) {
        }
        split_single_triangles();
    }

    bool moves(std::uint32_t vertex) const { return vertex >= first_ && moves_[mesh_.place[vertex] - first_]; }

private:
    std::uint32_t add(const glm::vec3& position, bool moves)
    {
        const auto vertex = static_cast<std::uint32_t>(mesh_.positions.size());
        mesh_.positions.push_back(position);
        mesh_.place.push_back(vertex);
        mesh_.shift.emplace_back(0);
        moves_.push_back(moves);
        return vertex;
    }

    std::uint32_t add_copy(std::uint32_t of, const glm::ivec2& shift)
    {
        const std::uint32_t vertex = add(mesh_.positions[of] + mesh_.period(shift), moves_[of - first_]);
        mesh_.place[vertex] = of;
        mesh_.shift[vertex] = shift;
        return vertex;
    }

    bool split_long_edges()
    {
        std::vector<std::array<std::uint32_t, 3>> middles(mesh_.triangles.size(), {none, none, none});
        bool any = false;
        for_each_edge(sorted_sides(mesh_), [&](std::span<const Side> edge) {
            double wanted = 0.0;
            bool rim = false;
            for (const Side& s : edge) {
                const std::uint32_t cap = cap_of_[s.triangle];
                rim = rim || cap == no_cap;
                wanted = cap == no_cap ? wanted : std::max(wanted, wanted_[cap]);
            }
            // Out of balance: another face there is not among these triangles.
            if (wanted == 0.0 || balance(edge) != 0 || length_of(mesh_, edge.front()) <= wanted * (rim ? 2.0 : 1.0)) {
                return;
            }
            any = true;
            const auto low_shift = [&](const Side& s) {
                return mesh_.shift[mesh_.triangles[s.triangle][s.forward ? s.corner : (s.corner + 1) % 3]];
            };
            const Side& base = edge.front();
            const glm::uvec3& t = mesh_.triangles[base.triangle];
            const std::uint32_t middle =
                add((mesh_.positions[t[base.corner]] + mesh_.positions[t[(base.corner + 1) % 3]]) * 0.5f, !rim);
            std::map<std::pair<int, int>, std::uint32_t> copies{{{0, 0}, middle}};
            for (const Side& s : edge) {
                const glm::ivec2 shift = low_shift(s) - low_shift(base);
                const auto [found, added] = copies.try_emplace({shift.x, shift.y}, none);
                if (added) {
                    found->second = add_copy(middle, shift);
                }
                middles[s.triangle][s.corner] = found->second;
            }
        });
        if (any) {
            subdivide(middles);
        }
        return any;
    }

    void subdivide(const std::vector<std::array<std::uint32_t, 3>>& middles)
    {
        std::vector<glm::uvec3> triangles;
        std::vector<std::uint32_t> cap_of;
        for (std::size_t i = 0; i < middles.size(); ++i) {
            const auto emit = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                triangles.emplace_back(a, b, c);
                cap_of.push_back(cap_of_[i]);
            };
            const auto& m = middles[i];
            const auto count = 3 - std::count(m.begin(), m.end(), none);
            glm::uvec3 t = mesh_.triangles[i];
            if (count == 0) {
                emit(t.x, t.y, t.z);
                continue;
            }
            if (count == 3) {
                emit(t.x, m[0], m[2]);
                emit(m[0], t.y, m[1]);
                emit(m[2], m[1], t.z);
                emit(m[0], m[1], m[2]);
                continue;
            }
            // Turned so that the first side is split, and of two sides both the first.
            std::size_t turn = 0;
            while (m[turn] == none || (count == 2 && m[(turn + 1) % 3] == none)) {
                ++turn;
            }
            const auto corner = [&](std::size_t k) { return t[static_cast<int>((turn + k) % 3)]; };
            const std::uint32_t a = m[turn];
            const std::uint32_t b = m[(turn + 1) % 3];
            if (count == 1) {
                emit(corner(0), a, corner(2));
                emit(a, corner(1), corner(2));
                continue;
            }
            emit(a, corner(1), b);
            const auto distance = [&](std::uint32_t v, std::uint32_t w) {
                return glm::distance(mesh_.positions[v], mesh_.positions[w]);
            };
            if (distance(corner(0), b) < distance(a, corner(2))) {
                emit(corner(0), a, b);
                emit(corner(0), b, corner(2));
            } else {
                emit(corner(0), a, corner(2));
                emit(a, b, corner(2));
            }
        }
        mesh_.triangles = std::move(triangles);
        cap_of_ = std::move(cap_of);
    }

    // A hole of one missing triangle has no edge of its own to split.
    void split_single_triangles()
    {
        std::map<std::uint32_t, std::size_t> sizes;
        for (const std::uint32_t cap : cap_of_) {
            sizes[cap] += 1;
        }
        for (std::size_t i = 0, count = mesh_.triangles.size(); i < count; ++i) {
            const glm::uvec3 t = mesh_.triangles[i];
            if (cap_of_[i] == no_cap || sizes[cap_of_[i]] != 1 ||
                glm::length(area_vector(mesh_, t)) < finest_edge * finest_edge) {
                continue;
            }
            const glm::vec3 sum = mesh_.positions[t.x] + mesh_.positions[t.y] + mesh_.positions[t.z];
            const std::uint32_t middle = add(sum / 3.0f, true);
            mesh_.triangles[i] = {t.x, t.y, middle};
            mesh_.triangles.emplace_back(t.y, t.z, middle);
            mesh_.triangles.emplace_back(t.z, t.x, middle);
            cap_of_.insert(cap_of_.end(), 2, cap_of_[i]);
        }
    }

    PeriodicMesh& mesh_;
    std::vector<std::uint32_t>& cap_of_;
    std::vector<double> wanted_;
    std::size_t first_;
    std::vector<bool> moves_;  // of every added vertex that is the first at its place
};

}  // namespace

std::vector<bool> refine_caps(PeriodicMesh& mesh, std::vector<std::uint32_t>& cap_of)
{
    const Refinement refinement(mesh, cap_of);
    std::vector<bool> moves(mesh.positions.size());
    for (std::uint32_t v = 0; v < moves.size(); ++v) {
        moves[v] = refinement.moves(v);
    }
    return moves;
}

}  // namespace mesoshell
