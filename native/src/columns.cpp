#include "columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "mesoshell/error.h"
#include "parallel.h"

namespace mesoshell {
namespace {

constexpr int fraction_bits = 23;
constexpr std::int64_t one = std::int64_t(1) << fraction_bits;

// With most_periods, edge functions stay below 2^63. A grid's crossings take 16 bytes each.
constexpr std::size_t most_crossings = std::size_t(1) << 28;

// Surfaces that lie closer than this, in tile widths, are one to winding_range: rounding may have changed their order.
constexpr double tie = 1e-6;

std::int64_t floor_div(std::int64_t a, std::int64_t b)
{
    return a / b - (a % b < 0 ? 1 : 0);
}

// A triangle as the integer lattice sees it, counterclockwise.
class Footprint {
public:
    Footprint(const PeriodicMesh& mesh, const std::vector<glm::i64vec2>& fixed, glm::uvec3 t)
    {
        const glm::i64vec2 ab = fixed[t.y] - fixed[t.x];
        const glm::i64vec2 ac = fixed[t.z] - fixed[t.x];
        area_ = ab.x * ac.y - ab.y * ac.x;
        sign = area_ > 0 ? 1 : -1;
        if (area_ < 0) {
            std::swap(t.y, t.z);
            area_ = -area_;
        }
        for (int i = 0; i < 3; ++i) {
            corner_[i] = fixed[t[i]];
            z_[i] = mesh.positions[t[i]].z;
        }
        for (int i = 0; i < 3; ++i) {
            along_[i] = corner_[(i + 1) % 3] - corner_[i];
            // A line through an edge belongs to the triangle on its one side: the opposite edge has the opposite answer.
            owns_[i] = along_[i].y > 0 || (along_[i].y == 0 && along_[i].x < 0);
        }
        lower = glm::min(corner_[0], glm::min(corner_[1], corner_[2]));
        upper = glm::max(corner_[0], glm::max(corner_[1], corner_[2]));
    }

    bool covers_something() const { return area_ != 0; }

    bool covers(const glm::i64vec2& p)
    {
        for (int i = 0; i < 3; ++i) {
            const glm::i64vec2 to = p - corner_[i];
            side_[i] = along_[i].x * to.y - along_[i].y * to.x;
            if (side_[i] < 0 || (side_[i] == 0 && !owns_[i])) {
                return false;
            }
        }
        return true;
    }

    // Of the point asked about last, which is covered; exact where the triangle is horizontal.
    double z() const
    {
        const double scale = 1.0 / static_cast<double>(area_);
        return z_[0] + (z_[1] - z_[0]) * (static_cast<double>(side_[2]) * scale) +
               (z_[2] - z_[0]) * (static_cast<double>(side_[0]) * scale);
    }

