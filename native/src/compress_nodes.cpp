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

// A GDM as one matrix, [nodes, wide]; azimuth phi's share of the columns is a block of the raw array.
class NodeMatrix {
public:
    NodeMatrix(const Gdm& gdm, Job& job)
        : nodes(gdm.resolution.nodes.x * gdm.resolution.nodes.y), columns(gdm.resolution.ntheta * gdm.resolution.nodes.z),
          azimuths(gdm.resolution.nphi), wide(static_cast<Eigen::Index>(azimuths) * columns), gdm_(gdm), job_(job)
    {
    }

    const float* rows(int azimuth, int node) const
    {
        return gdm_.values.data() + (static_cast<std::size_t>(azimuth) * nodes + node) * columns;
    }

    // matrix * right, right [wide, k]: [nodes, k]
    RowMatrix times(const RowMatrix& right, float part)
    {
        const int k = static_cast<int>(right.cols());
        RowMatrix product = RowMatrix::Zero(nodes, k);
        for_blocks(nodes, part, [&](int node, int height) {
            RowMatrix basis(k, columns), sum(height, k);
            for (int phi = 0; phi < azimuths && !job_.cancelled(); ++phi) {
                basis = right.middleRows(static_cast<Eigen::Index>(phi) * columns, columns).transpose();
                kernels().project(rows(phi, node), height, columns, basis.data(), k, sum.data());
                product.middleRows(node, height) += sum;
            }
        });
        return product;
    }

    // matrix^T * left, left [nodes, k]: [wide, k]
    RowMatrix transposed_times(const RowMatrix& left, float part)
    {
        const int k = static_cast<int>(left.cols());
        RowMatrix product(wide, k);
        parallel_for(job_, azimuths, [&](int phi) {
            RowMatrix sum = RowMatrix::Zero(k, columns);
            for (int node = 0; node < nodes && !job_.cancelled(); node += rows_per_block) {
                const int height = std::min(rows_per_block, nodes - node);
                kernels().project_transposed(rows(phi, node), height, columns, left.data() + static_cast<std::size_t>(node) * k, k,
                                             sum.data());
            }
            product.middleRows(static_cast<Eigen::Index>(phi) * columns, columns) = sum.transpose();
        }, part);
        return product;
    }

    // Orthonormal columns of the same span, by Cholesky's factor of the Gram matrix, twice (Fukaya et al. 2014, "CholeskyQR2"):
    // unlike Householder's, it works in blocks of rows.
    RowMatrix orthonormal(RowMatrix matrix)
    {
        for (int pass = 0; pass < 2; ++pass) {
            const Eigen::MatrixXd gram = gram_of(matrix);
            const Eigen::LLT<Eigen::MatrixXd> factor(gram);
            if (factor.info() != Eigen::Success) {  // fewer directions than columns
                const Eigen::HouseholderQR<Eigen::MatrixXf> qr(matrix);
                return qr.householderQ() * Eigen::MatrixXf::Identity(matrix.rows(), matrix.cols());
            }
            // Rows times the inverse of the upper factor.
            const Eigen::Index k = matrix.cols();
            const RowMatrix inverse = Eigen::MatrixXd(factor.matrixL().solve(Eigen::MatrixXd::Identity(k, k))).cast<float>();
            RowMatrix turned(matrix.rows(), k);
            for_blocks(static_cast<int>(matrix.rows()), 0.0f, [&](int row, int height) {
                kernels().project(matrix.data() + row * k, height, static_cast<int>(k), inverse.data(), static_cast<int>(k),
                                  turned.data() + row * k);
            });
            matrix.swap(turned);
        }
        return matrix;
    }

    // matrix^T matrix, in double precision across blocks; the same bits whatever the number of threads.
    Eigen::MatrixXd gram_of(const RowMatrix& matrix)
    {
        using Sums = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        const int k = static_cast<int>(matrix.cols());
        const int height = static_cast<int>(matrix.rows());
        constexpr int parts = 16;
        std::vector<Sums> sums(parts);
        parallel_for(job_, parts, [&](int part) {
            sums[part] = Sums::Zero(k, k);
            const int first = static_cast<int>(static_cast<std::int64_t>(height) * part / parts);
            const int last = static_cast<int>(static_cast<std::int64_t>(height) * (part + 1) / parts);
            kernels().add_gram({matrix.data() + static_cast<std::size_t>(first) * k, 1, 0, last - first, k}, k, sums[part].data());
        }, 0.0f);
        for (int part = 1; part < parts; ++part) {
            sums[0] += sums[part];
        }
        return sums[0].selfadjointView<Eigen::Upper>();
    }

    template <typename Visit>
    void for_blocks(int rows, float part, const Visit& visit)
    {
        parallel_for(job_, (rows + rows_per_block - 1) / rows_per_block, [&](int block) {
            visit(block * rows_per_block, std::min(rows_per_block, rows - block * rows_per_block));
        }, part);
    }

    const int nodes;
    const int columns;  // of an azimuth
    const int azimuths;
    const Eigen::Index wide;

private:
    const Gdm& gdm_;
    Job& job_;
};

void find_errors(NodeMatrix& matrix, Map& map, float part)
{
    std::vector<std::vector<float>> bases;
    for (int phi = 0; phi < matrix.azimuths; ++phi) {
        bases.push_back(distance_basis(map, phi));
    }
    std::vector<simd::Residual> of_block((matrix.nodes + rows_per_block - 1) / rows_per_block);
    matrix.for_blocks(matrix.nodes, part, [&](int node, int height) {
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
    const Eigen::Index wide = matrix.wide;
    const int k = static_cast<int>(std::min<Eigen::Index>(terms + extra_directions, std::min<Eigen::Index>(matrix.nodes, wide)));
    RowMatrix start(wide, k);
    std::mt19937 random(1);
    std::generate(start.data(), start.data() + start.size(), [&] { return static_cast<float>(random()) * 0x1p-31f - 1.0f; });
    RowMatrix left = matrix.orthonormal(matrix.times(start, part));
    for (int step = 0; step < power_steps; ++step) {
        const RowMatrix right = matrix.orthonormal(matrix.transposed_times(left, part));
        left = matrix.orthonormal(matrix.times(right, part));
    }
    const RowMatrix core = matrix.transposed_times(left, part);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix.gram_of(core));
    job.throw_if_cancelled();
    const Eigen::MatrixXf turn = solver.eigenvectors().rowwise().reverse().leftCols(terms).cast<float>();
    RowMatrix eigenmaps = turn.transpose() * core.transpose();  // orthogonal rows of the singular values' lengths
    RowMatrix weights = (left * turn).transpose();              // [terms, nodes], orthonormal
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
