#include "realize_tile.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "embree_scene.h"
#include "parallel.h"
#include "periodic_mesh.h"
#include "plane_side.h"
#include "slab_caps.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

using Polygon = std::vector<TileCorner>;

bool in_order(const TileCorner& a, const TileCorner& b)
{
    return std::tie(a.uv.x, a.uv.y, a.w) < std::tie(b.uv.x, b.uv.y, b.w);
}

TileCorner middle_of(const TileCorner& a, const TileCorner& b)
{
    return {glm::i64vec2((a.uv.x + b.uv.x) >> 1, (a.uv.y + b.uv.y) >> 1), (a.w + b.w) * 0.5};
}

// Where an edge meets a plane of the slab, the same from both of its triangles.
TileCorner crossing(const TileCorner& from, const TileCorner& to, double level)
{
    const bool turned = in_order(to, from);
    const TileCorner& a = turned ? to : from;
    const TileCorner& b = turned ? from : to;
    const double share = (level - a.w) / (b.w - a.w);
    const glm::dvec2 along = glm::dvec2(b.uv - a.uv) * share;
    return {a.uv + glm::i64vec2(std::llround(along.x), std::llround(along.y)), level};
}

Polygon clip(const Polygon& polygon, double level, double sign)
{
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const TileCorner& a = polygon[i];
        const TileCorner& b = polygon[(i + 1) % polygon.size()];
        const double side_a = (a.w - level) * sign;
        const double side_b = (b.w - level) * sign;
        if (side_a >= 0.0) {
            kept.push_back(a);
        }
        if (side_a * side_b < 0.0) {
            kept.push_back(crossing(a, b, level));
        }
    }
    return kept;
}

// An edge in a plane of the slab modulo the periods, from its lesser end.
using PlaneEdge = std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t>;

class TileBuilder {
public:
    TileBuilder(const Sample& sample, bool caps, double most_bend) : sample_(sample), caps_(caps), most_bend_(most_bend)
    {
        const PeriodicMesh& mesh = sample.winding_mesh();
        const double height = sample.height();
        std::vector<TileCorner> places(mesh.positions.size());
        for (std::size_t i = 0; i < places.size(); ++i) {
            const glm::dvec3 p(mesh.positions[i]);
            places[i].uv = glm::i64vec2(std::llround(p.x * one_tile), std::llround(p.y / mesh.aspect * one_tile));
            places[i].w = p.z / height;
        }
        for (const glm::uvec3& t : mesh.triangles) {
            std::array<TileCorner, 3> corners;
            for (int i = 0; i < 3; ++i) {
                corners[i] = places[mesh.place[t[i]]];
                corners[i].uv += glm::i64vec2(mesh.shift[t[i]]) * one_tile;
            }
            whole_.push_back(corners);
        }
        number_groups(mesh);
    }

    Tile build()
    {
        for (const std::array<TileCorner, 3>& t : whole_) {
            polygons_.push_back(clip(clip(Polygon(t.begin(), t.end()), 0.0, 1.0), 1.0, -1.0));
        }
        if (caps_) {
            for (int group = 0; group < groups_; ++group) {
                add_caps(group, 0.0);
                add_caps(group, 1.0);
            }
        }
        for (std::size_t i = 0; i < polygons_.size(); ++i) {
            add_polygon(divided(polygons_[i]), polygons_[i].size(), group_[i]);
        }
        return std::move(tile_);
    }

private:
    // Solids that cross one another have no common outline: each connected part is a group then, but for sheets through all
    // copies of the tile, which bound a solid together.
    void number_groups(const PeriodicMesh& mesh)
    {
        group_.assign(whole_.size(), 0);
        if (!sample_.overlaps()) {
            return;
        }
        std::vector<std::uint32_t> root(mesh.positions.size());
        std::iota(root.begin(), root.end(), 0u);
        const auto find = [&](std::uint32_t i) {
            while (root[i] != i) {
                i = root[i] = root[root[i]];
            }
            return i;
        };
        for (const glm::uvec3& t : mesh.triangles) {
            for (int i = 1; i < 3; ++i) {
                root[find(mesh.place[t[i]])] = find(mesh.place[t.x]);
            }
        }
        std::map<std::uint32_t, Wide> covered;  // seen from above, less what is seen from below
        for (std::size_t i = 0; i < whole_.size(); ++i) {
            const std::array<TileCorner, 3>& t = whole_[i];
            covered[find(mesh.place[mesh.triangles[i].x])] += area_of(t[0].uv, t[1].uv, t[2].uv);
        }
        std::map<std::uint32_t, int> numbers;
        for (const auto& [part, area] : covered) {
            numbers[part] = area != 0 ? 0 : groups_++;
        }
        for (std::size_t i = 0; i < whole_.size(); ++i) {
            group_[i] = numbers[find(mesh.place[mesh.triangles[i].x])];
        }
    }

