#include "realize_prism.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>

#include "flat_fill.h"
#include "plane_side.h"

namespace mesoshell {
namespace {

int next(int i)
{
    return (i + 1) % 3;
}

bool in_order(const TileCorner& a, const TileCorner& b)
{
    return std::tie(a.uv.x, a.uv.y, a.w) < std::tie(b.uv.x, b.uv.y, b.w);
}

double cross(const glm::dvec2& a, const glm::dvec2& b)
{
    return a.x * b.y - a.y * b.x;
}

double ratio(Wide part, Wide whole)
{
    return static_cast<double>(part) / static_cast<double>(whole);
}

// From a to b by a share; at its ends exactly these.
double between(double a, double b, double share)
{
    return share == 1.0 ? b : a + (b - a) * share;
}

// How far along a to b a point of that line is.
double share_along(const glm::i64vec2& a, const glm::i64vec2& b, const glm::i64vec2& p)
{
    const int axis = std::abs(b.x - a.x) >= std::abs(b.y - a.y) ? 0 : 1;
    return static_cast<double>(p[axis] - a[axis]) / static_cast<double>(b[axis] - a[axis]);
}

}  // namespace

// A corner of the clipped outline: one of the tile's triangle, one of its edges on a fin, or the triangle on a column; and
// what the outline follows from there, an edge (0 to 2) or a fin (3 to 5).
struct PrismClip::Vertex {
    enum Kind { corner, edge_on_fin, column } kind;
    int a;  // corner, edge or column
    int fin;
    int follows;
};

PrismClip::PrismClip(const ChartPrism& prism, bool upright)
    : prism_(prism), upright_(upright), tile_{}, inside_{}, crossings_{}
{
    lower_ = upper_ = prism.corners[0].uv;
    for (const ChartCorner& c : prism.corners) {
        lower_ = glm::min(lower_, glm::min(c.uv, c.uv_top));
        upper_ = glm::max(upper_, glm::max(c.uv, c.uv_top));
    }
}

// Columns where all is straight are exact; else at a height, in tiles times one_tile.
glm::dvec2 PrismClip::uv_at(int column, double w) const
{
    const ChartCorner& c = prism_.corners[column];
    return glm::dvec2(c.uv) + glm::dvec2(c.uv_top - c.uv) * w;
}

bool PrismClip::corner_inside(int corner, int fin) const
{
    // In the order of the shell's vertices, which both prisms know.
    const bool forward = prism_.corners[fin].vertex < prism_.corners[next(fin)].vertex;
    const int low = forward ? fin : next(fin);
    const int high = forward ? next(fin) : fin;
    const TileCorner& p = tile_[corner];
    if (upright_) {
        return tile_left_of(prism_.corners[low].uv, prism_.corners[high].uv, p.uv) == forward;
    }
    // Differences of whole numbers first, for these are the same in all copies of the tile.
    const ChartCorner& a = prism_.corners[low];
    const ChartCorner& b = prism_.corners[high];
    const glm::dvec2 slant_a(a.uv_top - a.uv);
    const glm::dvec2 along = glm::dvec2(b.uv - a.uv) + (glm::dvec2(b.uv_top - b.uv) - slant_a) * p.w;
    const double side = cross(along, glm::dvec2(p.uv - a.uv) - slant_a * p.w);
    return (side != 0.0 ? side > 0.0 : moved_left(b.uv - a.uv)) == forward;
}

bool PrismClip::column_left_of(int edge, int column) const
{
    const bool turned = in_order(tile_[next(edge)], tile_[edge]);
    const TileCorner& a = tile_[turned ? next(edge) : edge];
    const TileCorner& b = tile_[turned ? edge : next(edge)];
    return shell_left_of(a.uv, b.uv, prism_.corners[column].uv) != turned;
}

bool PrismClip::inside(const Vertex& vertex, int fin) const
{
    if (vertex.kind == Vertex::corner) {
        return inside_[vertex.a][fin];
    }
    if (vertex.kind == Vertex::column || vertex.fin == fin) {
        return true;  // on this fin, or where the two others meet
    }
    const bool shared_is_end = fin == next(vertex.fin);
    if (!upright_) {
        const bool forward = prism_.corners[vertex.fin].vertex < prism_.corners[next(vertex.fin)].vertex;
        const double along = crossings_[vertex.a][vertex.fin].along;
        return shared_is_end == forward ? along < 1.0 : along > 0.0;
    }
    // An edge that enters through a fin and has the fin's end on its right crosses it before that end.
    const bool enters = !inside_[vertex.a][vertex.fin];
    const bool left = column_left_of(vertex.a, shared_is_end ? next(vertex.fin) : vertex.fin);
    return (shared_is_end ? !left : left) == enters;
}

void PrismClip::add(const Tile& tile, std::uint32_t triangle, const glm::ivec2& copy)
{
    tile_ = tile.triangles[triangle];
    for (TileCorner& corner : tile_) {
        corner.uv += glm::i64vec2(copy) * one_tile;
    }
    for (int k = 0; k < 3; ++k) {
        bool any = false;
        for (int i = 0; i < 3; ++i) {
            inside_[i][k] = corner_inside(i, k);
            any = any || inside_[i][k];
        }
        if (!any) {
            return;
        }
    }
    for (int edge = 0; edge < 3 && !upright_; ++edge) {
        for (int fin = 0; fin < 3; ++fin) {
            if (inside_[edge][fin] != inside_[next(edge)][fin]) {
                crossings_[edge][fin] = cross_bent_fin(fin, edge);
            }
        }
    }
    // Sutherland and Hodgman's clipping, with names of points in place of points.
    constexpr std::size_t most_corners = 12;
    std::array<Vertex, most_corners> outline{};
    std::size_t count = 3;
    for (int i = 0; i < 3; ++i) {
        outline[i] = {Vertex::corner, i, -1, i};
    }
    for (int fin = 0; fin < 3 && count > 0; ++fin) {
        std::array<Vertex, most_corners> kept{};
        std::size_t kept_count = 0;
        for (std::size_t i = 0; i < count && kept_count + 2 <= most_corners; ++i) {
            const Vertex& from = outline[i];
            const Vertex& to = outline[(i + 1) % count];
            const bool from_inside = inside(from, fin);
            const bool to_inside = inside(to, fin);
            if (from_inside) {
                kept[kept_count++] = from;
            }
            if (from_inside != to_inside) {
                const bool on_edge = from.follows < 3;
                const int other = from.follows - 3;
                // Fins i and i + 1 meet at column i + 1.
                const int column = fin == next(other) ? fin : other;
                kept[kept_count++] = {on_edge ? Vertex::edge_on_fin : Vertex::column, on_edge ? from.follows : column, fin,
                                      from_inside ? 3 + fin : from.follows};
            }
        }
        outline = kept;
        count = kept_count;
    }
    std::array<PrismPoint, most_corners> points;
    for (std::size_t i = 0; i < count; ++i) {
        points[i] = place(outline[i]);
    }
    for (std::size_t i = 0; i < count; ++i) {
        const int fin = outline[i].follows - 3;
        if (fin >= 0 && prism_.open[fin]) {
            cuts_[fin].push_back({points[i], points[(i + 1) % count], tile.groups[triangle], triangle, copy});
        }
    }
    for (std::size_t i = 2; i < count; ++i) {
        triangles_.push_back({{points[0], points[i - 1], points[i]}, triangle, copy, false});
    }
}

PrismPoint PrismClip::on_column(int column, double w) const
{
    PrismPoint p;
    p.weight[column] = 1.0;
    p.w = w;
    return p;
}

PrismPoint PrismClip::on_fin(int fin, double along_from_lesser, double w) const
{
    const bool forward = prism_.corners[fin].vertex < prism_.corners[next(fin)].vertex;
    PrismPoint p;
    p.weight[forward ? next(fin) : fin] = along_from_lesser;
    p.weight[forward ? fin : next(fin)] = 1.0 - along_from_lesser;
    p.w = w;
    return p;
}

PrismPoint PrismClip::place_of_corner(const TileCorner& corner) const
{
    const std::array<ChartCorner, 3>& c = prism_.corners;
    if (upright_) {
        const Wide whole = area_of(c[0].uv, c[1].uv, c[2].uv);
        std::array<Wide, 3> part;
        int zeros = 0;
        int zero = 0;
        int rest = 0;
        for (int i = 0; i < 3; ++i) {
            part[i] = area_of(c[next(i)].uv, c[next(next(i))].uv, corner.uv);
            zeros += part[i] == 0 ? 1 : 0;
            zero = part[i] == 0 ? i : zero;
            rest = part[i] != 0 ? i : rest;
        }
        if (zeros == 2) {
            return on_column(rest, corner.w);
        }
        if (zeros == 1) {
            const int fin = next(zero);
            const bool forward = c[fin].vertex < c[next(fin)].vertex;
            const ChartCorner& low = c[forward ? fin : next(fin)];
            const ChartCorner& high = c[forward ? next(fin) : fin];
            return on_fin(fin, share_along(low.uv, high.uv, corner.uv), corner.w);
        }
        return {{ratio(part[0], whole), ratio(part[1], whole), ratio(part[2], whole)}, corner.w};
    }
    const glm::dvec2 origin = uv_at(0, corner.w);
    const glm::dvec2 e1 = uv_at(1, corner.w) - origin;
    const glm::dvec2 e2 = uv_at(2, corner.w) - origin;
    const glm::dvec2 p = glm::dvec2(corner.uv) - origin;
    const double area = cross(e1, e2);
    const double b1 = std::max(0.0, cross(p, e2) / area);
    const double b2 = std::max(0.0, cross(e1, p) / area);
    return {{std::max(0.0, 1.0 - b1 - b2), b1, b2}, corner.w};
}

// The height of the edge where the column meets it.
double PrismClip::height_at_column(int edge, int column) const
{
    const bool turned = in_order(tile_[next(edge)], tile_[edge]);
    const TileCorner& a = tile_[turned ? next(edge) : edge];
    const TileCorner& b = tile_[turned ? edge : next(edge)];
    return between(a.w, b.w, share_along(a.uv, b.uv, prism_.corners[column].uv));
}

PrismPoint PrismClip::place_on_fin(int fin, int edge) const
{
    if (!upright_) {
        const Crossing& crossing = crossings_[edge][fin];
        return on_fin(fin, std::clamp(crossing.along, 0.0, 1.0), crossing.w);
    }
    const bool forward = prism_.corners[fin].vertex < prism_.corners[next(fin)].vertex;
    const int low_column = forward ? fin : next(fin);
    const int high_column = forward ? next(fin) : fin;
    const ChartCorner& low = prism_.corners[low_column];
    const ChartCorner& high = prism_.corners[high_column];
    const bool turned = in_order(tile_[next(edge)], tile_[edge]);
    const TileCorner& a = tile_[turned ? next(edge) : edge];
    const TileCorner& b = tile_[turned ? edge : next(edge)];
    const Wide side_low = area_of(a.uv, b.uv, low.uv);
    const Wide side_high = area_of(a.uv, b.uv, high.uv);
    if (side_low == 0) {
        return on_column(low_column, height_at_column(edge, low_column));
    }
    if (side_high == 0) {
        return on_column(high_column, height_at_column(edge, high_column));
    }
    const Wide side_a = area_of(low.uv, high.uv, a.uv);
    const Wide side_b = area_of(low.uv, high.uv, b.uv);
    if (side_a == 0 || side_b == 0) {
        const TileCorner& corner = side_a == 0 ? a : b;
        return on_fin(fin, share_along(low.uv, high.uv, corner.uv), corner.w);
    }
    return on_fin(fin, ratio(side_low, side_low - side_high), between(a.w, b.w, ratio(side_a, side_a - side_b)));
}

PrismClip::Crossing PrismClip::cross_bent_fin(int fin, int edge) const
{
    const bool forward = prism_.corners[fin].vertex < prism_.corners[next(fin)].vertex;
    const int low_column = forward ? fin : next(fin);
    const int high_column = forward ? next(fin) : fin;
    const ChartCorner& low = prism_.corners[low_column];
    const ChartCorner& high = prism_.corners[high_column];
    const bool turned = in_order(tile_[next(edge)], tile_[edge]);
    const TileCorner& a = tile_[turned ? next(edge) : edge];
    const TileCorner& b = tile_[turned ? edge : next(edge)];
    // The side of the fin along the edge is a cubic with one sign change; it is halved, always in the same order.
    const glm::dvec2 slant_low(low.uv_top - low.uv);
    const glm::dvec2 slant_high(high.uv_top - high.uv);
    const auto side_at = [&](double share, double& along) {
        const double w = between(a.w, b.w, share);
        const glm::dvec2 fin_along = glm::dvec2(high.uv - low.uv) + (slant_high - slant_low) * w;
        const glm::dvec2 p = glm::dvec2(a.uv - low.uv) + glm::dvec2(b.uv - a.uv) * share - slant_low * w;
        along = glm::dot(p, fin_along) / glm::dot(fin_along, fin_along);
        return cross(fin_along, p);
    };
    double along = 0.0;
    double first = 0.0;
    double last = 1.0;
    const bool first_left = inside_[turned ? next(edge) : edge][fin] == forward;  // also where it is on the fin
    for (int i = 0; i < 48; ++i) {
        const double share = 0.5 * (first + last);
        (side_at(share, along) > 0.0 ? first_left : !first_left) ? first = share : last = share;
    }
    side_at(0.5 * (first + last), along);
    return {along, between(a.w, b.w, 0.5 * (first + last))};
}

PrismPoint PrismClip::place_on_column(int column) const
{
    const ChartCorner& c = prism_.corners[column];
    if (upright_) {
        std::array<Wide, 3> part;
        for (int i = 0; i < 3; ++i) {
            part[i] = area_of(tile_[next(i)].uv, tile_[next(next(i))].uv, c.uv);
        }
        for (int i = 0; i < 3; ++i) {
            if (part[i] == 0 && part[next(i)] == 0) {
                return on_column(column, tile_[next(next(i))].w);
            }
        }
        for (int i = 0; i < 3; ++i) {
            if (part[i] == 0) {
                return on_column(column, height_at_column(next(i), column));
            }
        }
        const Wide whole = part[0] + part[1] + part[2];
        return on_column(column, tile_[0].w * ratio(part[0], whole) + tile_[1].w * ratio(part[1], whole) +
                                     tile_[2].w * ratio(part[2], whole));
    }
    std::array<glm::dvec2, 3> to;
    for (int i = 0; i < 3; ++i) {
        to[i] = glm::dvec2(tile_[i].uv - c.uv) - glm::dvec2(c.uv_top - c.uv) * tile_[i].w;
    }
    const double whole = cross(to[1] - to[0], to[2] - to[0]);
    double w = 0.0;
    for (int i = 0; i < 3; ++i) {
        w += tile_[i].w * cross(to[next(i)], to[next(next(i))]) / whole;
    }
    const auto [low, high] = std::minmax({tile_[0].w, tile_[1].w, tile_[2].w});
    return on_column(column, w >= low && w <= high ? w : 0.5 * (low + high));
}

PrismPoint PrismClip::place(const Vertex& vertex) const
{
    switch (vertex.kind) {
    case Vertex::corner: return place_of_corner(tile_[vertex.a]);
    case Vertex::edge_on_fin: return place_on_fin(vertex.fin, vertex.a);
    default: return place_on_column(vertex.a);
    }
}

void PrismClip::cap_open_fins()
{
    for (int fin = 0; fin < 3; ++fin) {
        std::vector<Cut>& cuts = cuts_[fin];
        std::stable_sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.group < b.group; });
        for (std::size_t begin = 0, end = 0; begin < cuts.size(); begin = end) {
            for (end = begin + 1; end < cuts.size() && cuts[end].group == cuts[begin].group; ++end) {
            }
            cap_fin(fin, std::span<const Cut>(cuts).subspan(begin, end - begin));
        }
    }
}

