#include "compress_nodes.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <Eigen/Dense>

#include "instruction_set.h"
#include "map_terms.h"
#include "parallel.h"

namespace mesoshell {
namespace {

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int extra_directions = 12;  // of the subspace, beyond the terms wanted
constexpr int power_steps = 2;  // more than these lower the error by half a percent (docs/architecture.md, "What was measured")
constexpr int rows_per_block = 256;

// A GDM as one matrix, [nodes, nphi columns]; azimuth phi's share of the columns is a block of the raw array.
class NodeMatrix {
public:
    NodeMatrix(const Gdm& gdm, Job& job)
        : gdm_(gdm), job_(job), nodes(gdm.resolution.nodes.x * gdm.resolution.nodes.y),
          columns(gdm.resolution.ntheta * gdm.resolution.nodes.z), azimuths(gdm.resolution.nphi)
    {
    }

    const float* rows(int azimuth, int node) const
    {
        return gdm_.values.data() + (static_cast<std::size_t>(azimuth) * nodes + node) * columns;
    }

    // matrix * right^T, right [k, azimuths columns]: [nodes, k]
    RowMatrix times(const RowMatrix& right, float part)
    {
        const int k = static_cast<int>(right.rows());
        RowMatrix product = RowMatrix::Zero(nodes, k);
        for_blocks(part, [&](int node, int height) {
            RowMatrix basis(k, columns), sum(height, k);
            for (int phi = 0; phi < azimuths && !job_.cancelled(); ++phi) {
                basis = right.middleCols(static_cast<Eigen::Index>(phi) * columns, columns);
                kernels().project(rows(phi, node), height, columns, basis.data(), k, sum.data());
                product.middleRows(node, height) += sum;
            }
        });
        return product;
    }

    // left^T * matrix, left [nodes, k]: [k, azimuths columns]
    RowMatrix transposed_times(const RowMatrix& left, float part)
    {
        const int k = static_cast<int>(left.cols());
        RowMatrix product(k, static_cast<Eigen::Index>(azimuths) * columns);
        parallel_for(job_, azimuths, [&](int phi) {
            RowMatrix sum = RowMatrix::Zero(k, columns);
            for (int node = 0; node < nodes && !job_.cancelled(); node += rows_per_block) {
                const int height = std::min(rows_per_block, nodes - node);
                kernels().project_transposed(rows(phi, node), height, columns, left.data() + static_cast<std::size_t>(node) * k, k,
                                             sum.data());
            }
            product.middleCols(static_cast<Eigen::Index>(phi) * columns, columns) = sum;
        }, part);
        return product;
    }

