// Products of a block of rows with few vectors, by Eigen, compiled for one instruction set.
#include <Eigen/Core>

#include "functions.h"

namespace mesoshell::simd {
namespace {

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using View = Eigen::Map<RowMatrix>;
using ConstView = Eigen::Map<const RowMatrix>;

}  // namespace

void project(const float* rows, int count, int columns, const float* basis, int terms, float* weights)
{
    View(weights, count, terms).noalias() = ConstView(rows, count, columns) * ConstView(basis, terms, columns).transpose();
}

void project_transposed(const float* rows, int count, int columns, const float* weights, int terms, float* sums)
{
    View(sums, terms, columns).noalias() += ConstView(weights, count, terms).transpose() * ConstView(rows, count, columns);
}

Residual residual(const float* rows, int count, int columns, const float* weights, const float* basis, int terms)
{
    RowMatrix error = -ConstView(rows, count, columns);
    error.noalias() += ConstView(weights, count, terms) * ConstView(basis, terms, columns);
    double squared = 0.0;
    for (int row = 0; row < count; ++row) {
        squared += static_cast<double>(error.row(row).squaredNorm());
    }
    return {squared, error.size() > 0 ? error.cwiseAbs().maxCoeff() : 0.0f};
}

}  // namespace mesoshell::simd