    // Whether the solid goes on beyond the plane, out of the slab: the surface there and above has been left more often than
    // entered. Faces in the plane are within the slab.
    bool goes_on(int group, double level, const glm::i64vec2& at) const
    {
        int winding = 0;
        for (std::size_t i = 0; i < whole_.size(); ++i) {
            if (group_[i] != group) {
                continue;
            }
            const std::array<TileCorner, 3>& t = whole_[i];
            const Wide area = area_of(t[0].uv, t[1].uv, t[2].uv);
            if (area == 0 || std::max(t[0].w, std::max(t[1].w, t[2].w)) < level) {
                continue;
            }
            const glm::i64vec2 low = glm::min(t[0].uv, glm::min(t[1].uv, t[2].uv));
            const glm::i64vec2 high = glm::max(t[0].uv, glm::max(t[1].uv, t[2].uv));
            const glm::i64vec2 first = (at - high) >> glm::i64vec2(tile_bits);
            const glm::i64vec2 last = (at - low) >> glm::i64vec2(tile_bits);
            for (std::int64_t y = first.y; y <= last.y; ++y) {
                for (std::int64_t x = first.x; x <= last.x; ++x) {
                    winding += crossing_above(t, area, level, at - glm::i64vec2(x, y) * one_tile);
                }
            }
        }
        return winding > 0;
    }

    static int crossing_above(const std::array<TileCorner, 3>& t, Wide area, double level, const glm::i64vec2& at)
    {
        const bool up = area > 0;
        double w = 0.0;
        for (int i = 0; i < 3; ++i) {
            const glm::i64vec2& a = t[(i + 1) % 3].uv;
            const glm::i64vec2& b = t[(i + 2) % 3].uv;
            if (shell_left_of(a, b, at) != up) {
                return 0;
            }
            w += t[i].w * static_cast<double>(area_of(a, b, at)) / static_cast<double>(area);
        }
        return w > level || (w == 0.0 && level == 0.0) ? (up ? 1 : -1) : 0;
    }

    static std::pair<PlaneEdge, bool> key(const TileCorner& a, const TileCorner& b)
    {
        const bool forward = in_order(a, b);
        const glm::i64vec2& low = forward ? a.uv : b.uv;
        const glm::i64vec2& high = forward ? b.uv : a.uv;
        const glm::i64vec2 place = low & (one_tile - 1);
        const glm::i64vec2 across = high - low;
        return {{place.x, place.y, across.x, across.y}, forward};
    }

