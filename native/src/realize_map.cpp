#include "realize_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "closest_point.h"
#include "plane_side.h"

namespace mesoshell {
namespace {

// An edge is halved no more often than this, whatever the error asked.
constexpr int most_halvings = 10;

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
             double tile_width, RealizedPart& part)
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
    RealizedPart& part_;
    std::array<int, 3> order_{0, 1, 2};
    const PrismTriangle* triangle_ = nullptr;
};

}  // namespace

void map_prism(const ChartPrism& prism, std::span<const PrismTriangle> triangles, const Sample& sample, const Tile& tile,
               const RealizeOptions& options, double tile_width, RealizedPart& part)
{
    PrismMap map(prism, sample, tile, options, tile_width, part);
    for (const PrismTriangle& t : triangles) {
        map.add(t);
    }
}

}  // namespace mesoshell
