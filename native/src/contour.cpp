#include "mesoshell/contour.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "mesoshell/error.h"
#include "parallel.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

// A corner of a cell is a code of three bits, x = 1, y = 2, z = 4. Going from corner 0 to corner 7 along the axes in each of
// the six orders makes six tetrahedra; two corners are swapped where the order is odd, so that all wind alike.
constexpr std::array<std::array<int, 4>, 6> tetrahedra{
    {{0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 3, 2, 7}, {0, 6, 4, 7}, {0, 5, 1, 7}}};

// By which of a tetrahedron's corners are inside (bits): an even order of the corners that begins with the one or two inside,
// or with the only one outside.
constexpr std::array<std::array<int, 4>, 16> even_orders{{{}, {0, 1, 2, 3}, {1, 0, 3, 2}, {0, 1, 2, 3},
                                                          {2, 3, 0, 1}, {0, 2, 3, 1}, {1, 2, 0, 3}, {3, 2, 1, 0},
                                                          {3, 2, 1, 0}, {0, 3, 1, 2}, {1, 3, 2, 0}, {2, 3, 0, 1},
                                                          {2, 3, 0, 1}, {1, 0, 3, 2}, {0, 1, 2, 3}, {}}};

glm::ivec3 offset_of(int code)
{
    return {code & 1, code >> 1 & 1, code >> 2};
}

class Contouring {
public:
    Contouring(std::span<const float> values, const glm::ivec3& nodes, float threshold, float height, float aspect, Job& job)
        : values_(values), nodes_(nodes), threshold_(threshold), height_(height), aspect_(aspect), job_(job)
    {
    }

    Contour run()
    {
        job_.stage(0.0f, 0.2f);
        mark_vertices();
        job_.stage(0.2f, 0.5f);
        place_vertices();
        job_.stage(0.5f, 1.0f);
        make_triangles();
        return std::move(result_);
    }

private:
    // Nodes of the tile with those of its far borders, which are copies of the near ones.
    int columns() const { return nodes_.x + 1; }
    int rows() const { return nodes_.y + 1; }
    std::size_t row_of(const glm::ivec3& node) const { return static_cast<std::size_t>(node.z) * rows() + node.y; }

    float value(const glm::ivec3& node) const
    {
        const int x = node.x == nodes_.x ? 0 : node.x;
        const int y = node.y == nodes_.y ? 0 : node.y;
        return values_[(static_cast<std::size_t>(node.z) * nodes_.y + y) * nodes_.x + x];
    }
    bool inside(const glm::ivec3& node) const { return value(node) > threshold_; }

    // What vertices a node has: bit 0 the node itself, as a corner of a cap; bit d the crossing on the edge that leads to the
    // node at offset_of(d).
    std::uint8_t vertices_of(const glm::ivec3& node) const
    {
        const bool in = inside(node);
        std::uint8_t mask = in && (node.z == 0 || node.z == nodes_.z - 1) ? 1 : 0;
        for (int d = 1; d < 8; ++d) {
            const glm::ivec3 end = node + offset_of(d);
            if (end.x <= nodes_.x && end.y <= nodes_.y && end.z < nodes_.z && inside(end) != in) {
                mask |= static_cast<std::uint8_t>(1 << d);
            }
        }
        return mask;
    }

    // Turns counts into the index where each begins; throws where the sum is no index.
    static std::uint32_t begins(std::vector<std::uint32_t>& counts)
    {
        std::uint64_t sum = 0;
        for (std::uint32_t& count : counts) {
            const std::uint32_t begin = static_cast<std::uint32_t>(sum);
            sum += count;
            count = begin;
            if (sum > std::numeric_limits<std::int32_t>::max()) {
                throw InvalidArgument("the contour has more than 2 billion vertices or triangles; lower the resolution");
            }
        }
        return static_cast<std::uint32_t>(sum);
    }

    template <typename Work>
    void for_each_row(const Work& work)
    {
        parallel_for(job_, nodes_.z * rows(), [&](int row) { work(row, glm::ivec3(0, row % rows(), row / rows())); });
    }