    void add_caps(int group, double level)
    {
        std::map<PlaneEdge, int> balance;
        for (std::size_t i = 0; i < polygons_.size(); ++i) {
            const Polygon& polygon = polygons_[i];
            for (std::size_t k = 0; group_[i] == group && k < polygon.size(); ++k) {
                const TileCorner& a = polygon[k];
                const TileCorner& b = polygon[(k + 1) % polygon.size()];
                if (a.w == level && b.w == level && a.uv != b.uv) {
                    const auto [edge, forward] = key(a, b);
                    balance[edge] += forward ? 1 : -1;
                }
            }
        }
        const bool bottom = level == 0.0;
        std::vector<CutEdge> edges;
        for (const auto& [edge, count] : balance) {
            const auto& [x, y, across_x, across_y] = edge;
            const glm::i64vec2 low(x, y);
            const glm::i64vec2 high = low + glm::i64vec2(across_x, across_y);
            for (int k = 0; k < std::abs(count); ++k) {
                // Where the mesh runs one way the cap runs back, and seen from below its turns are reversed.
                edges.push_back((count > 0) == bottom ? CutEdge{low, high} : CutEdge{high, low});
            }
            if (count != 0) {
                cut_[bottom ? 0 : 1].insert(edge);
            }
        }
        const auto solid_at = [&](const glm::i64vec2& at) { return goes_on(group, level, at); };
        for (const std::array<glm::i64vec2, 3>& t : fill_cut(edges, solid_at)) {
            const TileCorner first{t[0], level};
            const TileCorner second{t[1], level};
            const TileCorner third{t[2], level};
            add_triangle(bottom ? std::array{first, third, second} : std::array{first, second, third}, group);
        }
    }

    // With the points that caps have on its edges.
    Polygon divided(const Polygon& polygon) const
    {
        Polygon all;
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const TileCorner& a = polygon[k];
            const TileCorner& b = polygon[(k + 1) % polygon.size()];
            all.push_back(a);
            const bool in_plane = a.w == b.w && (a.w == 0.0 || a.w == 1.0) && a.uv != b.uv;
            if (in_plane && cut_[a.w == 0.0 ? 0 : 1].count(key(a, b).first) > 0) {
                for (const glm::i64vec2& p : divisions(a.uv, b.uv)) {
                    all.push_back({p, a.w});
                }
            }
        }
        return all;
    }

    void add_polygon(const Polygon& polygon, std::size_t undivided, int group)
    {
        if (polygon.size() < 3) {
            return;
        }
        if (polygon.size() > undivided) {  // flat corners: a fan about the middle has none
            glm::dvec2 sum(0.0);
            double w = 0.0;
            for (const TileCorner& c : polygon) {
                sum += glm::dvec2(c.uv - polygon[0].uv);
                w += c.w;
            }
            const double share = 1.0 / static_cast<double>(polygon.size());
            const TileCorner middle{polygon[0].uv + glm::i64vec2(std::llround(sum.x * share), std::llround(sum.y * share)),
                                    w * share};
            for (std::size_t k = 0; k < polygon.size(); ++k) {
                add_triangle({middle, polygon[k], polygon[(k + 1) % polygon.size()]}, group);
            }
            return;
        }
        for (std::size_t k = 2; k < polygon.size(); ++k) {
            add_triangle({polygon[0], polygon[k - 1], polygon[k]}, group);
        }
    }

    // Every edge is halved by a rule that knows its ends alone, so that its triangles agree.
    void add_triangle(const std::array<TileCorner, 3>& t, int group)
    {
        std::array<bool, 3> long_edge{};
        int first = -1;
        for (int i = 0; i < 3; ++i) {
            const TileCorner& a = t[i];
            const TileCorner& b = t[(i + 1) % 3];
            long_edge[i] = glm::length(glm::dvec2(b.uv - a.uv)) / one_tile * std::abs(b.w - a.w) > most_bend_;
            first = long_edge[i] && first < 0 ? i : first;
        }
        if (first < 0) {
            tile_.triangles.push_back(t);
            tile_.groups.push_back(group);
            return;
        }
        Polygon around;
        for (int i = 0; i < 3; ++i) {
            around.push_back(t[i]);
            if (long_edge[i]) {
                around.push_back(middle_of(t[i], t[(i + 1) % 3]));
            }
        }
        if (around.size() == 6) {
            add_triangle({around[0], around[1], around[5]}, group);
            add_triangle({around[1], around[2], around[3]}, group);
            add_triangle({around[3], around[4], around[5]}, group);
            add_triangle({around[1], around[3], around[5]}, group);
            return;
        }
        // A fan about the first middle: no three of its corners were on one edge.
        std::size_t apex = 0;
        for (std::size_t k = 0, corner = 0; k < around.size(); ++k) {
            const bool is_corner = corner < 3 && around[k] == t[corner];
            corner += is_corner ? 1 : 0;
            if (!is_corner) {
                apex = k;
                break;
            }
        }
        for (std::size_t k = 2; k < around.size(); ++k) {
            add_triangle({around[apex], around[(apex + k - 1) % around.size()], around[(apex + k) % around.size()]}, group);
        }
    }

    const Sample& sample_;
    bool caps_;
    double most_bend_;
    std::vector<std::array<TileCorner, 3>> whole_;
    std::vector<int> group_;  // of every whole triangle
    int groups_ = 1;
    std::vector<Polygon> polygons_;
    std::array<std::set<PlaneEdge>, 2> cut_;  // edges of caps, at w = 0 and at w = 1
    Tile tile_;
};

