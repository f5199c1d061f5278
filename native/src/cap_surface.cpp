#include "cap_surface.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "cap_refinement.h"
#include "parallel.h"
#include "winding_number.h"

namespace mesoshell {
namespace {

constexpr std::uint32_t none = ~0u;

// The vertices that move, one a place, and what surrounds each.
class Movers {
public:
    Movers(PeriodicMesh& mesh, const std::vector<std::uint32_t>& cap_of, const std::vector<bool>& moves)
        : mesh_(mesh), index_(mesh.positions.size(), none)
    {
        for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
            if (moves[v] && mesh.place[v] == v) {
                index_[v] = static_cast<std::uint32_t>(vertices_.size());
                vertices_.push_back(v);
            }
        }
        around_.resize(vertices_.size());
        std::map<std::uint32_t, double> areas;
        for (std::size_t i = 0; i < cap_of.size(); ++i) {
            const glm::uvec3& t = mesh.triangles[i];
            if (cap_of[i] == no_cap) {
                continue;
            }
            areas[cap_of[i]] += 0.5 * glm::length(area_vector(mesh, t));
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t mover = index_[mesh.place[t[k]]];
                if (mover != none) {
                    around_[mover].push_back({t[k], t[(k + 1) % 3], t[(k + 2) % 3]});
                }
            }
        }
        reach_.resize(vertices_.size());
        for (std::size_t i = 0; i < cap_of.size(); ++i) {
            for (int k = 0; k < 3 && cap_of[i] != no_cap; ++k) {
                const std::uint32_t mover = index_[mesh.place[mesh.triangles[i][k]]];
                if (mover != none) {
                    reach_[mover] = std::sqrt(areas[cap_of[i]]);
                }
            }
        }
        for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
            if (index_[mesh.place[v]] != none) {
                copies_.push_back(v);
            }
        }
    }

    std::size_t size() const { return vertices_.size(); }
    glm::dvec3 position(std::size_t i) const { return glm::dvec3(mesh_.positions[vertices_[i]]); }
    double reach(std::size_t i) const { return reach_[i]; }  // the size of its cap
    bool has(std::uint32_t vertex) const { return index_[mesh_.place[vertex]] != none; }
    std::size_t of(std::uint32_t vertex) const { return index_[mesh_.place[vertex]]; }

    glm::dvec3 normal(std::size_t i) const
    {
        glm::dvec3 sum(0.0);
        for (const Around& t : around_[i]) {
            const glm::dvec3 a(mesh_.positions[t.self]);
            sum += glm::cross(glm::dvec3(mesh_.positions[t.next]) - a, glm::dvec3(mesh_.positions[t.last]) - a);
        }
        const double length = glm::length(sum);
        return length > 0.0 ? sum / length : sum;
    }

    glm::dvec3 middle_of_neighbors(std::size_t i) const
    {
        glm::dvec3 sum(0.0);
        for (const Around& t : around_[i]) {
            const glm::dvec3 to_here(mesh_.positions[vertices_[i]] - mesh_.positions[t.self]);
            sum += glm::dvec3(mesh_.positions[t.next]) + glm::dvec3(mesh_.positions[t.last]) + 2.0 * to_here;
        }
        return around_[i].empty() ? position(i) : sum / (2.0 * static_cast<double>(around_[i].size()));
    }

    void place(const std::vector<glm::dvec3>& positions)
    {
        for (const std::uint32_t v : copies_) {
            mesh_.positions[v] =
                glm::vec3(positions[index_[mesh_.place[v]]] + glm::dvec3(mesh_.period(mesh_.shift[v])));
        }
    }

private:
    struct Around {
        std::uint32_t self, next, last;
    };

    PeriodicMesh& mesh_;
    std::vector<std::uint32_t> index_;  // of every place
    std::vector<std::uint32_t> vertices_;
    std::vector<std::uint32_t> copies_;  // all vertices at those places
    std::vector<std::vector<Around>> around_;
    std::vector<double> reach_;
};

struct Found {
    glm::dvec3 place;
    bool below = false;  // the number stayed below one half
};

// The place along a line where a winding number is one half, of either sign, or comes closest to it.
class LevelSearch {
public:
    LevelSearch(const WindingNumber& winding, double constant) : winding_(winding), constant_(constant) {}

