#include "mesoshell/sample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <unordered_map>

#include "mesoshell/error.h"

namespace mesoshell {
namespace {

// Vertices closer than this, in tile widths, are one when the mesh is asked whether it closes.
constexpr double weld_distance = 1e-5;

// Gives every vertex the index of the first vertex at its place modulo the periods.
std::vector<std::uint32_t> weld_periodic(const std::vector<glm::vec3>& positions, double aspect)
{
    const glm::dvec2 period(1.0, aspect);
    const glm::i64vec2 cells(std::max(1.0, std::floor(period.x / weld_distance)),
                             std::max(1.0, std::floor(period.y / weld_distance)));
    const glm::dvec2 cell_size = period / glm::dvec2(cells);
    const auto wrapped = [&](const glm::vec3& p) {
        return glm::dvec3(p.x - std::floor(p.x / period.x) * period.x, p.y - std::floor(p.y / period.y) * period.y, p.z);
    };
    const auto key_of = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
        x = (x % cells.x + cells.x) % cells.x;
        y = (y % cells.y + cells.y) % cells.y;
        return static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15u ^ static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4Fu ^
               static_cast<std::uint64_t>(z) * 0x165667B19E3779F9u;
    };

    std::unordered_multimap<std::uint64_t, std::uint32_t> grid;
    grid.reserve(positions.size());
    std::vector<std::uint32_t> welded(positions.size());
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        const glm::dvec3 p = wrapped(positions[i]);
        const glm::i64vec3 cell(p.x / cell_size.x, p.y / cell_size.y, std::floor(p.z / weld_distance));
        std::uint32_t match = i;
        for (int neighbor = 0; neighbor < 27 && match == i; ++neighbor) {
            const auto range = grid.equal_range(
                key_of(cell.x + neighbor % 3 - 1, cell.y + neighbor / 3 % 3 - 1, cell.z + neighbor / 9 - 1));
            for (auto it = range.first; it != range.second; ++it) {
                glm::dvec3 offset = glm::abs(wrapped(positions[it->second]) - p);
                offset.x = std::min(offset.x, period.x - offset.x);
                offset.y = std::min(offset.y, period.y - offset.y);
                if (glm::length(offset) < weld_distance) {
                    match = it->second;
                    break;
                }
            }
        }
        welded[i] = match;
        if (match == i) {
            grid.emplace(key_of(cell.x, cell.y, cell.z), i);
        }
    }
    return welded;
}

// The part of a triangle on one side of a plane z = level: 0, 3 or 4 corners become up to 5 after two planes.
std::vector<glm::vec3> clip_polygon(const std::vector<glm::vec3>& polygon, float level, float sign)
{
    std::vector<glm::vec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::vec3& a = polygon[i];
        const glm::vec3& b = polygon[(i + 1) % polygon.size()];
        const float side_a = (a.z - level) * sign;
        const float side_b = (b.z - level) * sign;
        if (side_a >= 0.0f) {
            kept.push_back(a);
        }
        if (side_a * side_b < 0.0f) {
            glm::vec3 crossing = glm::mix(a, b, side_a / (side_a - side_b));
            crossing.z = level;
            kept.push_back(crossing);
        }
    }
    return kept;
}

}  // namespace

Sample::Sample(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles, float height, float aspect)
    : positions_(std::move(positions)), triangles_(std::move(triangles)), height_(height), aspect_(aspect)
{
    check_values();
    check_closed();
    clip_to_slab();
}

void Sample::check_values() const
{
    if (!(height_ > 0.0f) || !std::isfinite(height_)) {
        throw InvalidArgument("height is " + std::to_string(height_) + "; give the tile a positive height, in tile widths");
    }
    if (!(aspect_ > 0.0f) || !std::isfinite(aspect_)) {
        throw InvalidArgument("aspect is " + std::to_string(aspect_) + "; give the tile positive periods");
    }
    if (positions_.empty() || triangles_.empty()) {
        throw InvalidArgument("the tile is empty; give it a mesh with at least one triangle");
    }
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        const glm::vec3& p = positions_[i];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
            throw InvalidArgument("vertex " + std::to_string(i) +
                                  " of the tile is not finite; remove it or repair the modifier that makes it");
        }
    }
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
        const glm::uvec3& t = triangles_[i];
        if (std::max(t.x, std::max(t.y, t.z)) >= positions_.size()) {
            throw InvalidArgument("triangle " + std::to_string(i) + " of the tile uses vertex " +
                                  std::to_string(std::max(t.x, std::max(t.y, t.z))) + ", but there are only " +
                                  std::to_string(positions_.size()) + " vertices");
        }
    }
}