    template <typename Visit>
    void for_blocks(float part, const Visit& visit)
    {
        parallel_for(job_, (nodes + rows_per_block - 1) / rows_per_block, [&](int block) {
            visit(block * rows_per_block, std::min(rows_per_block, nodes - block * rows_per_block));
        }, part);
    }

private:
    const Gdm& gdm_;
    Job& job_;

public:
    const int nodes;
    const int columns;  // of an azimuth
    const int azimuths;
};

RowMatrix orthonormal_rows(const RowMatrix& matrix)
{
    const Eigen::HouseholderQR<Eigen::MatrixXf> qr(matrix.transpose());
    return (qr.householderQ() * Eigen::MatrixXf::Identity(matrix.cols(), matrix.rows())).transpose();
}

RowMatrix orthonormal_columns(const RowMatrix& matrix)
{
    const Eigen::HouseholderQR<Eigen::MatrixXf> qr(matrix);
    return qr.householderQ() * Eigen::MatrixXf::Identity(matrix.rows(), matrix.cols());
}

void find_errors(NodeMatrix& matrix, Map& map, float part)
{
    std::vector<std::vector<float>> bases;
    for (int phi = 0; phi < matrix.azimuths; ++phi) {
        bases.push_back(distance_basis(map, phi));
    }
    std::vector<simd::Residual> of_block((matrix.nodes + rows_per_block - 1) / rows_per_block);
    matrix.for_blocks(part, [&](int node, int height) {
        std::vector<float> weights(static_cast<std::size_t>(height) * map.terms);
        for (int i = 0; i < height; ++i) {
            for (int term = 0; term < map.terms; ++term) {
                weights[static_cast<std::size_t>(i) * map.terms + term] =
                    map.weights[static_cast<std::size_t>(term) * matrix.nodes + node + i];
            }
        }
        simd::Residual sum{0.0, 0.0f};
        for (int phi = 0; phi < matrix.azimuths; ++phi) {
            const simd::Residual residual =
                kernels().residual(matrix.rows(phi, node), height, matrix.columns, weights.data(), bases[phi].data(), map.terms);
            sum.squared += residual.squared;
            sum.largest = std::max(sum.largest, residual.largest);
        }
        of_block[node / rows_per_block] = sum;
    });
    double squared = 0.0;
    map.max_error = 0.0f;
    for (const simd::Residual& residual : of_block) {
        squared += residual.squared;
        map.max_error = std::max(map.max_error, residual.largest);
    }
    map.rmse = static_cast<float>(
        std::sqrt(squared / (static_cast<double>(matrix.nodes) * matrix.azimuths * matrix.columns)));
}

// The best `terms` terms, as they are stored, and their errors.
void decompose(NodeMatrix& matrix, int terms, Map& map, Job& job, float begin, float end)
{
    job.stage(begin, end);
    constexpr float part = 1.0f / (2 * power_steps + 3);
    const Eigen::Index wide = static_cast<Eigen::Index>(matrix.azimuths) * matrix.columns;
    const int k = static_cast<int>(std::min<Eigen::Index>(terms + extra_directions, std::min<Eigen::Index>(matrix.nodes, wide)));
    RowMatrix start(k, wide);
    std::mt19937 random(1);
    std::generate(start.data(), start.data() + start.size(), [&] { return static_cast<float>(random()) * 0x1p-31f - 1.0f; });
    RowMatrix left = orthonormal_columns(matrix.times(start, part));
    for (int step = 0; step < power_steps; ++step) {
        job.throw_if_cancelled();
        const RowMatrix right = orthonormal_rows(matrix.transposed_times(left, part));
        job.throw_if_cancelled();
        left = orthonormal_columns(matrix.times(right, part));
    }
    const RowMatrix core = matrix.transposed_times(left, part);
    const Eigen::MatrixXd squared = core.cast<double>() * core.cast<double>().transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(squared);
    const Eigen::MatrixXf turn = solver.eigenvectors().rowwise().reverse().leftCols(terms).cast<float>();
    RowMatrix eigenmaps = turn.transpose() * core;  // orthogonal rows of the singular values' lengths
    RowMatrix weights = (left * turn).transpose();  // [terms, nodes], orthonormal
    for (int term = 0; term < terms; ++term) {
        const float length = eigenmaps.row(term).norm();
        if (length > 0.0f) {
            eigenmaps.row(term) /= length;
            weights.row(term) *= length;
        }
    }
    map.terms = terms;
    map.weights.assign(weights.data(), weights.data() + weights.size());
    map.eigenmaps.assign(eigenmaps.data(), eigenmaps.data() + eigenmaps.size());
    round_terms(map);
    find_errors(matrix, map, part);
}

}  // namespace

void compress_nodes(const Gdm& gdm, const CompressOptions& options, Map& map, Job& job, float begin, float end)
{
    NodeMatrix matrix(gdm, job);
    if (!(options.max_rmse > 0.0f)) {
        decompose(matrix, options.terms, map, job, begin, end);
        return;
    }
    const int most = static_cast<int>(
        std::min<std::int64_t>(matrix.nodes, static_cast<std::int64_t>(matrix.azimuths) * matrix.columns));
    // Doubling, then halving the interval: every number of terms is a subspace of its own.
    int low = 0;
    int high = 1;
    for (decompose(matrix, high, map, job, begin, end); map.rmse > options.max_rmse;) {
        if (high == most) {
            throw InvalidArgument("max_rmse is " + std::to_string(options.max_rmse) + ", but all terms leave " +
                                  std::to_string(map.rmse) + "; give a larger max_rmse, or a finer precision");
        }
        low = high;
        high = std::min(2 * high, most);
        decompose(matrix, high, map, job, end, end);
    }
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        decompose(matrix, middle, map, job, end, end);
        (map.rmse > options.max_rmse ? low : high) = middle;
    }
    if (map.terms != high) {
        decompose(matrix, high, map, job, end, end);
    }
}

}  // namespace mesoshell
