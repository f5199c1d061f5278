#include "cap_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "parallel.h"
#include "winding_number.h"

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

    std::size_t first_vertex() const { return first_; }  // from here on they are added
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

// The vertices that move, one a place, and what surrounds each.
class Movers {
public:
    Movers(PeriodicMesh& mesh, const std::vector<std::uint32_t>& cap_of, const Refinement& refinement)
        : mesh_(mesh), index_(mesh.positions.size(), none)
    {
        for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
            if (refinement.moves(v) && mesh.place[v] == v) {
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
    const Refinement refinement(mesh, their_cap);

    Movers movers(mesh, their_cap, refinement);
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