    void mark_vertices()
    {
        const std::size_t row_count = static_cast<std::size_t>(nodes_.z) * rows();
        masks_.resize(row_count * columns());
        row_begins_.resize(row_count);
        for_each_row([&](int row, glm::ivec3 node) {
            std::uint32_t count = 0;
            for (; node.x < columns(); ++node.x) {
                const std::uint8_t mask = vertices_of(node);
                masks_[static_cast<std::size_t>(row) * columns() + node.x] = mask;
                count += static_cast<std::uint32_t>(std::popcount(mask));
            }
            row_begins_[row] = count;
        });
        result_.positions.resize(begins(row_begins_));
    }

    glm::vec3 position(const glm::ivec3& node, int d) const
    {
        glm::dvec3 place(node);
        if (d != 0) {
            const double from = value(node);
            const double to = value(node + offset_of(d));
            place += glm::dvec3(offset_of(d)) * ((threshold_ - from) / (to - from));
        }
        // The division comes first: it is exact at the borders, whatever the aspect.
        return {place.x / nodes_.x, place.y / nodes_.y * aspect_, place.z / (nodes_.z - 1) * height_};
    }

    void place_vertices()
    {
        node_begins_.resize(masks_.size());
        for_each_row([&](int row, glm::ivec3 node) {
            std::uint32_t next = row_begins_[row];
            for (; node.x < columns(); ++node.x) {
                const std::size_t at = static_cast<std::size_t>(row) * columns() + node.x;
                node_begins_[at] = next;
                for (int d = 0; d < 8; ++d) {
                    if ((masks_[at] >> d & 1) != 0) {
                        result_.positions[next++] = position(node, d);
                    }
                }
            }
        });
    }

    // The vertex at a corner of a cell (a == b) or between two of its corners, one of which has all the other's bits.
    std::uint32_t vertex(const glm::ivec3& cell, int a, int b) const
    {
        const int from = a & b;
        const glm::ivec3 node = cell + offset_of(from);
        const std::size_t at = row_of(node) * columns() + node.x;
        const int before = masks_[at] & ((1 << ((a | b) ^ from)) - 1);
        return node_begins_[at] + static_cast<std::uint32_t>(std::popcount(static_cast<unsigned>(before)));
    }

    template <typename Emit>
    void tetrahedron(const glm::ivec3& cell, const std::array<int, 4>& corners, int in, const Emit& emit) const
    {
        int pattern = 0;
        for (int i = 0; i < 4; ++i) {
            pattern |= (in >> corners[i] & 1) << i;
        }
        const int count = std::popcount(static_cast<unsigned>(pattern));
        const auto between = [&](int i, int j) { return vertex(cell, corners[i], corners[j]); };
        const auto [p, q, r, s] = even_orders[pattern];
        if (count == 1) {
            emit(between(p, q), between(p, r), between(p, s));
        } else if (count == 2) {
            emit(between(p, r), between(p, s), between(q, s));
            emit(between(p, r), between(q, s), between(q, r));
        } else if (count == 3) {
            emit(between(p, q), between(p, s), between(p, r));
        }
    }

    // The part of a triangle of the slab's end that lies in the solid; corners counterclockwise seen from outside.
    template <typename Emit>
    void cap(const glm::ivec3& cell, const std::array<int, 3>& corners, int in, const Emit& emit) const
    {
        std::array<std::uint32_t, 4> polygon{};
        int count = 0;
        for (int i = 0; i < 3; ++i) {
            const int a = corners[i];
            const int b = corners[(i + 1) % 3];
            const bool a_in = (in >> a & 1) != 0;
            if (a_in) {
                polygon[count++] = vertex(cell, a, a);
            }
            if (a_in != ((in >> b & 1) != 0)) {
                polygon[count++] = vertex(cell, a, b);
            }
        }
        for (int i = 2; i < count; ++i) {
            emit(polygon[0], polygon[i - 1], polygon[i]);
        }
    }

