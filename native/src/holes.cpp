#include "holes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "boundary.h"
#include "groups.h"
#include "loop_triangulation.h"
#include "repair.h"

namespace mesoshell {
namespace {

// Open parts whose closed volume is below this share of their area to the power 1.5 are sheets: they enclose nothing.
constexpr double least_volume = 0.002;
// Two rims lie against each other where they come closer than this share of their length.
constexpr double nearness = 0.05;

double length_of(const PeriodicMesh& mesh, const Loop& loop)
{
    double length = 0.0;
    for (std::size_t i = 1; i < loop.corners.size(); ++i) {
        const auto place = [&](const LoopCorner& c) { return mesh.positions[c.place] + mesh.period(c.shift); };
        length += glm::distance(place(loop.corners[i - 1]), place(loop.corners[i]));
    }
    return length;
}

// Adds a flat cap for every loop.
void span_loops(PeriodicMesh& mesh, Caps& caps, const std::vector<Loop>& loops)
{
    std::map<std::tuple<std::uint32_t, int, int>, std::uint32_t> vertices;
    for (std::uint32_t v = 0; v < mesh.positions.size() && !loops.empty(); ++v) {
        vertices.try_emplace({mesh.place[v], mesh.shift[v].x, mesh.shift[v].y}, v);
    }
    for (const Loop& loop : loops) {
        std::vector<std::uint32_t> corners;
        std::vector<glm::dvec3> places;
        for (const LoopCorner& c : loop.corners) {
            const auto [found, added] =
                vertices.try_emplace({c.place, c.shift.x, c.shift.y}, static_cast<std::uint32_t>(mesh.positions.size()));
            if (added) {
                mesh.positions.push_back(mesh.positions[c.place] + mesh.period(c.shift));
                mesh.place.push_back(c.place);
                mesh.shift.push_back(c.shift);
            }
            corners.push_back(found->second);
            places.emplace_back(mesh.positions[found->second]);
        }
        for (const auto& t : triangulate_loop(places)) {
            const glm::uvec3 triangle(corners[t[0]], corners[t[1]], corners[t[2]]);
            if (triangle.x != triangle.y && triangle.y != triangle.z && triangle.z != triangle.x) {
                mesh.triangles.push_back(triangle);
                caps.of_triangle.push_back(static_cast<std::uint32_t>(caps.count));
            }
        }
        caps.count += 1;
    }
}

// Marks the triangles of open parts that, together with their caps, enclose nothing.
std::vector<bool> mark_sheets(const PeriodicMesh& mesh, const std::vector<std::uint32_t>& cap_of, std::size_t caps)
{
    PeriodicMesh faces = mesh;
    faces.triangles.resize(static_cast<std::size_t>(std::count(cap_of.begin(), cap_of.end(), no_cap)));
    const Components components = make_coherent(faces);
    const auto group_of = [&](std::uint32_t t) {
        return cap_of[t] == no_cap ? static_cast<std::uint32_t>(caps) + components.of_triangle[t] : cap_of[t];
    };
    // Caps hang together with what is open where they begin.
    Groups groups(caps + components.triangles.size());
    for_each_edge(sorted_sides(mesh), [&](std::span<const Side> edge) {
        std::map<std::uint32_t, int> sums;
        for (const Side& s : edge) {
            sums[group_of(s.triangle)] += s.forward ? 1 : -1;
        }
        std::erase_if(sums, [](const auto& entry) { return entry.second == 0; });
        if (!sums.empty() && sums.begin()->first < caps) {
            for (const auto& [group, sum] : sums) {
                groups.join(sums.begin()->first, group);
            }
        }
    });
    struct Body {
        double area = 0.0, volume = 0.0, covered = 0.0, low = 1e30;
        bool open = false;
    };
    std::vector<Body> bodies(caps + components.triangles.size());
    for (std::uint32_t t = 0; t < cap_of.size(); ++t) {
        Body& body = bodies[groups.find(group_of(t))];
        body.low = std::min(body.low, static_cast<double>(mesh.positions[mesh.triangles[t].x].z));
    }
    for (std::uint32_t t = 0; t < cap_of.size(); ++t) {
        Body& body = bodies[groups.find(group_of(t))];
        const glm::uvec3& v = mesh.triangles[t];
        const glm::dvec3 area = 0.5 * area_vector(mesh, v);
        const double z = (double(mesh.positions[v.x].z) + mesh.positions[v.y].z + mesh.positions[v.z].z) / 3.0 - body.low;
        // Gauss: the integral of z n_z, which does not mind periods.
        body.volume += z * area.z;
        body.covered += area.z / mesh.aspect;
        body.area += cap_of[t] == no_cap ? glm::length(area) : 0.0;
        body.open = body.open || cap_of[t] != no_cap;
    }
    std::vector<bool> sheet(cap_of.size());
    for (std::uint32_t t = 0; t < cap_of.size(); ++t) {
        const Body& body = bodies[groups.find(group_of(t))];
        const bool encloses = std::abs(body.volume) > least_volume * std::pow(body.area, 1.5);
        sheet[t] = body.open && std::abs(body.covered) < 0.5 && !encloses;
    }
    return sheet;
}

}  // namespace

Caps span_holes(PeriodicMesh& mesh)
{
    std::vector<Loop> loops = boundary_loops(mesh);
    join_periodic_loops(mesh, loops);
    Caps caps;
    caps.of_triangle.assign(mesh.triangles.size(), no_cap);
    span_loops(mesh, caps, loops);
    return caps;
}

void join_caps(PeriodicMesh& mesh, Caps& caps, const std::vector<bool>& taken_out)
{
    PeriodicMesh open = mesh;
    Caps left = caps;
    std::size_t count = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::uvec3& corners = mesh.triangles[t];
        if (caps.of_triangle[t] == no_cap || !(taken_out[corners.x] || taken_out[corners.y] || taken_out[corners.z])) {
            open.triangles[count] = corners;
            left.of_triangle[count++] = caps.of_triangle[t];
        }
    }
    open.triangles.resize(count);
    left.of_triangle.resize(count);
    std::vector<Loop> loops = boundary_loops(open);
    join_periodic_loops(open, loops);
    std::vector<Loop> spanned;
    std::size_t pairs = 0;
    while (!loops.empty()) {
        Loop loop = std::move(loops.back());
        loops.pop_back();
        double least = nearness * length_of(open, loop);
        std::size_t partner = loops.size();
        for (std::size_t i = 0; i < loops.size(); ++i) {
            if (const double distance = distance_between(open, loop, loops[i]); distance < least) {
                least = distance;
                partner = i;
            }
        }
        if (partner < loops.size()) {
            loop = joined(open, loop, loops[partner]);
            loops.erase(loops.begin() + static_cast<std::ptrdiff_t>(partner));
            pairs += 1;
        }
        spanned.push_back(std::move(loop));
    }
    if (pairs > 0) {
        const std::size_t holes = caps.count;
        span_loops(open, left, spanned);
        left.count = holes;
        mesh = std::move(open);
        caps = std::move(left);
    }
}

std::size_t leave_out_sheets(PeriodicMesh& mesh, Caps& caps)
{
    if (caps.count == 0) {
        return 0;
    }
    const std::vector<bool> sheet = mark_sheets(mesh, caps.of_triangle, caps.count);
    std::vector<std::uint32_t> number(caps.count, no_cap);
    std::vector<std::uint32_t> of_triangle;
    std::vector<glm::uvec3> triangles;
    std::size_t left_out = 0;
    std::uint32_t kept = 0;
    for (std::size_t t = 0; t < sheet.size(); ++t) {
        const std::uint32_t cap = caps.of_triangle[t];
        if (sheet[t]) {
            left_out += cap == no_cap ? 1 : 0;
            continue;
        }
        if (cap != no_cap && number[cap] == no_cap) {
            number[cap] = kept++;
        }
        triangles.push_back(mesh.triangles[t]);
        of_triangle.push_back(cap == no_cap ? no_cap : number[cap]);
    }
    mesh.triangles = std::move(triangles);
    caps = {kept, std::move(of_triangle)};
    return left_out;
}

}  // namespace mesoshell
