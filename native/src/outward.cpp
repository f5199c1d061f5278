// Which components of a repaired mesh are inside out (repair.h, turn_outward).
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "columns.h"
#include "repair.h"

namespace mesoshell {
namespace {

// A volume below this share of the area to the power 1.5 is none (a ball has 0.094): the component is a sheet.
constexpr double least_volume = 0.002;

struct Shape {
    double area = 0.0;
    double volume = 0.0;   // enclosed, positive where the outside is out
    double covered = 0.0;  // area seen from above less that seen from below, in tiles
    double height = 0.0;   // mean z

    bool has_volume() const { return std::abs(volume) > least_volume * std::pow(area, 1.5); }
    bool covers_tile() const { return std::abs(covered) > 0.5; }
};

Shape measure(const PeriodicMesh& mesh, const Components& components, std::size_t component)
{
    const std::vector<std::uint32_t>& triangles = components.triangles[component];
    const auto corner = [&](std::uint32_t t, int i) {
        return glm::dvec3(mesh.positions[mesh.triangles[t][i]]) + glm::dvec3(mesh.period(components.offset[t]));
    };
    const glm::dvec3 middle = corner(triangles.front(), 0);
    Shape shape;
    for (const std::uint32_t t : triangles) {
        const glm::dvec3 area = area_vector(mesh, mesh.triangles[t]) * 0.5;
        const glm::dvec3 center = (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0 - middle;
        shape.area += glm::length(area);
        shape.covered += area.z / mesh.aspect;
        shape.height += center.z * glm::length(area);
        // Gauss: the integral of x . n / 3 over a closed surface, or of z n_z, which does not mind that it wraps.
        shape.volume += components.wraps[component] ? center.z * area.z : glm::dot(center, area) / 3.0;
    }
    shape.height = middle.z + shape.height / std::max(shape.area, 1e-30);
    return shape;
}

// Components that close one another where more than two faces meet are one body: turning one of them would open it.
Components bodies_of(const PeriodicMesh& mesh, const Components& components)
{
    struct Link {
        std::uint32_t to;
        glm::ivec2 offset;  // of the other, where this one's is zero
    };
    const std::size_t count = components.triangles.size();
    std::vector<std::vector<Link>> links(count);
    for_each_edge(sorted_sides(mesh), [&](std::span<const Side> edge) {
        if (edge.size() == 2 || balance(edge) != 0) {
            return;
        }
        std::map<std::uint32_t, std::pair<int, const Side*>> of_component;
        for (const Side& s : edge) {
            auto& [sum, side] = of_component[components.of_triangle[s.triangle]];
            sum += s.forward ? 1 : -1;
            side = &s;
        }
        const auto place_of = [&](const Side& s) {
            const std::uint32_t low = mesh.triangles[s.triangle][s.forward ? s.corner : (s.corner + 1) % 3];
            return mesh.shift[low] + components.offset[s.triangle];
        };
        const std::pair<const std::uint32_t, std::pair<int, const Side*>>* last = nullptr;
        for (const auto& entry : of_component) {
            if (entry.second.first == 0) {
                continue;
            }
            if (last != nullptr) {
                const glm::ivec2 offset = place_of(*last->second.second) - place_of(*entry.second.second);
                links[last->first].push_back({entry.first, offset});
                links[entry.first].push_back({last->first, -offset});
            }
            last = &entry;
        }
    });

    Components bodies;
    bodies.of_triangle = components.of_triangle;
    bodies.offset = components.offset;
    std::vector<glm::ivec2> offset(count, glm::ivec2(0));
    std::vector<bool> seen(count, false);
    for (std::uint32_t seed = 0; seed < count; ++seed) {
        if (seen[seed]) {
            continue;
        }
        std::vector<std::uint32_t> members{seed};
        seen[seed] = true;
        std::vector<std::uint32_t> triangles;
        bool wraps = false;
        for (std::size_t i = 0; i < members.size(); ++i) {
            const std::uint32_t member = members[i];
            wraps = wraps || components.wraps[member];
            for (const std::uint32_t t : components.triangles[member]) {
                bodies.of_triangle[t] = static_cast<std::uint32_t>(bodies.triangles.size());
                bodies.offset[t] += offset[member];
                triangles.push_back(t);
            }
            for (const Link& link : links[member]) {
                if (!seen[link.to]) {
                    seen[link.to] = true;
                    offset[link.to] = offset[member] + link.offset;
                    members.push_back(link.to);
                } else {
                    wraps = wraps || offset[link.to] != offset[member] + link.offset;
                }
            }
        }
        bodies.triangles.push_back(std::move(triangles));
        bodies.wraps.push_back(wraps);
    }
    return bodies;
}

class Turner {
public:
    Turner(PeriodicMesh& mesh, Components components)
        : mesh_(mesh), columns_(mesh), components_(std::move(components)), turned_(components_.triangles.size(), false)
    {
        for (std::size_t i = 0; i < components_.triangles.size(); ++i) {
            shapes_.push_back(measure(mesh, components_, i));
        }
    }

    void run()
    {
        turn_covering_sheets();
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < shapes_.size(); ++i) {
            if (is_solid(i)) {
                order.push_back(i);
            }
        }
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return std::abs(shapes_[a].volume) > std::abs(shapes_[b].volume);
        });
        for (std::size_t k = 0; k < order.size(); ++k) {
            const std::size_t i = order[k];
            if ((shapes_[i].volume < 0.0) != turned_[i] && !lies_in_others(i)) {
                turn(i);
                for (std::size_t m = k + 1; m < order.size(); ++m) {
                    if (lies_in(order[m], i)) {
                        turn(order[m]);
                    }
                }
            }
        }
        for (std::size_t i = 0; i < turned_.size(); ++i) {
            if (turned_[i]) {
                for (const std::uint32_t t : components_.triangles[i]) {
                    std::swap(mesh_.triangles[t].y, mesh_.triangles[t].z);
                }
            }
        }
    }

private:
    bool is_sheet(std::size_t i) const
    {
        const Shape& s = shapes_[i];
        return s.covers_tile() && (components_.wraps[i] || !s.has_volume());
    }
    bool is_solid(std::size_t i) const { return !is_sheet(i) && shapes_[i].has_volume(); }

