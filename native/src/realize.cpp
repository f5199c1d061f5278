#include "mesoshell/realize.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "closest_point.h"
#include "mesoshell/error.h"
#include "parallel.h"
#include "plane_side.h"
#include "realize_charts.h"
#include "realize_prism.h"
#include "realize_tile.h"
#include "tile_grid.h"
#include "vertex_weld.h"

namespace mesoshell {
namespace {

// An edge is halved no more often than this, whatever the error asked.
constexpr int most_halvings = 10;
constexpr std::size_t most_triangles = std::size_t(1) << 30;

// Triangles of one task, welded among themselves.
struct Part {
    VertexWeld vertices{1024};
    RealizedMesh mesh;                    // without positions
    std::vector<glm::vec3> tile_normals;  // of every corner, before they are mapped; zero where it is none of the input's
};

PrismPoint middle_of(const PrismPoint& a, const PrismPoint& b)
{
    PrismPoint p;
    for (int i = 0; i < 3; ++i) {
        p.weight[i] = (a.weight[i] + b.weight[i]) * 0.5;
    }
    p.w = (a.w + b.w) * 0.5;
    return p;
}

// Splits a prism's triangles until their edges follow the map, and maps them.
class PrismMap {
public:
    PrismMap(const ChartPrism& prism, const Sample& sample, const Tile& tile, const RealizeOptions& options,
             double tile_width, Part& part)
        : prism_(prism), sample_(sample), tile_(tile), most_off_(options.error * tile_width), normals_(options.normals),
          part_(part)
    {
        // Sums run in the order of the shell's vertices, so that both prisms at a fin round alike; the third term is 0
        // there.
        std::sort(order_.begin(), order_.end(),
                  [&](int a, int b) { return prism.corners[a].vertex < prism.corners[b].vertex; });
    }

    void add(const PrismTriangle& t)
    {
        triangle_ = &t;
        split(t.corners, 0);
    }

private:
    // How far the middle of an edge lies beside the curve: the map is quadratic along it. The same from both ends.
    bool bends(const PrismPoint& a, const PrismPoint& b) const
    {
        glm::dvec3 change(0.0);
        for (const int i : order_) {
            change += prism_.corners[i].rise * (a.weight[i] - b.weight[i]);
        }
        return 0.25 * std::abs(a.w - b.w) * glm::length(change) > most_off_;
    }

    // Which edges are halved depends on their own ends alone, so that the triangles on both sides of one agree.
    void split(const std::array<PrismPoint, 3>& t, int depth)
    {
        std::array<bool, 3> halved{};
        int count = 0;
        int last = 0;
        for (int i = 0; i < 3 && depth < most_halvings; ++i) {
            halved[i] = bends(t[i], t[(i + 1) % 3]);
            count += halved[i] ? 1 : 0;
            last = halved[i] ? i : last;
        }
        if (count == 0) {
            emit(t);
            return;
        }
        if (count == 1) {
            const PrismPoint& a = t[last];
            const PrismPoint& b = t[(last + 1) % 3];
            const PrismPoint& c = t[(last + 2) % 3];
            const PrismPoint ab = middle_of(a, b);
            split({a, ab, c}, depth + 1);
            split({ab, b, c}, depth + 1);
            return;
        }
        if (count == 2) {
            const int whole = !halved[0] ? 0 : (!halved[1] ? 1 : 2);
            const PrismPoint& a = t[whole];
            const PrismPoint& b = t[(whole + 1) % 3];
            const PrismPoint& c = t[(whole + 2) % 3];
            const PrismPoint bc = middle_of(b, c);
            const PrismPoint ca = middle_of(c, a);
            split({ca, bc, c}, depth + 1);
            split({a, b, bc}, depth + 1);
            split({a, bc, ca}, depth + 1);
            return;
        }
        const PrismPoint ab = middle_of(t[0], t[1]);
        const PrismPoint bc = middle_of(t[1], t[2]);
        const PrismPoint ca = middle_of(t[2], t[0]);
        split({t[0], ab, ca}, depth + 1);
        split({ab, t[1], bc}, depth + 1);
        split({ca, bc, t[2]}, depth + 1);
        split({ab, bc, ca}, depth + 1);
    }

    glm::vec3 position(const PrismPoint& p) const
    {
        glm::dvec3 sum(0.0);
        for (const int i : order_) {
            sum += (prism_.corners[i].base + prism_.corners[i].rise * p.w) * p.weight[i];
        }
        return glm::vec3(sum);
    }

