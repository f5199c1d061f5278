// The inner loops that exist once for every instruction set: plain data in, plain data out.
// native/CMakeLists.txt compiles this folder's sources once an instruction set, each into one object whose only visible symbol is
// its table, so that the linker can never hand code for a newer processor to the rest of the program.
#pragma once

#include <cstddef>
#include <cstdint>

namespace mesoshell::simd {

// Fixed-point steps between two nodes of the lattice that slices are rasterized on. Small triangles stay exact in 32 bits.
constexpr int lattice_bits = 11;

// A direction's input for rasterize_slices. Positions are sheared along the direction onto the plane w = 0 and measured in
// fixed-point steps of the lattice, whose period is (nx, ny) nodes.
struct Slices {
    int vertex_count;
    const std::int32_t* x;  // [vertex_count], steps
    const std::int32_t* y;
    const float* x_rest;  // [vertex_count], what rounding to steps took away
    const float* y_rest;
    const float* t;  // [vertex_count], height over the vertical part of the direction: distance from the plane w = 0 along it
    int triangle_count;
    const std::uint32_t* corners;  // [triangle_count, 3]
    int keep_sign;                 // sign of the sheared area of the triangles to keep; 0 keeps all

    int nx, ny, nz;
    // [nz, padded to slice_padding with t = infinity]: where node (0, 0) of a slice lies, sheared like the vertices.
    const std::int32_t* slice_x;
    const std::int32_t* slice_y;
    const float* slice_x_rest;
    const float* slice_y_rest;
    const float* slice_t;
    float slice_t_step;  // of neighboring slices; its sign is the direction's
};

constexpr int slice_padding = 16;

// Rows of numbers that stand in groups; strides are numbers from one row or group to the next.
struct RowGroups {
    const float* first;
    int groups;
    std::ptrdiff_t group_stride;
    int rows_per_group;
    std::ptrdiff_t row_stride;
};

// Of an approximation, over a block of rows.
struct Residual {
    double squared;  // sum of squares
    float largest;   // absolute
};

// Matrices are row-major and dense: rows [count, columns], basis [terms, columns], weights [count, terms].
struct Kernels {
    const char* name;
    // nearest [ny, nx, nz]: the smaller of what is there and the distance to the nearest triangle ahead of the node.
    void (*rasterize_slices)(const Slices& slices, float* nearest);
    // sums [columns, columns] += rows^T rows; at least its upper triangle, the rest is undefined.
    void (*add_gram)(const RowGroups& rows, int columns, double* sums);
    // weights = rows basis^T
    void (*project)(const float* rows, int count, int columns, const float* basis, int terms, float* weights);
    // sums [terms, columns] += weights^T rows
    void (*project_transposed)(const float* rows, int count, int columns, const float* weights, int terms, float* sums);
    // Of weights basis - rows.
    Residual (*residual)(const float* rows, int count, int columns, const float* weights, const float* basis, int terms);
};

}  // namespace mesoshell::simd
