// The sheared-slice rasterizer: the rays of one direction from every node of every slice, a triangle at a time.
//
// Sheared along the direction, the rays of a slice become the nodes of one lattice, and every slice has the same lattice, only
// shifted. A lane is a slice: the small triangles of a tile cover about one node of a lattice, but that of many slices. Edges are
// tested in fixed point, so that two triangles that share an edge never both miss a ray, nor both own it.
#include <algorithm>
#include <cstdint>

#include "functions.h"
#include "lanes.h"

namespace mesoshell::simd {
namespace {

constexpr std::int32_t step = 1 << lattice_bits;
// Rows of nodes that a triangle whose edge functions fit 32 bits may span.
constexpr int most_rows = 128;
// A node this little behind a surface lies on it. Tile widths.
constexpr float on_surface = 1e-6f;

// One triangle, counterclockwise, relative to its first corner. The edge function of an edge is positive to its left.
struct Triangle {
    std::int32_t ax, ay;
    std::int32_t bx, by, cx, cy;
    std::int64_t area;              // twice
    std::int32_t bias_ab, bias_bc, bias_ca;  // -1 where points on the edge belong to the neighbor
    std::int32_t x_min, y_min;
    std::int32_t x_extent, y_extent;
    float a_rest_x, a_rest_y;
    float t, t_x, t_y;              // at the first corner, and its slopes a fixed-point step
    float t_min, t_max;             // over the triangle
    float least_distance;           // what counts as ahead
    int first_group, last_group;    // of the slices that may see it
};

// Points on an edge belong to the triangle for which the edge is a left one, or a level one at the bottom.
std::int32_t edge_bias(std::int32_t x, std::int32_t y)
{
    return y < 0 || (y == 0 && x > 0) ? 0 : -1;
}

bool set_up(const Slices& slices, int index, int groups, Triangle& triangle)
{
    const std::uint32_t* corner = slices.corners + 3 * static_cast<std::size_t>(index);
    std::uint32_t a = corner[0];
    std::uint32_t b = corner[1];
    std::uint32_t c = corner[2];
    std::int64_t area = std::int64_t(slices.x[b] - slices.x[a]) * (slices.y[c] - slices.y[a]) -
                        std::int64_t(slices.y[b] - slices.y[a]) * (slices.x[c] - slices.x[a]);
    if (area == 0 || (slices.keep_sign != 0 && (area > 0) != (slices.keep_sign > 0))) {
        return false;
    }
    if (area < 0) {
        std::swap(b, c);
        area = -area;
    }
    triangle.t_min = std::min(slices.t[a], std::min(slices.t[b], slices.t[c]));
    triangle.t_max = std::max(slices.t[a], std::max(slices.t[b], slices.t[c]));
    // Slices whose nodes lie before the triangle: those with slice_t <= t_max.
    const float last = (triangle.t_max + on_surface - slices.slice_t[0]) / slices.slice_t_step;
    if (slices.slice_t_step > 0.0f) {
        if (last < 0.0f) {
            return false;
        }
        triangle.first_group = 0;
        triangle.last_group = std::min(static_cast<int>(std::min(last, 1e6f)) / lanes, groups - 1);
    } else {
        if (last > static_cast<float>(slices.nz - 1)) {
            return false;
        }
        triangle.first_group = static_cast<int>(std::max(last, 0.0f)) / lanes;
        triangle.last_group = groups - 1;
    }

    triangle.ax = slices.x[a];
    triangle.ay = slices.y[a];
    triangle.bx = slices.x[b] - triangle.ax;
    triangle.by = slices.y[b] - triangle.ay;
    triangle.cx = slices.x[c] - triangle.ax;
    triangle.cy = slices.y[c] - triangle.ay;
    triangle.area = area;
    triangle.bias_ab = edge_bias(triangle.bx, triangle.by);
    triangle.bias_bc = edge_bias(triangle.cx - triangle.bx, triangle.cy - triangle.by);
    triangle.bias_ca = edge_bias(-triangle.cx, -triangle.cy);
    triangle.x_min = triangle.ax + std::min(0, std::min(triangle.bx, triangle.cx));
    triangle.y_min = triangle.ay + std::min(0, std::min(triangle.by, triangle.cy));
    triangle.x_extent = triangle.ax + std::max(0, std::max(triangle.bx, triangle.cx)) - triangle.x_min;
    triangle.y_extent = triangle.ay + std::max(0, std::max(triangle.by, triangle.cy)) - triangle.y_min;

    // Slopes of the triangle as it is, not as it was rounded: rounding may move an edge by a step, never a depth.
    triangle.a_rest_x = slices.x_rest[a];
    triangle.a_rest_y = slices.y_rest[a];
    const double bx = triangle.bx + (slices.x_rest[b] - triangle.a_rest_x);
    const double by = triangle.by + (slices.y_rest[b] - triangle.a_rest_y);
    const double cx = triangle.cx + (slices.x_rest[c] - triangle.a_rest_x);
    const double cy = triangle.cy + (slices.y_rest[c] - triangle.a_rest_y);
    const double bt = static_cast<double>(slices.t[b]) - slices.t[a];
    const double ct = static_cast<double>(slices.t[c]) - slices.t[a];
    const double determinant = std::max(bx * cy - by * cx, 0.5);
    triangle.t = slices.t[a];
    triangle.t_x = static_cast<float>((bt * cy - ct * by) / determinant);
    triangle.t_y = static_cast<float>((ct * bx - bt * cx) / determinant);
    triangle.least_distance = slices.keep_sign != 0 ? -on_surface : 0.0f;
    return true;
}

// 0 <= value < period, for values within some thousand periods.
Ints wrapped(const Ints& value, int period)
{
    const Floats share = __builtin_convertvector(value, Floats) * (1.0f / static_cast<float>(period));
    Ints turns = __builtin_convertvector(share, Ints);
    turns += __builtin_convertvector(turns, Floats) > share;  // toward minus infinity; true is -1
    Ints rest = value - turns * period;
    rest += (rest < 0) & period;
    rest -= (rest >= period) & period;
    return rest;
}

// The same for values below two periods.
inline Ints once_wrapped(const Ints& value, int period)
{
    return value - ((value >= period) & period);
}

// What the two rasterizers share: a group of slices, lane by lane.
struct Group {
    Ints dx, dy;         // first node to test, relative to the triangle's first corner
    Ints column, row;    // its place in the lattice
    Floats t;            // distance there
    Floats slice_t;
    int first_slice;
};

inline Group start_group(const Slices& slices, const Triangle& triangle, int group)
{
    Group g;
    g.first_slice = group * lanes;
    const Ints slice_x = load<Ints>(slices.slice_x + g.first_slice);
    const Ints slice_y = load<Ints>(slices.slice_y + g.first_slice);
    const Ints i = (triangle.x_min - slice_x + (step - 1)) >> lattice_bits;
    const Ints j = (triangle.y_min - slice_y + (step - 1)) >> lattice_bits;
    g.dx = (i << lattice_bits) + slice_x - triangle.ax;
    g.dy = (j << lattice_bits) + slice_y - triangle.ay;
    g.column = wrapped(i, slices.nx);
    g.row = wrapped(j, slices.ny);
    g.slice_t = load<Floats>(slices.slice_t + g.first_slice);
    const Floats x = __builtin_convertvector(g.dx, Floats) +
                     (load<Floats>(slices.slice_x_rest + g.first_slice) - triangle.a_rest_x);
    const Floats y = __builtin_convertvector(g.dy, Floats) +
                     (load<Floats>(slices.slice_y_rest + g.first_slice) - triangle.a_rest_y);
    g.t = (triangle.t - g.slice_t) + triangle.t_x * x + triangle.t_y * y;
    return g;
}

inline Floats clamped(const Floats& value, const Floats& low, const Floats& high)
{
    const Floats raised = value < low ? low : value;
    return raised > high ? high : raised;
}

// Keeps the distances of the lanes whose bit is set where they are nearer.
inline void keep_nearest(unsigned hits, const Ints& index, const Floats& distance, float* nearest)
{
    alignas(64) std::int32_t indices[lanes];
    alignas(64) float distances[lanes];
    store(indices, index);
    store(distances, distance);
    for (; hits != 0; hits &= hits - 1) {
        const int lane = __builtin_ctz(hits);
        float& value = nearest[indices[lane]];
        value = distances[lane] < value ? distances[lane] : value;
    }
}


// Columns [first, last] of a row of nodes that may lie in the triangle, whatever the slice: nodes of a row lie within one step of
// each other across the lanes.
struct Span {
    int first, last;
};

Span row_span(const Triangle& triangle, int row)
{
    const double low = triangle.y_min - triangle.ay + double(step) * row;
    const double high = low + step;
    const double x[3] = {0.0, double(triangle.bx), double(triangle.cx)};
    const double y[3] = {0.0, double(triangle.by), double(triangle.cy)};
    double least = 1e30;
    double most = -1e30;
    for (int i = 0; i < 3; ++i) {
        const int k = (i + 1) % 3;
        if (y[i] >= low && y[i] <= high) {
            least = std::min(least, x[i]);
            most = std::max(most, x[i]);
        }
        for (const double level : {low, high}) {
            if ((y[i] < level) != (y[k] < level)) {
                const double crossing = x[i] + (x[k] - x[i]) * ((level - y[i]) / (y[k] - y[i]));
                least = std::min(least, crossing);
                most = std::max(most, crossing);
            }
        }
    }
    if (least > most) {
        return {0, -1};
    }
    const double origin = triangle.x_min - triangle.ax;
    // A fixed-point step more on both sides, for the rounding of crossings.
    return {std::max(0, static_cast<int>((least - origin - 1.0) * (1.0 / step))),
            std::min(triangle.x_extent >> lattice_bits, static_cast<int>((most - origin + 1.0) * (1.0 / step)))};
}

// Whether the edge functions fit 32 bits at every node within two steps of the triangle. Long products on the way to them may
// not, and need not: sums modulo 2^32 come out right.
bool fits_32_bits(const Triangle& triangle)
{
    const double around = 3.0 * step * (double(triangle.x_extent) + triangle.y_extent + step);
    return double(triangle.area) + around < double(1u << 31) && (triangle.y_extent >> lattice_bits) < most_rows;
}

void rasterize_small(const Slices& slices, const Triangle& triangle, float* nearest)
{
    // What a row adds to the values at the first node of all, at the first column that it needs.
    struct Row {
        Span span;
        std::uint32_t ab, bc, ca;
        float t;
    };
    Row row_list[most_rows];
    const int columns = (triangle.x_extent >> lattice_bits) + 1;
    const int rows = (triangle.y_extent >> lattice_bits) + 1;
    const bool within_period = columns <= slices.nx && rows <= slices.ny;
    const auto bx = static_cast<std::uint32_t>(triangle.bx);
    const auto by = static_cast<std::uint32_t>(triangle.by);
    const auto cx = static_cast<std::uint32_t>(triangle.cx);
    const auto cy = static_cast<std::uint32_t>(triangle.cy);
    const std::uint32_t ab_column = 0u - by * step;
    const std::uint32_t ca_column = cy * step;
    const std::uint32_t bc_column = 0u - ab_column - ca_column;
    const float t_column = triangle.t_x * step;
    for (int j = 0; j < rows; ++j) {
        Row& row = row_list[j];
        row.span = columns <= 2 ? Span{0, columns - 1} : row_span(triangle, j);
        const auto first = static_cast<std::uint32_t>(row.span.first);
        row.ab = bx * step * static_cast<std::uint32_t>(j) + ab_column * first;
        row.ca = ca_column * first - cx * step * static_cast<std::uint32_t>(j);
        row.bc = 0u - row.ab - row.ca;
        row.t = triangle.t_y * step * static_cast<float>(j) + t_column * static_cast<float>(row.span.first);
    }
    const auto area = static_cast<std::uint32_t>(triangle.area);
    for (int group = triangle.first_group; group <= triangle.last_group; ++group) {
        const Group g = start_group(slices, triangle, group);
        const auto dx = reinterpret_cast<Uints>(g.dx);
        const auto dy = reinterpret_cast<Uints>(g.dy);
        const Uints ab_first = bx * dy - by * dx;
        const Uints ca_first = cy * dx - cx * dy;
        const Uints bc_first = area - ab_first - ca_first + static_cast<std::uint32_t>(triangle.bias_bc);
        const Uints ab_biased = ab_first + static_cast<std::uint32_t>(triangle.bias_ab);
        const Uints ca_biased = ca_first + static_cast<std::uint32_t>(triangle.bias_ca);
        const Ints slice = lane_numbers + g.first_slice;
        for (int j = 0; j < rows; ++j) {
            const Row& row = row_list[j];
            Uints ab = ab_biased + row.ab;
            Uints bc = bc_first + row.bc;
            Uints ca = ca_biased + row.ca;
            Floats t = g.t + row.t;
            for (int i = row.span.first; i <= row.span.last; ++i) {
                const Ints outside = reinterpret_cast<Ints>(ab | bc | ca) | (t < triangle.least_distance);
                const unsigned hits = ~sign_bits(outside) & ((1u << lanes) - 1);
                if (hits != 0) {
                    const Floats low = triangle.t_min - g.slice_t;
                    const Floats high = triangle.t_max - g.slice_t;
                    const Floats distance = clamped(t, low, high);
                    const Ints column = g.column + i;
                    const Ints line = g.row + j;
                    const Ints place = within_period ? once_wrapped(line, slices.ny) * slices.nx + once_wrapped(column, slices.nx)
                                                     : wrapped(line, slices.ny) * slices.nx + wrapped(column, slices.nx);
                    keep_nearest(hits, place * slices.nz + slice,
                                 distance < 0.0f ? Floats{} : distance, nearest);
                }
                ab += ab_column;
                bc += bc_column;
                ca += ca_column;
                t += t_column;
            }
        }
    }
}

void rasterize_large(const Slices& slices, const Triangle& triangle, float* nearest)
{
    const int rows = (triangle.y_extent >> lattice_bits) + 1;
    const float t_column = triangle.t_x * step;
    const float t_row = triangle.t_y * step;
    for (int j = 0; j < rows; ++j) {
        const Span span = row_span(triangle, j);
        if (span.first > span.last) {
            continue;
        }
        for (int group = triangle.first_group; group <= triangle.last_group; ++group) {
            const Group g = start_group(slices, triangle, group);
            const Doubles dx = __builtin_convertvector(g.dx, Doubles) + double(span.first) * step;
            const Doubles dy = __builtin_convertvector(g.dy, Doubles) + double(j) * step;
            Doubles ab = double(triangle.bx) * dy - double(triangle.by) * dx;
            Doubles ca = double(triangle.cy) * dx - double(triangle.cx) * dy;
            Doubles bc = double(triangle.area) - ab - ca + double(triangle.bias_bc);
            ab += double(triangle.bias_ab);
            ca += double(triangle.bias_ca);
            Ints column = wrapped(g.column + span.first, slices.nx);
            const Ints row = wrapped(g.row + j, slices.ny);
            Floats t = g.t + t_column * static_cast<float>(span.first) + t_row * static_cast<float>(j);
            const Ints slice = lane_numbers + g.first_slice;
            for (int i = span.first; i <= span.last; ++i) {
                const auto outside_edges = (ab < 0.0) | (bc < 0.0) | (ca < 0.0);
                const Ints outside = __builtin_convertvector(outside_edges, Ints) | (t < triangle.least_distance);
                const unsigned hits = ~sign_bits(outside) & ((1u << lanes) - 1);
                if (hits != 0) {
                    const Floats low = triangle.t_min - g.slice_t;
                    const Floats high = triangle.t_max - g.slice_t;
                    const Floats distance = clamped(t, low, high);
                    keep_nearest(hits, (row * slices.nx + column) * slices.nz + slice,
                                 distance < 0.0f ? Floats{} : distance, nearest);
                }
                ab -= double(triangle.by) * step;
                ca += double(triangle.cy) * step;
                bc += double(triangle.by - triangle.cy) * step;
                t += t_column;
                column += 1;
                column -= (column >= slices.nx) & slices.nx;
            }
        }
    }
}

}  // namespace

void rasterize_slices(const Slices& slices, float* nearest)
{
    const int groups = (slices.nz + lanes - 1) / lanes;
    Triangle triangle;
    for (int i = 0; i < slices.triangle_count; ++i) {
        if (set_up(slices, i, groups, triangle)) {
            (fits_32_bits(triangle) ? rasterize_small : rasterize_large)(slices, triangle, nearest);
        }
    }
}

}  // namespace mesoshell::simd
