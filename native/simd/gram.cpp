// The Gram matrix of a block of rows: products in single precision, sums across slabs of rows in double.
//
// Rows are repacked into panels of a few columns, so that a tile of the result stays in registers while its two panels stream by
// (Goto and van de Geijn 2008, "Anatomy of high-performance matrix multiplication"). A symmetric rank update: only tiles that touch
// the upper triangle are computed.
#include <algorithm>
#include <vector>

#include "functions.h"
#include "lanes.h"

namespace mesoshell::simd {
namespace {

constexpr int panel_vectors = 3;
constexpr int panel = panel_vectors * lanes;  // columns; divisible by tile_rows
constexpr int tile_rows = 4;                  // with the panel: 12 sums, 3 loads and a broadcast fill 16 registers
constexpr int slab = 256;                     // rows whose products are summed in single precision

// Panels of rows [first, first + count): element (row, column) at ((column / panel) slab + row - first) panel + column % panel.
void pack(const RowGroups& rows, int first, int count, int columns, float* panels)
{
    const float* from[slab];
    for (int row = 0; row < count; ++row) {
        from[row] = rows.first + (first + row) / rows.rows_per_group * rows.group_stride +
                    (first + row) % rows.rows_per_group * rows.row_stride;
    }
    for (int left = 0; left < columns; left += panel, panels += std::size_t(slab) * panel) {
        const int width = std::min(panel, columns - left);
        for (int row = 0; row < count; ++row) {
            float* to = panels + std::size_t(row) * panel;
            std::copy_n(from[row] + left, width, to);
            std::fill(to + width, to + panel, 0.0f);
        }
    }
}

// tile[i][j] = sum over the slab of a[row][i] b[row][j]; a points to tile_rows neighboring columns of a panel, b to the first
// `vectors` vectors of one.
template <int vectors>
inline void multiply(const float* a, const float* b, int count, float (*tile)[panel])
{
    Floats sums[tile_rows][vectors] = {};
    for (int row = 0; row < count; ++row, a += panel, b += panel) {
        Floats right[vectors];
        for (int v = 0; v < vectors; ++v) {
            right[v] = load<Floats>(b + v * lanes);
        }
        for (int i = 0; i < tile_rows; ++i) {
            const Floats left = Floats{} + a[i];
            for (int v = 0; v < vectors; ++v) {
                sums[i][v] += left * right[v];
            }
        }
    }
    for (int i = 0; i < tile_rows; ++i) {
        for (int v = 0; v < vectors; ++v) {
            store(&tile[i][v * lanes], sums[i][v]);
        }
    }
}

}  // namespace

void add_gram(const RowGroups& rows, int columns, double* sums)
{
    static thread_local std::vector<float> panels;
    const int panel_count = (columns + panel - 1) / panel;
    panels.resize(std::size_t(panel_count) * slab * panel);
    const int count = rows.groups * rows.rows_per_group;
    for (int first = 0; first < count; first += slab) {
        const int slab_rows = std::min(slab, count - first);
        pack(rows, first, slab_rows, columns, panels.data());
        for (int right = 0; right < panel_count; ++right) {
            const float* b = panels.data() + std::size_t(right) * slab * panel;
            const int j_first = right * panel;
            const int width = std::min(panel, columns - j_first);
            for (int i_first = 0; i_first < std::min(j_first + panel, columns); i_first += tile_rows) {
                const float* a = panels.data() + std::size_t(i_first / panel) * slab * panel + i_first % panel;
                alignas(64) float tile[tile_rows][panel];
                (width <= lanes ? multiply<1> : width <= 2 * lanes ? multiply<2> : multiply<3>)(a, b, slab_rows, tile);
                for (int i = 0; i < std::min(tile_rows, columns - i_first); ++i) {
                    double* to = sums + std::size_t(i_first + i) * columns + j_first;
                    for (int j = 0; j < width; ++j) {
                        to[j] += double(tile[i][j]);
                    }
                }
            }
        }
    }
}

}  // namespace mesoshell::simd