    glm::dvec3 texture(const PrismPoint& p) const
    {
        glm::dvec2 uv(0.0);
        for (int i = 0; i < 3; ++i) {
            const ChartCorner& c = prism_.corners[i];
            uv += (glm::dvec2(c.uv) + glm::dvec2(c.uv_top - c.uv) * p.w) * p.weight[i];
        }
        return {uv / static_cast<double>(one_tile), p.w};
    }

    glm::vec2 source_weights(const glm::dvec3& texture) const
    {
        const TileSource& source = tile_.sources[triangle_->tile_triangle];
        const glm::dvec3 metric((glm::dvec2(texture) - glm::dvec2(triangle_->copy)) * glm::dvec2(1.0, sample_.aspect()) -
                                    glm::dvec2(source.offset),
                                texture.z * sample_.height());
        const glm::uvec3& t = sample_.input_triangles()[source.triangle];
        const std::vector<glm::vec3>& p = sample_.input_positions();
        return closest_point(glm::vec3(metric), p[t.x], p[t.y], p[t.z]).weights;
    }

    void emit(const std::array<PrismPoint, 3>& t)
    {
        // Mirrored UVs turn the triangles over.
        const std::array<int, 3> turn{0, prism_.mirrored ? 2 : 1, prism_.mirrored ? 1 : 2};
        glm::uvec3 corners;
        for (int i = 0; i < 3; ++i) {
            corners[i] = part_.vertices.find_or_add(position(t[turn[i]]));
        }
        if (corners.x == corners.y || corners.y == corners.z || corners.z == corners.x) {
            return;  // its other two sides are one edge there and back
        }
        part_.mesh.triangles.push_back(corners);
        part_.mesh.source.push_back(tile_.sources[triangle_->tile_triangle].triangle);
        part_.mesh.prism.push_back(prism_.index);
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 place = texture(t[turn[i]]);
            part_.mesh.texture.emplace_back(place);
            part_.mesh.weights.push_back(source_weights(place));
        }
        if (!normals_.empty()) {
            add_normals(t, turn, corners);
        }
    }

    void add_normals(const std::array<PrismPoint, 3>& t, const std::array<int, 3>& turn, const glm::uvec3& corners)
    {
        const std::vector<glm::vec3>& p = part_.vertices.positions;
        const glm::dvec3 a(p[corners.x]);
        const glm::dvec3 face = unit(glm::cross(glm::dvec3(p[corners.y]) - a, glm::dvec3(p[corners.z]) - a));
        const TileSource& source = tile_.sources[triangle_->tile_triangle];
        if (triangle_->cap || !source.parallel) {
            part_.mesh.normals.insert(part_.mesh.normals.end(), 3, glm::vec3(face));
            part_.tile_normals.insert(part_.tile_normals.end(), 3, glm::vec3(0.0f));
            return;
        }
        std::array<glm::dvec3, 3> mapped;
        std::array<glm::dvec3, 3> given;
        double side = 0.0;
        for (int i = 0; i < 3; ++i) {
            const glm::dvec2 weights(part_.mesh.weights[part_.mesh.weights.size() - 3 + static_cast<std::size_t>(i)]);
            const glm::vec3* corner = &normals_[3 * static_cast<std::size_t>(source.triangle)];
            given[i] = unit(glm::dvec3(corner[0]) * (1.0 - weights.x - weights.y) + glm::dvec3(corner[1]) * weights.x +
                            glm::dvec3(corner[2]) * weights.y);
            mapped[i] = unit(cofactors(t[turn[i]]) * given[i]);
            side += glm::dot(mapped[i], face);
        }
        // Repair may have turned the tile's triangle over, and mirrored UVs turn the prism.
        const double sign = side < 0.0 ? -1.0 : 1.0;
        for (int i = 0; i < 3; ++i) {
            part_.mesh.normals.emplace_back(mapped[i] * sign);
            part_.tile_normals.emplace_back(given[i] * sign);
        }
    }

    static glm::dvec3 unit(const glm::dvec3& v)
    {
        const double length = glm::length(v);
        return length > 0.0 ? v / length : v;
    }

