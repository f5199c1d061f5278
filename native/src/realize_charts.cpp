#include "realize_charts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <tuple>

#include "mesoshell/error.h"
#include "mesoshell/seams.h"
#include "plane_side.h"

namespace mesoshell {
namespace {

// Copies of the tile in one prism; more would take memory without end.
constexpr double most_copies = 4096.0;
// Beyond, single precision has no place within a tile.
constexpr double farthest_tile = 0x1p24;

double cross(const glm::dvec2& a, const glm::dvec2& b)
{
    return a.x * b.y - a.y * b.x;
}

struct PrismUvs {
    std::array<glm::dvec2, 3> base;
    std::array<glm::dvec2, 3> top;

    explicit PrismUvs(const PrismTexels& texels)
    {
        for (int i = 0; i < 3; ++i) {
            base[i] = glm::dvec2(texels[i].w, texels[6][i]);
            top[i] = glm::dvec2(texels[i + 3].w, texels[6 + (i + 3) / 4][(i + 3) % 4]);
        }
    }

    void check_span() const
    {
        glm::dvec2 low = base[0];
        glm::dvec2 high = base[0];
        for (int i = 0; i < 3; ++i) {
            low = glm::min(low, glm::min(base[i], top[i]));
            high = glm::max(high, glm::max(base[i], top[i]));
        }
        const glm::dvec2 count = glm::ceil(high) - glm::floor(low) + 1.0;
        if (count.x * count.y > most_copies) {
            throw InvalidArgument("the UVs of a prism span " + std::to_string(count.x) + " by " + std::to_string(count.y) +
                                  " tiles; use smaller UVs or more subdivision levels");
        }
        if (std::max(-std::min(low.x, low.y), std::max(high.x, high.y)) > farthest_tile) {
            throw InvalidArgument("the UVs of a prism lie " + std::to_string(farthest_tile) +
                                  " tiles from the origin or farther; use smaller UVs");
        }
    }

    double area_at(double w) const
    {
        const auto at = [&](int i) { return base[i] * (1.0 - w) + top[i] * w; };
        return cross(at(1) - at(0), at(2) - at(0));
    }

    // Whether the UVs turn over or lose their area between base and top: twice their signed area is quadratic in the height.
    bool turns_over() const
    {
        if (base == top) {
            return false;
        }
        const double bottom = area_at(0.0);
        const double end = area_at(1.0);
        const double square = 2.0 * (bottom + end) - 4.0 * area_at(0.5);
        const double linear = end - bottom - square;
        const double extreme = -linear / (2.0 * square);
        const bool inside = extreme > 0.0 && extreme < 1.0;
        return !(bottom * end > 0.0) || (inside && !(bottom * (bottom + (linear + square * extreme) * extreme) > 0.0));
    }
};

// Texture coordinates of a vertex modulo whole tiles; a vertex on a cut seam has several.
class Columns {
public:
    explicit Columns(std::size_t vertices) : columns_(vertices) {}

    // Makes a corner's UVs whole tiles from those of the vertex's column that they belong to, and returns the column and how
    // many tiles.
    std::pair<std::uint32_t, glm::i64vec2> snap(ChartCorner& corner)
    {
        const glm::i64vec2 slant = corner.uv_top - corner.uv;
        for (const Column& column : columns_[corner.vertex]) {
            const glm::i64vec2 apart = corner.uv - column.uv;
            const glm::i64vec2 tiles = (apart + one_tile / 2) >> glm::i64vec2(tile_bits);
            if (near(apart - tiles * one_tile) && near(slant - column.slant)) {
                corner.uv = column.uv + tiles * one_tile;
                corner.uv_top = corner.uv + column.slant;
                return {column.number, tiles};
            }
        }
        const glm::i64vec2 tiles = corner.uv >> glm::i64vec2(tile_bits);
        columns_[corner.vertex].push_back({corner.uv - tiles * one_tile, slant, count_});
        return {count_++, tiles};
    }

private:
    struct Column {
        glm::i64vec2 uv;
        glm::i64vec2 slant;
        std::uint32_t number;
    };

    static bool near(const glm::i64vec2& rest)
    {
        constexpr double most = static_cast<double>(seam_tolerance) * one_tile;
        return std::abs(static_cast<double>(rest.x)) <= most && std::abs(static_cast<double>(rest.y)) <= most;
    }

