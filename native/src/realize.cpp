#include "mesoshell/realize.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "mesoshell/error.h"
#include "parallel.h"
#include "plane_side.h"
#include "realize_charts.h"
#include "realize_map.h"
#include "realize_prism.h"
#include "realize_tile.h"
#include "tile_grid.h"
#include "vertex_weld.h"

namespace mesoshell {
namespace {

constexpr std::size_t most_triangles = std::size_t(1) << 30;

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

RealizedMesh join(std::vector<RealizedPart>& parts, Job& job)
{
    std::size_t triangles = 0;
    std::size_t vertices = 0;
    for (const RealizedPart& part : parts) {
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
    for (RealizedPart& part : parts) {
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
    std::vector<RealizedPart> parts(static_cast<std::size_t>(tasks));
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
            map_prism(prism, clip.triangles(), sample, tile, options, charts.tile_width,
                      parts[static_cast<std::size_t>(task)]);
        }
    });
    RealizedMesh mesh = join(parts, job);
    job.stage(0.9f, 1.0f);
    mesh.open_edges = count_open(mesh, job);
    return mesh;
}

}  // namespace mesoshell