    // Of the map's derivative by metric texture coordinates: what normals are mapped by.
    glm::dmat3 cofactors(const PrismPoint& p) const
    {
        std::array<glm::dvec3, 3> column;
        std::array<glm::dvec2, 3> uv;
        glm::dvec3 by_w(0.0);
        glm::dvec2 slant(0.0);
        for (int i = 0; i < 3; ++i) {
            const ChartCorner& c = prism_.corners[i];
            const glm::dvec2 change = glm::dvec2(c.uv_top - c.uv) / static_cast<double>(one_tile);
            column[i] = c.base + c.rise * p.w;
            uv[i] = glm::dvec2(c.uv - prism_.corners[0].uv) / static_cast<double>(one_tile) + change * p.w;
            by_w += c.rise * p.weight[i];
            slant += change * p.weight[i];
        }
        const glm::dvec2 e1 = uv[1] - uv[0];
        const glm::dvec2 e2 = uv[2] - uv[0];
        const double area = e1.x * e2.y - e1.y * e2.x;
        const glm::dvec3 f1 = column[1] - column[0];
        const glm::dvec3 f2 = column[2] - column[0];
        const glm::dvec3 by_u = (f1 * e2.y - f2 * e1.y) / area;
        const glm::dvec3 by_v = (f2 * e1.x - f1 * e2.x) / area;
        by_w = (by_w - by_u * slant.x - by_v * slant.y) / static_cast<double>(sample_.height());
        const glm::dvec3 by_y = by_v / static_cast<double>(sample_.aspect());
        return glm::dmat3(glm::cross(by_y, by_w), glm::cross(by_w, by_u), glm::cross(by_u, by_y));
    }

    const ChartPrism& prism_;
    const Sample& sample_;
    const Tile& tile_;
    double most_off_;
    std::span<const glm::vec3> normals_;
    Part& part_;
    std::array<int, 3> order_{0, 1, 2};
    const PrismTriangle* triangle_ = nullptr;
};

// By less than 1e-6 tiles: edges of the tile that lie in a fin or meet a column, as where both are made of the same
// lattice, are no tie then, which rounding would break one way for one prism and the other way for the next.
void move_aside(Tile& tile)
{
    for (auto& corners : tile.triangles) {
        for (TileCorner& corner : corners) {
            corner.uv += glm::i64vec2(7, 4);
        }
    }
}

// Edges by their lesser vertex: sorted, so that memory is linear and no table is needed.
std::size_t count_open(const RealizedMesh& mesh, Job& job)
{
    std::vector<std::uint32_t> first(mesh.positions.size() + 1, 0);
    const auto each_side = [&](const auto& visit) {
        for (const glm::uvec3& t : mesh.triangles) {
            for (int i = 0; i < 3; ++i) {
                visit(t[i], t[(i + 1) % 3]);
            }
        }
    };
    each_side([&](std::uint32_t a, std::uint32_t b) { first[std::min(a, b) + 1] += 1; });
    for (std::size_t i = 1; i < first.size(); ++i) {
        first[i] += first[i - 1];
    }
    struct Side {
        std::uint32_t other;
        std::int32_t way;
    };
    std::vector<Side> sides(first.back());
    std::vector<std::uint32_t> filled(first.begin(), first.end() - 1);
    each_side([&](std::uint32_t a, std::uint32_t b) { sides[filled[std::min(a, b)]++] = {std::max(a, b), a < b ? 1 : -1}; });
    job.throw_if_cancelled();
    std::atomic<std::size_t> open{0};
    constexpr int per_task = 4096;
    const int count = static_cast<int>(mesh.positions.size());
    parallel_for(job, (count + per_task - 1) / per_task, [&](int task) {
        std::size_t found = 0;
        for (int v = task * per_task; v < std::min(count, (task + 1) * per_task); ++v) {
            const auto begin = sides.begin() + first[static_cast<std::size_t>(v)];
            const auto end = sides.begin() + first[static_cast<std::size_t>(v) + 1];
            std::sort(begin, end, [](const Side& a, const Side& b) { return a.other < b.other; });
            for (auto side = begin; side != end;) {
                const std::uint32_t other = side->other;
                int balance = 0;
                for (; side != end && side->other == other; ++side) {
                    balance += side->way;
                }
                found += balance != 0 ? 1 : 0;
            }
        }
        open += found;
    });
    return open;
}

template <typename T>
void append(std::vector<T>& all, std::vector<T>& more)
{
    all.insert(all.end(), more.begin(), more.end());
    more = {};
}

// Corners at one vertex whose normals are one in the tile get one normal.
void smooth_normals(RealizedMesh& mesh, const std::vector<glm::vec3>& tile_normals)
{
    constexpr float least_share = 0.999f;  // of its length that the sum of unit vectors must have
    struct Sum {
        glm::vec3 tile{0.0f};
        glm::vec3 mapped{0.0f};
        float count = 0.0f;
    };
    std::vector<Sum> sums(mesh.positions.size());
    const auto each_corner = [&](const auto& visit) {
        for (std::size_t i = 0; i < tile_normals.size(); ++i) {
            if (tile_normals[i] != glm::vec3(0.0f)) {
                visit(sums[mesh.triangles[i / 3][static_cast<int>(i % 3)]], i);
            }
        }
    };
    each_corner([&](Sum& sum, std::size_t i) {
        sum.tile += tile_normals[i];
        sum.mapped += mesh.normals[i];
        sum.count += 1.0f;
    });
    each_corner([&](const Sum& sum, std::size_t i) {
        if (glm::length(sum.tile) > least_share * sum.count && glm::length(sum.mapped) > 0.5f * sum.count) {
            mesh.normals[i] = glm::normalize(sum.mapped);
        }
    });
}

RealizedMesh join(std::vector<Part>& parts, Job& job)
{
    std::size_t triangles = 0;
    std::size_t vertices = 0;
    for (const Part& part : parts) {
        triangles += part.mesh.triangles.size();
        vertices += part.vertices.positions.size();
    }
    if (triangles > most_triangles) {
        throw InvalidArgument("the realized mesh has " + std::to_string(triangles) +
                              " triangles; use a simpler tile, larger tiles or a part of the surface");
    }
    RealizedMesh mesh;
    mesh.triangles.reserve(triangles);
    mesh.texture.reserve(3 * triangles);
    mesh.weights.reserve(3 * triangles);
    mesh.source.reserve(triangles);
    mesh.prism.reserve(triangles);
    VertexWeld weld(vertices);
    std::vector<std::uint32_t> index;
    std::vector<glm::vec3> tile_normals;
    for (Part& part : parts) {
        job.throw_if_cancelled();
        index.clear();
        for (const glm::vec3& p : part.vertices.positions) {
            index.push_back(weld.find_or_add(p));
        }
        for (const glm::uvec3& t : part.mesh.triangles) {
            mesh.triangles.emplace_back(index[t.x], index[t.y], index[t.z]);
        }
        part.vertices = VertexWeld(0);
        append(mesh.texture, part.mesh.texture);
        append(mesh.weights, part.mesh.weights);
        append(mesh.normals, part.mesh.normals);
        append(tile_normals, part.tile_normals);
        append(mesh.source, part.mesh.source);
        append(mesh.prism, part.mesh.prism);
    }
    mesh.positions = std::move(weld.positions);
    smooth_normals(mesh, tile_normals);
    return mesh;
}

}  // namespace