    std::vector<std::vector<Column>> columns_;
    std::uint32_t count_ = 0;
};

// Two columns and the whole tiles between them: a fin with its pattern.
using Fin = std::tuple<std::uint32_t, std::uint32_t, std::int64_t, std::int64_t>;

struct FinUse {
    std::uint32_t prism;
    std::uint8_t side;
    bool forward;  // seen from outside the shell, from the lesser column's vertex to the greater's
};

void measure_slant(const PrismUvs& uvs, Charts& charts)
{
    const glm::dmat2 base(uvs.base[1] - uvs.base[0], uvs.base[2] - uvs.base[0]);
    const glm::dmat2 top(uvs.top[1] - uvs.top[0], uvs.top[2] - uvs.top[0]);
    for (int i = 0; i < 3; ++i) {
        charts.most_slant = std::max(charts.most_slant, glm::length(uvs.top[i] - uvs.base[i]));
    }
    const glm::dmat2 change = (top - base) * glm::inverse(base);
    const double twist = std::sqrt(glm::dot(change[0], change[0]) + glm::dot(change[1], change[1]));
    charts.most_twist = std::max(charts.most_twist, twist);
}

}  // namespace

Charts charts_of(const Shell& shell, float aspect)
{
    Charts charts;
    charts.prisms.reserve(shell.prisms.size());
    Columns columns(shell.positions.size());
    std::map<Fin, std::vector<FinUse>> fins;
    double area = 0.0;
    for (std::uint32_t p = 0; p < shell.prisms.size(); ++p) {
        const PrismTexels& texels = shell.prisms[p];
        const PrismUvs uvs(texels);
        uvs.check_span();
        if (uvs.turns_over()) {
            throw InvalidArgument("the UVs of prism " + std::to_string(p) +
                                  " turn over between its base and its top; move those of the top less");
        }
        ChartPrism prism;
        prism.index = p;
        std::array<std::pair<std::uint32_t, glm::i64vec2>, 3> column;
        for (int i = 0; i < 3; ++i) {
            ChartCorner& corner = prism.corners[i];
            corner.vertex = shell.topology->triangles[p][i];
            corner.uv = glm::i64vec2(glm::round(uvs.base[i] * static_cast<double>(one_tile)));
            corner.uv_top = glm::i64vec2(glm::round(uvs.top[i] * static_cast<double>(one_tile)));
            corner.base = glm::dvec3(texels[i]);
            corner.rise = glm::dvec3(texels[i + 3]) - glm::dvec3(texels[i]);
            column[i] = columns.snap(corner);
        }
        const Wide covered = area_of(prism.corners[0].uv, prism.corners[1].uv, prism.corners[2].uv);
        if (covered == 0) {
            continue;
        }
        if (uvs.base != uvs.top) {
            charts.upright = false;
            measure_slant(uvs, charts);
        }
        const glm::dvec3 a = prism.corners[0].base;
        area += 0.5 * glm::length(glm::cross(prism.corners[1].base - a, prism.corners[2].base - a));
        charts.tiles += 0.5 * std::abs(static_cast<double>(covered)) / one_tile / one_tile;
        prism.mirrored = covered < 0;
        for (std::uint8_t i = 0; i < 3; ++i) {
            const std::uint8_t k = static_cast<std::uint8_t>((i + 1) % 3);
            const bool forward = column[i].first < column[k].first;
            const auto& low = column[forward ? i : k];
            const auto& high = column[forward ? k : i];
            const glm::i64vec2 tiles = high.second - low.second;
            // Of a mirrored prism, side i lies between corners 2 - i and 3 - i then.
            const std::uint8_t side = prism.mirrored ? static_cast<std::uint8_t>(2 - i) : i;
            fins[{low.first, high.first, tiles.x, tiles.y}].push_back(
                {static_cast<std::uint32_t>(charts.prisms.size()), side, forward});
        }
        if (prism.mirrored) {
            std::swap(prism.corners[1], prism.corners[2]);
        }
        charts.prisms.push_back(prism);
    }
    for (const auto& [fin, uses] : fins) {
        const bool closed = uses.size() == 2 && uses[0].forward != uses[1].forward;
        for (const FinUse& use : uses) {
            charts.prisms[use.prism].open[use.side] = !closed;
        }
    }
    charts.tile_width = charts.tiles > 0.0 ? std::sqrt(area / (charts.tiles * aspect)) : 1.0;
    return charts;
}

}  // namespace mesoshell
