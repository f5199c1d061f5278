// A triangle mesh modulo the periods of the tile: which vertices are one place, which edges are one edge.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

// Vertices closer than this, in tile widths, are one place.
constexpr double weld_distance = 1e-5;

// No vertex lies farther from the tile than this many periods sideways or tile widths in height, so that places fit the
// integers of columns.h.
constexpr double most_periods = 64.0;
constexpr double most_height = 1e4;

struct PeriodicMesh {
    float aspect = 1.0f;  // period along y; along x it is 1
    std::vector<glm::vec3> positions;  // moved onto their places, by less than weld_distance
    std::vector<glm::uvec3> triangles;
    std::vector<std::uint32_t> place;  // of every vertex: the first vertex at its place modulo the periods
    std::vector<glm::ivec2> shift;     // of every vertex: whole periods from that one to this one

    glm::vec3 period(const glm::ivec2& count) const
    {
        return glm::vec3(static_cast<float>(count.x), static_cast<float>(count.y) * aspect, 0.0f);
    }
};

PeriodicMesh weld(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles, float aspect);

// Places on open edges that lie closer than this, in tile widths, and than a quarter of the mean open edge are a crack.
constexpr double widest_crack = 1e-3;

// Makes one place of those on either side of a crack. Returns the number of places that are gone; their faces may be degenerate.
std::size_t close_cracks(PeriodicMesh& mesh);

// One side of one triangle. Sides with equal ends are one edge modulo the periods; edges that join the same places across
// different borders are different edges, and one may join a place to its own copy.
struct Side {
    std::uint32_t low = 0, high = 0;   // places
    std::int32_t across_x = 0, across_y = 0;  // whole periods from the one to the other, beyond their places
    std::uint32_t triangle = 0;
    std::uint8_t corner = 0;  // the side goes from this corner of the triangle to the next
    bool forward = false;     // from low to high

    bool same_edge(const Side& other) const
    {
        return low == other.low && high == other.high && across_x == other.across_x && across_y == other.across_y;
    }
};

// Every side of the triangles, those of one edge next to one another.
std::vector<Side> sorted_sides(const PeriodicMesh& mesh);

// Calls visit(first, last) for the sides of every edge.
template <typename Visit>
void for_each_edge(std::span<const Side> sides, const Visit& visit)
{
    for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
        for (end = begin + 1; end < sides.size() && sides[end].same_edge(sides[begin]); ++end) {
        }
        visit(sides.subspan(begin, end - begin));
    }
}

// How much more often the sides of an edge go forward than back: zero on every edge of a closed, oriented mesh.
inline int balance(std::span<const Side> sides)
{
    int sum = 0;
    for (const Side& side : sides) {
        sum += side.forward ? 1 : -1;
    }
    return sum;
}

// Edges that bound the mesh, taken as a chain: those out of balance.
std::size_t count_open_edges(const PeriodicMesh& mesh);

// Twice the area of a triangle, along its normal.
inline glm::dvec3 area_vector(const PeriodicMesh& mesh, const glm::uvec3& t)
{
    const glm::dvec3 a(mesh.positions[t.x]);
    return glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a);
}

}  // namespace mesoshell
