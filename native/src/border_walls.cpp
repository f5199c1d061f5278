#include "border_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "boundary.h"
#include "loop_triangulation.h"

namespace mesoshell {
namespace {

struct OpenEdge {
    std::uint32_t low = 0, high = 0;  // vertices, by their places seen from above
    glm::ivec2 shift{0};              // of the low end's place seen from above
    double height = 0.0;
};

class Walls {
public:
    explicit Walls(PeriodicMesh& mesh) : mesh_(mesh), index_(mesh.positions.size(), ~0u) {}

    std::size_t add()
    {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> open;  // vertices, in the direction of the face
        std::vector<glm::vec3> flat;
        for_each_edge(sorted_sides(mesh_), [&](std::span<const Side> sides) {
            const int sum = balance(sides);
            if (std::abs(sum) != 1) {
                return;
            }
            const auto of_rim = [&](const Side& side) { return side.forward == (sum > 0); };
            const Side& s = *std::find_if(sides.begin(), sides.end(), of_rim);
            const glm::uvec3& t = mesh_.triangles[s.triangle];
            open.emplace_back(t[s.corner], t[(s.corner + 1) % 3]);
            for (const std::uint32_t place : {s.low, s.high}) {
                if (index_[place] == ~0u) {
                    index_[place] = static_cast<std::uint32_t>(flat.size());
                    flat.emplace_back(mesh_.positions[place].x, mesh_.positions[place].y, 0.0f);
                }
            }
        });
        flat_ = weld(std::move(flat), {}, mesh_.aspect);

        using Key = std::tuple<std::uint32_t, std::uint32_t, int, int>;
        std::map<Key, std::array<std::vector<OpenEdge>, 2>> edges;  // those forward, those back
        for (const auto& [from, to] : open) {
            const glm::ivec2 across = shift_of(to) - shift_of(from);
            const Key forward{place_of(from), place_of(to), across.x, across.y};
            const Key back{place_of(to), place_of(from), -across.x, -across.y};
            if (forward == back) {
                continue;  // seen from above it has no length
            }
            const double height = mesh_.positions[from].z + mesh_.positions[to].z;
            if (forward < back) {
                edges[forward][0].push_back({from, to, shift_of(from), height});
            } else {
                edges[back][1].push_back({to, from, shift_of(to), height});
            }
        }
        std::size_t count = 0;
        for (auto& [key, sides] : edges) {
            for (std::vector<OpenEdge>& side : sides) {
                std::stable_sort(side.begin(), side.end(),
                                 [](const OpenEdge& a, const OpenEdge& b) { return a.height < b.height; });
            }
            for (std::size_t i = 0; i < std::min(sides[0].size(), sides[1].size()); ++i) {
                if (sides[0][i].shift != sides[1][i].shift) {
                    add_wall(sides[0][i], sides[1][i]);
                    count += 1;
                }
            }
        }
        return count;
    }

    // At the corners of walls, what is open lies on a vertical line.
    void close_lines()
    {
        for (const Loop& loop : boundary_loops(mesh_)) {
            std::vector<std::uint32_t> corners;
            std::vector<glm::dvec3> places;
            for (const LoopCorner& c : loop.corners) {
                corners.push_back(vertex(c.place, c.shift));
                places.emplace_back(mesh_.positions[corners.back()]);
            }
            const bool vertical = std::all_of(places.begin(), places.end(), [&](const glm::dvec3& p) {
                return glm::length(glm::dvec2(p - places.front())) < 4.0 * weld_distance;
            });
            if (vertical && loop.period == glm::ivec2(0)) {
                for (const auto& t : triangulate_loop(places)) {
                    add_triangle(corners[t[0]], corners[t[1]], corners[t[2]]);
                }
            }
        }
    }

private:
    std::uint32_t place_of(std::uint32_t v) const { return flat_.place[index_[mesh_.place[v]]]; }
    glm::ivec2 shift_of(std::uint32_t v) const { return mesh_.shift[v] + flat_.shift[index_[mesh_.place[v]]]; }

    std::uint32_t vertex(std::uint32_t place, const glm::ivec2& shift)
    {
        const auto [found, added] =
            copies_.try_emplace({place, shift.x, shift.y}, static_cast<std::uint32_t>(mesh_.positions.size()));
        if (added) {
            mesh_.positions.push_back(mesh_.positions[place] + mesh_.period(shift));
            mesh_.place.push_back(place);
            mesh_.shift.push_back(shift);
        }
        return found->second;
    }

    void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c)
    {
        if (a != b && b != c && c != a) {
            mesh_.triangles.emplace_back(a, b, c);
        }
    }

    void add_wall(const OpenEdge& forward, const OpenEdge& back)
    {
        const glm::ivec2 shift = forward.shift - back.shift;
        const auto here = [&](std::uint32_t v, const glm::ivec2& by) { return vertex(mesh_.place[v], mesh_.shift[v] + by); };
        const std::uint32_t a = here(forward.low, glm::ivec2(0));
        const std::uint32_t b = here(forward.high, glm::ivec2(0));
        const std::uint32_t other_a = here(back.low, shift);
        const std::uint32_t other_b = here(back.high, shift);
        add_triangle(b, a, other_a);
        add_triangle(b, other_a, other_b);
    }

    PeriodicMesh& mesh_;
    PeriodicMesh flat_;                 // what is open, seen from above
    std::vector<std::uint32_t> index_;  // of a place, in flat_
    std::map<std::tuple<std::uint32_t, int, int>, std::uint32_t> copies_;
};

}  // namespace

std::size_t add_border_walls(PeriodicMesh& mesh)
{
    Walls walls(mesh);
    const std::size_t count = walls.add();
    if (count > 0) {
        walls.close_lines();
    }
    return count;
}

}  // namespace mesoshell