    Found from(const glm::dvec3& start, const glm::dvec3& normal, double reach) const
    {
        const double here = winding_.at(start) + constant_;
        const double level = here < 0.0 ? -0.5 : 0.5;
        const double sign = here < 0.0 ? -1.0 : 1.0;
        const auto above = [&](double t) { return winding_.at(start + normal * t) + constant_ - level; };
        double last = here - level;
        // A wall between two solids stays where it is.
        if (std::abs(last) < level_tolerance || std::abs(last) > 0.75) {
            return {start};
        }
        const double side = last > 0.0 ? 1.0 : -1.0;
        double from = 0.0;
        for (const double step : {0.03, 0.08, 0.16, 0.28, 0.45, 0.7, 1.0}) {
            const double to = side * step * reach;
            const double next = above(to);
            if ((next > 0.0) != (last > 0.0)) {
                return {start + normal * root(above, from, last, to, next)};
            }
            if (std::abs(next) > std::abs(last)) {
                break;
            }
            from = to;
            last = next;
        }
        return {start + normal * from, last * sign < 0.0};
    }

private:
    // Regula falsi that halves the weight of an end that stays (Dowell and Jarratt 1971, "Illinois"), and bisection every
    // third time: at the mesh itself the number jumps.
    template <typename Above>
    static double root(const Above& above, double a, double at_a, double b, double at_b)
    {
        for (int i = 0; i < 12; ++i) {
            const double t = i % 3 == 2 ? 0.5 * (a + b) : (a * at_b - b * at_a) / (at_b - at_a);
            const double value = above(t);
            if (std::abs(value) < 0.1 * level_tolerance) {
                return t;
            }
            if ((value > 0.0) == (at_b > 0.0)) {
                b = t;
                at_b = value;
                at_a *= 0.5;
            } else {
                a = t;
                at_a = value;
                at_b *= 0.5;
            }
        }
        return 0.5 * (a + b);
    }

    const WindingNumber& winding_;
    double constant_;
};

}  // namespace

std::vector<bool> shape_caps(PeriodicMesh& mesh, Caps& caps, Job& job)
{
    std::vector<std::uint32_t>& cap_of = caps.of_triangle;
    std::vector<glm::uvec3> faces;
    double covered = 0.0;
    for (std::size_t t = 0; t < cap_of.size(); ++t) {
        covered += 0.5 * area_vector(mesh, mesh.triangles[t]).z / mesh.aspect;
        if (cap_of[t] == no_cap) {
            faces.push_back(mesh.triangles[t]);
        }
    }
    const WindingNumber winding(mesh, faces);
    const LevelSearch search(winding, 0.5 * std::round(covered));

    // Only caps and the faces around them take part.
    std::vector<bool> near(mesh.triangles.size(), false);
    for_each_edge(sorted_sides(mesh), [&](std::span<const Side> edge) {
        if (std::any_of(edge.begin(), edge.end(), [&](const Side& s) { return cap_of[s.triangle] != no_cap; })) {
            for (const Side& s : edge) {
                near[s.triangle] = true;
            }
        }
    });
    std::vector<glm::uvec3> rest;
    std::vector<glm::uvec3> taking_part;
    std::vector<std::uint32_t> their_cap;
    for (std::size_t t = 0; t < cap_of.size(); ++t) {
        if (near[t]) {
            taking_part.push_back(mesh.triangles[t]);
            their_cap.push_back(cap_of[t]);
        } else {
            rest.push_back(mesh.triangles[t]);
        }
    }
    mesh.triangles = std::move(taking_part);
    const std::vector<bool> moves = refine_caps(mesh, their_cap);
    Movers movers(mesh, their_cap, moves);
    std::vector<glm::dvec3> positions(movers.size());
    std::vector<std::uint8_t> below(movers.size(), 0);
    const auto smooth = [&](int rounds) {
        for (int round = 0; round < rounds; ++round) {
            for (std::size_t i = 0; i < positions.size(); ++i) {
                positions[i] = movers.middle_of_neighbors(i);
            }
            movers.place(positions);
        }
    };
    smooth(20);
    for (int round = 0; round < 3; ++round) {
        parallel_for(job, static_cast<int>(positions.size()), [&](int i) {
            const auto k = static_cast<std::size_t>(i);
            const Found found = search.from(movers.position(k), movers.normal(k), movers.reach(k));
            positions[k] = found.place;
            below[k] = found.below ? 1 : 0;
        }, 0.0f);
        movers.place(positions);
        if (round < 2) {
            smooth(1);
        }
    }
    rest.insert(rest.end(), mesh.triangles.begin(), mesh.triangles.end());
    cap_of.assign(rest.size() - their_cap.size(), no_cap);
    cap_of.insert(cap_of.end(), their_cap.begin(), their_cap.end());
    mesh.triangles = std::move(rest);
    std::vector<bool> below_at(mesh.positions.size(), false);
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
        below_at[v] = movers.has(v) && below[movers.of(v)] != 0;
    }
    return below_at;
}

}  // namespace mesoshell
