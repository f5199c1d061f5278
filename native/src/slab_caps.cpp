#include "slab_caps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "flat_fill.h"
#include "plane_side.h"

namespace mesoshell {
namespace {

// Where the tile is cut open: the golden ratio's and another ratio's rest, odd in the last place.
constexpr glm::i64vec2 opening(6408311, 4637023);

bool in_order(const glm::i64vec2& a, const glm::i64vec2& b)
{
    return std::pair(a.x, a.y) < std::pair(b.x, b.y);
}

// Points by their coordinates.
class Points {
public:
    std::uint32_t find_or_add(const glm::i64vec2& p)
    {
        const auto [found, added] = index_.try_emplace({p.x, p.y}, static_cast<std::uint32_t>(all.size()));
        if (added) {
            all.push_back(p);
        }
        return found->second;
    }

    std::vector<glm::i64vec2> all;

private:
    std::map<std::pair<std::int64_t, std::int64_t>, std::uint32_t> index_;
};

}  // namespace

std::vector<glm::i64vec2> divisions(const glm::i64vec2& from, const glm::i64vec2& to)
{
    // From the lesser end, so that rounding is the same both ways.
    const bool turned = in_order(to, from);
    const glm::i64vec2 a = turned ? to : from;
    const glm::i64vec2 b = turned ? from : to;
    std::vector<std::pair<double, glm::i64vec2>> found;
    for (int axis = 0; axis < 2; ++axis) {
        const std::int64_t low = std::min(a[axis], b[axis]);
        const std::int64_t high = std::max(a[axis], b[axis]);
        const std::int64_t first = opening[axis] + (((low - opening[axis]) >> tile_bits) + 1) * one_tile;
        for (std::int64_t line = first; line < high; line += one_tile) {
            const double share = static_cast<double>(line - a[axis]) / static_cast<double>(b[axis] - a[axis]);
            glm::i64vec2 p;
            p[axis] = line;
            p[1 - axis] = a[1 - axis] + std::llround(static_cast<double>(b[1 - axis] - a[1 - axis]) * share);
            found.emplace_back(share, p);
        }
    }
    std::sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
    std::vector<glm::i64vec2> points;
    for (const auto& [share, p] : found) {
        if (p != a && p != b && (points.empty() || points.back() != p)) {
            points.push_back(p);
        }
    }
    if (turned) {
        std::reverse(points.begin(), points.end());
    }
    return points;
}

std::vector<std::array<glm::i64vec2, 3>> fill_cut(const std::vector<CutEdge>& edges,
                                                  const std::function<bool(const glm::i64vec2&)>& solid_at)
{
    Points points;
    const std::array<std::uint32_t, 4> corners{
        points.find_or_add(opening), points.find_or_add(opening + glm::i64vec2(one_tile, 0)),
        points.find_or_add(opening + one_tile), points.find_or_add(opening + glm::i64vec2(0, one_tile))};
    std::vector<glm::uvec2> segments;
    for (const CutEdge& edge : edges) {
        std::vector<glm::i64vec2> stops = divisions(edge.from, edge.to);
        stops.insert(stops.begin(), edge.from);
        stops.push_back(edge.to);
        for (std::size_t i = 1; i < stops.size(); ++i) {
            // Twice the middle, which lies within one copy of the tile.
            const glm::i64vec2 middle = (stops[i - 1] - opening) + (stops[i] - opening);
            const glm::i64vec2 copy = (middle >> glm::i64vec2(tile_bits + 1)) * one_tile;
            segments.emplace_back(points.find_or_add(stops[i - 1] - copy), points.find_or_add(stops[i] - copy));
        }
    }
    if (!close_along_border(points.all, corners, solid_at(opening), segments)) {
        return {};
    }
    std::vector<std::array<glm::i64vec2, 3>> triangles;
    for (const glm::uvec3& t : fill_region(points.all, segments)) {
        triangles.push_back({points.all[t.x], points.all[t.y], points.all[t.z]});
    }
    return triangles;
}

}  // namespace mesoshell
