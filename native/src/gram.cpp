#include "gram.h"

#include <algorithm>
#include <vector>

#include "instruction_set.h"
#include "parallel.h"

namespace mesoshell {
namespace {

using RowMatrixD = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using View = Eigen::Map<const RowMatrix, 0, Eigen::OuterStride<>>;

constexpr int nodes_per_block = 64;

// Running sums of one share of the nodes, always in the same order.
struct Lane {
    RowMatrixD between;  // columns that are not of a pole: upper triangle
    RowMatrixD with_poles;  // [pole columns, the others]
    RowMatrixD poles;
};

}  // namespace

Eigen::MatrixXd gram_matrix(GdmSource& source, Job& job, float begin, float end, float share)
{
    const GdmResolution& r = source.resolution();
    const int nz = r.nodes.z;
    const int columns = r.ntheta * nz;
    const int others = columns - 2 * nz;  // they are [nz, columns - nz)
    const int nodes = r.nodes.x * r.nodes.y;
    const int blocks = (nodes + nodes_per_block - 1) / nodes_per_block;
    const int lane_count = std::min(blocks, columns <= 1024 ? 16 : 4);
    std::vector<Lane> lanes(static_cast<std::size_t>(lane_count));

    source.walk(job, begin, end, share, [&](int first, int count, const float* values) {
        parallel_for(job, lane_count, [&](int index) {
            Lane& lane = lanes[static_cast<std::size_t>(index)];
            if (lane.poles.size() == 0) {
                lane.between = RowMatrixD::Zero(others, others);
                lane.with_poles = RowMatrixD::Zero(2 * nz, others);
                lane.poles = RowMatrixD::Zero(2 * nz, 2 * nz);
            }
            RowMatrix sums, poles, product(2 * nz, others), pole_product(2 * nz, 2 * nz);
            for (int block = index; block < blocks && !job.cancelled(); block += lane_count) {
                const int node = block * nodes_per_block;
                const int height = std::min(nodes_per_block, nodes - node);
                sums.setZero(height, others);
                poles.resize(height, 2 * nz);
                for (int phi = 0; phi < count; ++phi) {
                    const float* rows = values + (static_cast<std::size_t>(phi) * nodes + node) * columns;
                    const View view(rows, height, columns, Eigen::OuterStride<>(columns));
                    if (phi == 0) {
                        poles.leftCols(nz) = view.leftCols(nz);
                        poles.rightCols(nz) = view.rightCols(nz);
                    }
                    sums += view.middleCols(nz, others);
                }
                const std::ptrdiff_t azimuth = static_cast<std::ptrdiff_t>(nodes) * columns;
                kernels().add_gram({values + static_cast<std::size_t>(node) * columns + nz, count, azimuth, height, columns},
                                   others, lane.between.data());
                product.setZero();
                kernels().project_transposed(sums.data(), height, others, poles.data(), 2 * nz, product.data());
                lane.with_poles += product.cast<double>();
                if (first == 0) {
                    pole_product.setZero();
                    kernels().project_transposed(poles.data(), height, 2 * nz, poles.data(), 2 * nz, pole_product.data());
                    lane.poles += pole_product.cast<double>() * static_cast<double>(r.nphi);
                }
                job.advance(static_cast<float>(height) / static_cast<float>(nodes));
            }
        }, 0.0f);
    });

    for (std::size_t i = 1; i < lanes.size(); ++i) {
        lanes[0].between += lanes[i].between;
        lanes[0].with_poles += lanes[i].with_poles;
        lanes[0].poles += lanes[i].poles;
    }
    const Lane& sum = lanes[0];
    Eigen::MatrixXd gram(columns, columns);
    gram.block(nz, nz, others, others) = sum.between.triangularView<Eigen::Upper>();
    gram.block(nz, nz, others, others).triangularView<Eigen::StrictlyLower>() =
        sum.between.transpose().triangularView<Eigen::StrictlyLower>();
    gram.block(0, nz, nz, others) = sum.with_poles.topRows(nz);
    gram.block(columns - nz, nz, nz, others) = sum.with_poles.bottomRows(nz);
    gram.block(nz, 0, others, nz) = sum.with_poles.topRows(nz).transpose();
    gram.block(nz, columns - nz, others, nz) = sum.with_poles.bottomRows(nz).transpose();
    gram.block(0, 0, nz, nz) = sum.poles.topLeftCorner(nz, nz);
    gram.block(0, columns - nz, nz, nz) = sum.poles.topRightCorner(nz, nz);
    gram.block(columns - nz, 0, nz, nz) = sum.poles.bottomLeftCorner(nz, nz);
    gram.block(columns - nz, columns - nz, nz, nz) = sum.poles.bottomRightCorner(nz, nz);
    return gram;
}

}  // namespace mesoshell