bool Sample::winds_outward() const
{
    double volume = 0.0;
    for (const glm::uvec3& t : triangles_) {
        volume += glm::dot(glm::dvec3(positions_[t.x]), glm::cross(glm::dvec3(positions_[t.y]), glm::dvec3(positions_[t.z])));
    }
    return oriented_ && volume > 0.0;
}

void Sample::check_closed()
{
    const std::vector<std::uint32_t> welded = weld_periodic(positions_, aspect_);
    // An edge modulo the periods: two welded vertices, and how many periods it spans beyond them. Edges that join the same
    // vertices across different borders are different edges, and one may join a vertex to its own copy.
    struct Edge {
        std::array<std::int64_t, 4> ends;
        bool forward;
        std::uint32_t from;
        std::uint32_t to;
    };
    const auto periods_from_welded = [&](std::uint32_t vertex) {
        const glm::dvec2 offset(positions_[vertex] - positions_[welded[vertex]]);
        return glm::i64vec2(std::llround(offset.x), std::llround(offset.y / aspect_));
    };
    std::vector<Edge> edges;
    edges.reserve(triangles_.size() * 3);
    for (const glm::uvec3& t : triangles_) {
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t from = t[i];
            const std::uint32_t to = t[(i + 1) % 3];
            const std::int64_t a = welded[from];
            const std::int64_t b = welded[to];
            const glm::i64vec2 span = periods_from_welded(to) - periods_from_welded(from);
            const std::array<std::int64_t, 4> there{a, b, span.x, span.y};
            const std::array<std::int64_t, 4> back{b, a, -span.x, -span.y};
            if (there != back) {  // else it has no length
                edges.push_back({std::min(there, back), there < back, from, to});
            }
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.ends < b.ends; });
    std::size_t open = 0;
    Edge first{};
    oriented_ = true;
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        int balance = 0;
        for (end = begin; end < edges.size() && edges[end].ends == edges[begin].ends; ++end) {
            balance += edges[end].forward ? 1 : -1;
        }
        if ((end - begin) % 2 != 0 && open++ == 0) {
            first = edges[begin];
        }
        oriented_ = oriented_ && balance == 0;
    }
    if (open > 0) {
        throw InvalidArgument("the tile's mesh is open at " + std::to_string(open) + " edges (one joins vertices " +
                              std::to_string(first.from) + " and " + std::to_string(first.to) +
                              "); close it, so that it has an inside");
    }
}

void Sample::clip_to_slab()
{
    for (const glm::uvec3& t : triangles_) {
        bool inside = true;
        for (int i = 0; i < 3; ++i) {
            const float z = positions_[t[i]].z;
            inside = inside && z >= 0.0f && z <= height_;
        }
        clipped_ += inside ? 0 : 1;
    }
    if (clipped_ == 0) {
        return;
    }
    slab_positions_ = positions_;
    for (const glm::uvec3& t : triangles_) {
        std::vector<glm::vec3> polygon{positions_[t.x], positions_[t.y], positions_[t.z]};
        polygon = clip_polygon(clip_polygon(polygon, 0.0f, 1.0f), height_, -1.0f);
        const auto first = static_cast<std::uint32_t>(slab_positions_.size());
        slab_positions_.insert(slab_positions_.end(), polygon.begin(), polygon.end());
        for (std::uint32_t i = 2; i < polygon.size(); ++i) {
            slab_triangles_.emplace_back(first, first + i - 1, first + i);
        }
    }
    if (slab_triangles_.empty()) {
        throw InvalidArgument("the tile has no geometry between w = 0 and its height; move it into the tile box or raise the "
                              "height");
    }
}

}  // namespace mesoshell