    template <typename Emit>
    void cell_row(glm::ivec3 cell, const Emit& emit) const
    {
        for (cell.x = 0; cell.x < nodes_.x; ++cell.x) {
            int in = 0;
            for (int corner = 0; corner < 8; ++corner) {
                in |= inside(cell + offset_of(corner)) ? 1 << corner : 0;
            }
            if (in != 0 && in != 255) {
                for (const auto& corners : tetrahedra) {
                    tetrahedron(cell, corners, in, emit);
                }
            }
            if (cell.z == 0 && (in & 15) != 0) {
                cap(cell, {0, 3, 1}, in, emit);
                cap(cell, {0, 2, 3}, in, emit);
            }
            if (cell.z == nodes_.z - 2 && (in >> 4) != 0) {
                cap(cell, {4, 5, 7}, in, emit);
                cap(cell, {4, 7, 6}, in, emit);
            }
        }
    }

    void make_triangles()
    {
        const int cell_rows = (nodes_.z - 1) * nodes_.y;
        const auto cell_of = [&](int row) { return glm::ivec3(0, row % nodes_.y, row / nodes_.y); };
        std::vector<std::uint32_t> row_begins(cell_rows);
        job_.stage(0.5f, 0.75f);
        parallel_for(job_, cell_rows, [&](int row) {
            std::uint32_t count = 0;
            cell_row(cell_of(row), [&](std::uint32_t, std::uint32_t, std::uint32_t) { ++count; });
            row_begins[row] = count;
        });
        result_.triangles.resize(begins(row_begins));
        job_.stage(0.75f, 1.0f);
        parallel_for(job_, cell_rows, [&](int row) {
            glm::uvec3* next = result_.triangles.data() + row_begins[row];
            cell_row(cell_of(row), [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) { *next++ = {a, b, c}; });
        });
    }

    std::span<const float> values_;
    glm::ivec3 nodes_;
    float threshold_;
    double height_;
    double aspect_;
    Job& job_;
    std::vector<std::uint8_t> masks_;          // [nz, ny + 1, nx + 1], as vertices_of
    std::vector<std::uint32_t> row_begins_;    // first vertex of a row of nodes
    std::vector<std::uint32_t> node_begins_;   // first vertex of a node
    Contour result_;
};

void check_values(std::span<const float> values, const glm::ivec3& nodes, float threshold)
{
    float least = values[0];
    float most = values[0];
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) {
            const std::size_t row = i / nodes.x;
            throw InvalidArgument("the value at z, y, x = " + std::to_string(row / nodes.y) + ", " +
                                  std::to_string(row % nodes.y) + ", " + std::to_string(i % nodes.x) +
                                  " is not finite; replace it by a number");
        }
        least = std::min(least, values[i]);
        most = std::max(most, values[i]);
    }
    if (!(most > threshold) || least > threshold) {
        throw InvalidArgument((least > threshold ? "every value is above the threshold " : "no value is above the threshold ") +
                              std::to_string(threshold) + "; choose one between " + std::to_string(least) + " and " +
                              std::to_string(most));
    }
}

}  // namespace

Contour contour(std::span<const float> values, const glm::ivec3& nodes, float threshold, float height, float aspect, Job& job)
{
    for (int axis = 0; axis < 3; ++axis) {
        if (nodes[axis] < 2 || nodes[axis] > 4096) {
            throw InvalidArgument("the volume has " + std::to_string(nodes[axis]) + " nodes along " + "xyz"[axis] +
                                  "; give 2 to 4096");
        }
    }
    if (values.size() != static_cast<std::size_t>(nodes.x) * nodes.y * nodes.z) {
        throw InvalidArgument("the volume has " + std::to_string(values.size()) + " values; give nx times ny times nz");
    }
    for (const auto& [name, number] : {std::pair("height", height), std::pair("aspect", aspect)}) {
        if (!(number > 0.0f) || !std::isfinite(number)) {
            throw InvalidArgument(std::string(name) + " is " + std::to_string(number) +
                                  "; give the tile a positive height and positive periods");
        }
    }
    if (!std::isfinite(threshold)) {
        throw InvalidArgument("the threshold is not finite; give a number between the least and the greatest value");
    }
    check_memory("the contour", 5.0 * (nodes.x + 1.0) * (nodes.y + 1.0) * nodes.z, "lower its resolution");
    check_values(values, nodes, threshold);
    return Contouring(values, nodes, threshold, height, aspect, job).run();
}

}  // namespace mesoshell