// What each triangle shows: the nearest triangle of the input to its middle, which is the one it comes from where it comes
// from one. Caps show what is near.
void find_sources(const Sample& sample, Tile& tile, Job& job)
{
    constexpr double least_cosine = 0.99;
    const glm::vec2 period(1.0f, sample.aspect());
    const float farthest = 4.0f * (1.0f + sample.aspect() + sample.height() + static_cast<float>(most_height));
    const TriangleScene scene(sample.input_positions(), sample.input_triangles(),
                              lattice_within(sample.input_positions(), sample.aspect(), 1.0f + sample.aspect()));
    tile.sources.resize(tile.triangles.size());
    constexpr int per_task = 256;
    const int count = static_cast<int>(tile.triangles.size());
    parallel_for(job, (count + per_task - 1) / per_task, [&](int task) {
        for (int i = task * per_task; i < std::min(count, (task + 1) * per_task); ++i) {
            const std::array<TileCorner, 3>& t = tile.triangles[static_cast<std::size_t>(i)];
            const glm::dvec2 sum = glm::dvec2(t[0].uv) + glm::dvec2(t[1].uv) + glm::dvec2(t[2].uv);
            const glm::dvec2 tiles = sum / (3.0 * one_tile);
            const glm::vec2 there(glm::dvec2(period) * (tiles - glm::floor(tiles)));
            const glm::vec3 middle(there, static_cast<float>((t[0].w + t[1].w + t[2].w) / 3.0) * sample.height());
            const NearestPoint nearest = scene.nearest(middle, farthest);
            const glm::uvec3& source = sample.input_triangles()[nearest.triangle];
            const std::vector<glm::vec3>& p = sample.input_positions();
            const glm::vec3 point = p[source.x] + nearest.weights.x * (p[source.y] - p[source.x]) +
                                    nearest.weights.y * (p[source.z] - p[source.x]);
            const glm::dvec2 apart = glm::dvec2(period) * tiles - glm::dvec2(point);
            const glm::dvec3 scale(glm::dvec2(period) / static_cast<double>(one_tile), sample.height());
            const auto along = [&](int k) {
                return glm::dvec3(glm::dvec2(t[k].uv - t[0].uv), t[k].w - t[0].w) * scale;
            };
            const glm::dvec3 own = glm::cross(along(1), along(2));
            const glm::dvec3 theirs = glm::cross(glm::dvec3(p[source.y]) - glm::dvec3(p[source.x]),
                                                 glm::dvec3(p[source.z]) - glm::dvec3(p[source.x]));
            tile.sources[static_cast<std::size_t>(i)] = {
                nearest.triangle, glm::vec2(glm::round(apart / glm::dvec2(period))) * period,
                std::abs(glm::dot(own, theirs)) > least_cosine * glm::length(own) * glm::length(theirs)};
        }
    }, 0.0f);
}

}  // namespace

Tile tile_in_slab(const Sample& sample, bool caps, double most_bend, Job& job)
{
    Tile tile = TileBuilder(sample, caps, most_bend).build();
    find_sources(sample, tile, job);
    return tile;
}

}  // namespace mesoshell