RealizedMesh realize(const Shell& shell, const Sample& sample, const RealizeOptions& options, Job& job)
{
    if (!(options.error > 0.0f) || !std::isfinite(options.error)) {
        throw InvalidArgument("error is " + std::to_string(options.error) + "; give a positive number of tile widths");
    }
    if (!options.normals.empty() && options.normals.size() != 3 * sample.input_triangles().size()) {
        throw InvalidArgument("there are " + std::to_string(options.normals.size()) + " normals; give three a triangle, " +
                              std::to_string(3 * sample.input_triangles().size()));
    }
    job.throw_if_cancelled();
    const Charts charts = charts_of(shell, sample.aspect());
    // An edge of the tile bends in a slanted prism by a quarter of its rise times the twist of its own length and of what
    // the slant adds to that; so much of its length is the most.
    const double twist = 0.25 * charts.most_twist * (1.0 + charts.most_slant);
    const double most_bend = twist > 0.0 ? options.error / twist : std::numeric_limits<double>::infinity();
    job.stage(0.0f, 0.05f);
    Tile tile = tile_in_slab(sample, options.caps, most_bend, job);
    if (!charts.upright) {
        move_aside(tile);
    }
    const TileGrid grid(tile);

    constexpr int prisms_per_task = 64;
    const int count = static_cast<int>(charts.prisms.size());
    const int tasks = (count + prisms_per_task - 1) / prisms_per_task;
    std::vector<Part> parts(static_cast<std::size_t>(tasks));
    job.stage(0.05f, 0.8f);
    parallel_for(job, tasks, [&](int task) {
        for (int i = task * prisms_per_task; i < std::min(count, (task + 1) * prisms_per_task) && !job.cancelled(); ++i) {
            const ChartPrism& prism = charts.prisms[static_cast<std::size_t>(i)];
            PrismClip clip(prism, charts.upright);
            grid.visit_within(clip.lower(), clip.upper(), [&](std::uint32_t triangle, const glm::ivec2& copy) {
                if (!job.cancelled()) {
                    clip.add(tile, triangle, copy);
                }
            });
            if (options.caps) {
                clip.cap_open_fins();
            }
            PrismMap map(prism, sample, tile, options, charts.tile_width, parts[static_cast<std::size_t>(task)]);
            for (const PrismTriangle& t : clip.triangles()) {
                map.add(t);
            }
        }
    });
    RealizedMesh mesh = join(parts, job);
    job.stage(0.9f, 1.0f);
    mesh.open_edges = count_open(mesh, job);
    return mesh;
}

}  // namespace mesoshell