    void turn(std::size_t i) { turned_[i] = !turned_[i]; }

    // From the top down, sheets that cover the tile should lead in before they lead out.
    void turn_covering_sheets()
    {
        std::vector<std::size_t> sheets;
        for (std::size_t i = 0; i < shapes_.size(); ++i) {
            if (is_sheet(i)) {
                sheets.push_back(i);
            }
        }
        std::stable_sort(sheets.begin(), sheets.end(),
                         [&](std::size_t a, std::size_t b) { return shapes_[a].height > shapes_[b].height; });
        long winding = 0;
        long most = 0;
        long least = 0;
        for (const std::size_t i : sheets) {
            winding += std::lround(shapes_[i].covered);
            most = std::max(most, winding);
            least = std::min(least, winding);
        }
        if (least >= 0 || most > 0) {
            return;
        }
        for (std::size_t i = 0; i < shapes_.size(); ++i) {
            const bool is_one = is_sheet(i);
            const bool within = !is_one && std::any_of(sheets.begin(), sheets.end(), [&](std::size_t s) { return lies_in(i, s); });
            if (is_one || within) {
                turn(i);
            }
        }
    }

    // The winding number that component `around` gives to three places of component `i`, as most of them have it.
    bool lies_in(std::size_t i, std::size_t around) const
    {
        int votes = 0;
        for (const glm::dvec3& p : places(i)) {
            votes += winding_at(p, around) != 0 ? 1 : 0;
        }
        return votes >= 2;
    }

    bool lies_in_others(std::size_t i) const
    {
        int votes = 0;
        for (const glm::dvec3& p : places(i)) {
            int winding = 0;
            for (std::size_t other = 0; other < shapes_.size(); ++other) {
                winding += other != i ? winding_at(p, other) : 0;
            }
            votes += winding > 0 ? 1 : 0;
        }
        return votes >= 2;
    }

    int winding_at(const glm::dvec3& p, std::size_t component) const
    {
        int winding = 0;
        for (const Crossing& crossing : columns_.along(p, components_.triangles[component])) {
            winding += crossing.z > p.z ? crossing.sign : 0;
        }
        return turned_[component] ? -winding : winding;
    }

    std::array<glm::dvec3, 3> places(std::size_t i) const
    {
        const std::vector<std::uint32_t>& triangles = components_.triangles[i];
        std::array<glm::dvec3, 3> centers;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::uvec3& t = mesh_.triangles[triangles[triangles.size() * k / 3]];
            centers[k] = (glm::dvec3(mesh_.positions[t.x]) * 0.41 + glm::dvec3(mesh_.positions[t.y]) * 0.33 +
                          glm::dvec3(mesh_.positions[t.z]) * 0.26);
        }
        return centers;
    }

    PeriodicMesh& mesh_;
    Columns columns_;
    Components components_;
    std::vector<Shape> shapes_;
    std::vector<bool> turned_;
};

}  // namespace

void turn_outward(PeriodicMesh& mesh, const Components& components)
{
    Turner(mesh, bodies_of(mesh, components)).run();
}

}  // namespace mesoshell