// Seen from outside the prism, the fin is a square of the share along it and the height.
void PrismClip::cap_fin(int fin, std::span<const Cut> cuts)
{
    constexpr double square = 0x1p30;
    std::map<std::pair<std::int64_t, std::int64_t>, std::uint32_t> index;
    std::vector<glm::i64vec2> points;
    std::vector<PrismPoint> places;
    const auto find_or_add = [&](const PrismPoint& p) {
        const glm::i64vec2 at(std::llround(p.weight[next(fin)] * square), std::llround(p.w * square));
        const auto [found, added] = index.try_emplace({at.x, at.y}, static_cast<std::uint32_t>(points.size()));
        if (added) {
            points.push_back(at);
            places.push_back(p);
        }
        return found->second;
    };
    const std::array<std::uint32_t, 4> corners{find_or_add(on_column(fin, 0.0)), find_or_add(on_column(next(fin), 0.0)),
                                               find_or_add(on_column(next(fin), 1.0)), find_or_add(on_column(fin, 1.0))};
    std::vector<glm::uvec2> segments;
    for (const Cut& cut : cuts) {
        const std::uint32_t from = find_or_add(cut.from);
        const std::uint32_t to = find_or_add(cut.to);
        if (from != to) {
            segments.emplace_back(to, from);
        }
    }
    if (!close_along_border(points, corners, false, segments)) {
        return;
    }
    // The cap shows what the tile has beside it.
    const Cut& beside = cuts.front();
    for (const glm::uvec3& t : fill_region(points, segments)) {
        triangles_.push_back({{places[t.x], places[t.y], places[t.z]}, beside.tile_triangle, beside.copy, true});
    }
}

}  // namespace mesoshell
