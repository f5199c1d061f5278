#include "mesoshell/compress.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>

#include <Eigen/Dense>

#include "half.h"
#include "parallel.h"

namespace mesoshell {
namespace {

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using MatrixView = Eigen::Map<const RowMatrix>;

constexpr int rows_per_block = 512;  // sums within a block are single precision, across blocks double

struct Spectrum {
    Eigen::VectorXd values;   // of the Gram matrix, largest first
    Eigen::MatrixXd vectors;  // its orthonormal eigenvectors, a column each
    double energy = 0.0;      // sum of squares of the raw GDM
};

void check_options(const Gdm& gdm, const Sdf* sdf, const CompressOptions& options)
{
    const std::int64_t columns = std::int64_t(gdm.resolution.ntheta) * gdm.resolution.nodes.z;
    if (!(options.max_rmse >= 0.0f)) {
        throw InvalidArgument("max_rmse is " + std::to_string(options.max_rmse) +
                              "; give a positive length in tile widths, or 0 to choose the number of terms");
    }
    if (!(options.max_rmse > 0.0f) && (options.terms < 1 || options.terms > columns)) {
        throw InvalidArgument("terms is " + std::to_string(options.terms) + "; give 1 to " + std::to_string(columns) +
                              ", the number of columns of this GDM");
    }
    if (sdf != nullptr && (sdf->height != gdm.height || sdf->aspect != gdm.aspect)) {
        throw InvalidArgument("the SDF and the GDM are of tiles with different height or aspect; bake both from one sample");
    }
}

Spectrum decompose(const MatrixView& matrix, Job& job)
{
    const Eigen::Index columns = matrix.cols();
    const int blocks = static_cast<int>((matrix.rows() + rows_per_block - 1) / rows_per_block);
    // A few running sums, so that workers seldom wait for one another.
    const int lanes = columns <= 1024 ? 16 : 4;
    std::vector<Eigen::MatrixXd> sums(std::min(lanes, blocks), Eigen::MatrixXd::Zero(columns, columns));
    std::vector<std::mutex> locks(sums.size());
    parallel_for(job, blocks, [&](int block) {
        const Eigen::Index first = static_cast<Eigen::Index>(block) * rows_per_block;
        const auto rows = matrix.middleRows(first, std::min<Eigen::Index>(rows_per_block, matrix.rows() - first));
        Eigen::MatrixXf gram = Eigen::MatrixXf::Zero(columns, columns);
        gram.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
        const std::size_t lane = static_cast<std::size_t>(block) % sums.size();
        const std::lock_guard lock(locks[lane]);
        sums[lane] += gram.cast<double>();
    });
    for (std::size_t lane = 1; lane < sums.size(); ++lane) {
        sums[0] += sums[lane];
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(sums[0]);
    Spectrum spectrum;
    spectrum.values = solver.eigenvalues().reverse();
    spectrum.vectors = solver.eigenvectors().rowwise().reverse();
    spectrum.energy = sums[0].trace();
    return spectrum;
}

// Mean square of what the largest terms leave.
double mean_square_left(const Spectrum& spectrum, int terms, double count)
{
    return std::max(spectrum.energy - spectrum.values.head(terms).sum(), 0.0) / count;
}

int fewest_terms(const Spectrum& spectrum, double mean_square, double count)
{
    int terms = 1;
    while (terms < spectrum.values.size() && mean_square_left(spectrum, terms, count) > mean_square) {
        ++terms;
    }
    return terms;
}

// Fills in the first terms, as they are stored, and their errors.
void project(const MatrixView& matrix, const Spectrum& spectrum, int terms, Map& map, Job& job)
{
    const Eigen::Index rows = matrix.rows();
    map.terms = terms;
    const RowMatrix basis = spectrum.vectors.leftCols(terms).transpose().cast<float>();
    map.eigenmaps.assign(basis.data(), basis.data() + basis.size());
    if (map.precision == Precision::half) {
        round_to_half(map.eigenmaps);
    }
    const MatrixView stored_basis(map.eigenmaps.data(), terms, matrix.cols());
    map.weights.resize(static_cast<std::size_t>(terms) * rows);
    const int blocks = static_cast<int>((rows + rows_per_block - 1) / rows_per_block);
    std::mutex lock;
    double squared = 0.0;
    float largest = 0.0f;
    parallel_for(job, blocks, [&](int block) {
        const Eigen::Index first = static_cast<Eigen::Index>(block) * rows_per_block;
        const auto part = matrix.middleRows(first, std::min<Eigen::Index>(rows_per_block, rows - first));
        RowMatrix weights = part * stored_basis.transpose();
        if (map.precision == Precision::half) {
            round_to_half({weights.data(), static_cast<std::size_t>(weights.size())});
        }
        const RowMatrix error = weights * stored_basis - part;
        for (int term = 0; term < terms; ++term) {
            Eigen::Map<Eigen::VectorXf>(map.weights.data() + static_cast<std::size_t>(term) * rows + first, part.rows()) =
                weights.col(term);
        }
        const double block_squared = error.cast<double>().squaredNorm();
        const float block_largest = error.cwiseAbs().maxCoeff();
        const std::lock_guard guard(lock);
        squared += block_squared;
        largest = std::max(largest, block_largest);
    });
    map.rmse = static_cast<float>(std::sqrt(squared / (static_cast<double>(rows) * static_cast<double>(matrix.cols()))));
    map.max_error = largest;
}

// The fewest terms whose error, with that of rounding them, is at most max_rmse.
void project_to_error(const MatrixView& matrix, const Spectrum& spectrum, double max_rmse, Map& map, Job& job)
{
    const double count = static_cast<double>(matrix.rows()) * static_cast<double>(matrix.cols());
    const double allowed = max_rmse * max_rmse;
    project(matrix, spectrum, fewest_terms(spectrum, allowed, count), map, job);
    while (map.rmse > max_rmse) {
        // Rounding costs nearly the same whatever the number of terms: leave room for it.
        const double rounding = static_cast<double>(map.rmse) * map.rmse - mean_square_left(spectrum, map.terms, count);
        if (rounding >= allowed || map.terms == matrix.cols()) {
            throw InvalidArgument("max_rmse is " + std::to_string(max_rmse) + ", but " +
                                  (map.precision == Precision::half ? "half" : "single") + " precision alone costs " +
                                  std::to_string(std::sqrt(std::max(rounding, 0.0))) + "; give a larger max_rmse" +
                                  (map.precision == Precision::half ? ", or single precision" : ""));
        }
        job.stage(1.0f, 1.0f);
        project(matrix, spectrum, std::max(map.terms + 1, fewest_terms(spectrum, allowed - rounding, count)), map, job);
    }
}

}  // namespace

Map compress(const Gdm& gdm, const Sdf* sdf, const CompressOptions& options, Job& job)
{
    check_options(gdm, sdf, options);
    const GdmResolution& r = gdm.resolution;
    const Eigen::Index rows = static_cast<Eigen::Index>(r.nphi) * r.nodes.y * r.nodes.x;
    const Eigen::Index columns = static_cast<Eigen::Index>(r.ntheta) * r.nodes.z;
    const MatrixView matrix(gdm.values.data(), rows, columns);

    job.stage(0.0f, 0.7f);
    const Spectrum spectrum = decompose(matrix, job);

    Map map;
    map.resolution = r;
    map.height = gdm.height;
    map.aspect = gdm.aspect;
    map.precision = options.precision;
    job.stage(0.7f, 1.0f);
    if (options.max_rmse > 0.0f) {
        project_to_error(matrix, spectrum, options.max_rmse, map, job);
    } else {
        project(matrix, spectrum, options.terms, map, job);
    }

    if (sdf != nullptr) {
        map.sdf_nodes = sdf->nodes;
        map.sdf = sdf->values;
        if (options.precision == Precision::half) {
            round_to_half(map.sdf);
        }
    }
    return map;
}

}  // namespace mesoshell