    glm::i64vec2 lower{0}, upper{0};
    int sign = 0;

private:
    std::array<glm::i64vec2, 3> corner_;
    std::array<glm::i64vec2, 3> along_;
    std::array<double, 3> z_;
    std::array<bool, 3> owns_;
    std::array<std::int64_t, 3> side_{};
    std::int64_t area_ = 0;
};

// Where node i of n lies, for any whole i.
std::int64_t node_place(std::int64_t i, std::int64_t n)
{
    const std::int64_t turn = floor_div(i, n);
    return turn * one + ((i - turn * n) * 2 * one + n) / (2 * n);
}

struct Entry {
    std::uint32_t column;
    std::int32_t sign;
    double z;
};

bool downward(const Crossing& a, const Crossing& b)
{
    return a.z != b.z ? a.z > b.z : a.sign > b.sign;
}

}  // namespace

Columns::Columns(const PeriodicMesh& mesh) : mesh_(mesh), fixed_(mesh.positions.size())
{
    for (std::size_t i = 0; i < fixed_.size(); ++i) {
        const glm::dvec2 place = glm::dvec2(mesh.positions[mesh.place[i]]) / glm::dvec2(1.0, mesh.aspect);
        fixed_[i] = glm::i64vec2(std::llround(place.x * one), std::llround(place.y * one)) + glm::i64vec2(mesh.shift[i]) * one;
    }
}

std::vector<Crossing> Columns::along(const glm::dvec2& point, std::span<const std::uint32_t> triangles) const
{
    const glm::dvec2 scaled = point / glm::dvec2(1.0, mesh_.aspect);
    const glm::i64vec2 at(std::llround((scaled.x - std::floor(scaled.x)) * one),
                          std::llround((scaled.y - std::floor(scaled.y)) * one));
    std::vector<Crossing> crossings;
    for (const std::uint32_t t : triangles) {
        Footprint footprint(mesh_, fixed_, mesh_.triangles[t]);
        if (!footprint.covers_something()) {
            continue;
        }
        for (std::int64_t j = -floor_div(at.y - footprint.lower.y, one); j <= floor_div(footprint.upper.y - at.y, one); ++j) {
            for (std::int64_t i = -floor_div(at.x - footprint.lower.x, one); i <= floor_div(footprint.upper.x - at.x, one);
                 ++i) {
                if (footprint.covers(at + glm::i64vec2(i, j) * one)) {
                    crossings.push_back({footprint.z(), footprint.sign});
                }
            }
        }
    }
    return crossings;
}

Columns::Grid Columns::grid(const glm::ivec2& nodes, Job& job) const
{
    constexpr int triangles_per_task = 4096;
    const auto count = static_cast<int>(mesh_.triangles.size());
    const int tasks = (count + triangles_per_task - 1) / triangles_per_task;
    std::vector<std::vector<Entry>> parts(static_cast<std::size_t>(tasks));
    std::atomic<bool> too_many = false;
    parallel_for(job, tasks, [&](int task) {
        std::vector<Entry>& entries = parts[static_cast<std::size_t>(task)];
        for (int t = task * triangles_per_task; t < std::min(count, (task + 1) * triangles_per_task) && !too_many; ++t) {
            Footprint footprint(mesh_, fixed_, mesh_.triangles[static_cast<std::size_t>(t)]);
            if (!footprint.covers_something()) {
                continue;
            }
            const std::int64_t first_row = floor_div(footprint.lower.y * nodes.y, one);
            const std::int64_t last_row = floor_div(footprint.upper.y * nodes.y, one) + 1;
            const std::int64_t first_column = floor_div(footprint.lower.x * nodes.x, one);
            const std::int64_t last_column = floor_div(footprint.upper.x * nodes.x, one) + 1;
            for (std::int64_t row = first_row; row <= last_row; ++row) {
                const std::int64_t y = node_place(row, nodes.y);
                if (y < footprint.lower.y || y > footprint.upper.y) {
                    continue;
                }
                const std::int64_t wrapped_row = row - floor_div(row, nodes.y) * nodes.y;
                for (std::int64_t column = first_column; column <= last_column; ++column) {
                    if (footprint.covers({node_place(column, nodes.x), y})) {
                        const std::int64_t wrapped = column - floor_div(column, nodes.x) * nodes.x;
                        entries.push_back({static_cast<std::uint32_t>(wrapped_row * nodes.x + wrapped), footprint.sign,
                                           footprint.z()});
                    }
                }
            }
            too_many = too_many || entries.size() > most_crossings / 8;
        }
    }, 0.0f);

    Grid grid;
    grid.first.assign(static_cast<std::size_t>(nodes.x) * nodes.y + 1, 0);
    std::size_t total = 0;
    for (const std::vector<Entry>& entries : parts) {
        total += entries.size();
        for (const Entry& entry : entries) {
            grid.first[entry.column + 1] += 1;
        }
    }
    if (too_many || total > most_crossings) {
        throw InvalidArgument("the tile's triangles cover the tile too many times over; make them smaller or the period larger");
    }
    for (std::size_t i = 1; i < grid.first.size(); ++i) {
        grid.first[i] += grid.first[i - 1];
    }
    grid.crossings.resize(total);
    std::vector<std::size_t> next(grid.first.begin(), grid.first.end() - 1);
    for (std::vector<Entry>& entries : parts) {
        for (const Entry& entry : entries) {
            grid.crossings[next[entry.column]++] = {entry.z, entry.sign};
        }
        entries = {};
    }
    parallel_for(job, nodes.y, [&](int row) {
        for (std::size_t column = static_cast<std::size_t>(row) * nodes.x; column < static_cast<std::size_t>(row + 1) * nodes.x;
             ++column) {
            std::sort(grid.crossings.begin() + static_cast<std::ptrdiff_t>(grid.first[column]),
                      grid.crossings.begin() + static_cast<std::ptrdiff_t>(grid.first[column + 1]), downward);
        }
    }, 0.0f);
    return grid;
}

std::vector<std::uint8_t> classify_by_columns(const PeriodicMesh& mesh, const glm::ivec2& nodes, std::span<const float> z,
                                              Job& job)
{
    const Columns::Grid grid = Columns(mesh).grid(nodes, job);
    const std::size_t layer = static_cast<std::size_t>(nodes.x) * nodes.y;
    std::vector<std::uint8_t> inside(layer * z.size());
    parallel_for(job, nodes.y, [&](int row) {
        for (std::size_t column = static_cast<std::size_t>(row) * nodes.x; column < static_cast<std::size_t>(row + 1) * nodes.x;
             ++column) {
            std::size_t next = grid.first[column];
            int winding = 0;
            for (std::size_t k = z.size(); k-- > 0;) {
                const double node = z[k];
                for (; next < grid.first[column + 1] && (grid.crossings[next].z > node ||
                                                         (grid.crossings[next].z == node && grid.crossings[next].sign > 0));
                     ++next) {
                    winding += grid.crossings[next].sign;
                }
                inside[k * layer + column] = winding != 0 ? 1 : 0;
            }
        }
    });
    return inside;
}

glm::ivec2 winding_range(const PeriodicMesh& mesh, Job& job)
{
    const glm::ivec2 nodes(127, 129);
    const Columns::Grid grid = Columns(mesh).grid(nodes, job);
    glm::ivec2 range(0);
    for (std::size_t column = 0; column + 1 < grid.first.size(); ++column) {
        int winding = 0;
        for (std::size_t i = grid.first[column]; i < grid.first[column + 1]; ++i) {
            winding += grid.crossings[i].sign;
            if (i + 1 == grid.first[column + 1] || grid.crossings[i].z - grid.crossings[i + 1].z > tie) {
                range = glm::ivec2(std::min(range.x, winding), std::max(range.y, winding));
            }
        }
    }
    return range;
}

}  // namespace mesoshell
