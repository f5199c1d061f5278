// The functions of this folder, of one instruction set: what its table holds. Their contracts are in kernels.h.
#pragma once

#include "kernels.h"

namespace mesoshell::simd {

void rasterize_slices(const Slices& slices, float* nearest);
void add_gram(const RowGroups& rows, int columns, double* sums);
void project(const float* rows, int count, int columns, const float* basis, int terms, float* weights);
void project_transposed(const float* rows, int count, int columns, const float* weights, int terms, float* sums);
Residual residual(const float* rows, int count, int columns, const float* weights, const float* basis, int terms);

}  // namespace mesoshell::simd
