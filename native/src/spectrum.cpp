#include "spectrum.h"

#include <algorithm>

#include <Eigen/Eigenvalues>
#include <Spectra/SymEigsSolver.h>

namespace mesoshell {
namespace {

// Relative to an eigenvalue: what rounding leaves of a Gram matrix anyway.
constexpr double tolerance = 1e-12;
constexpr int most_restarts = 300;

// y = matrix x, until the job is cancelled.
class WatchedProduct {
public:
    using Scalar = double;

    WatchedProduct(const Eigen::MatrixXd& matrix, const Job& job) : matrix_(matrix), job_(job) {}
    Eigen::Index rows() const { return matrix_.rows(); }
    Eigen::Index cols() const { return matrix_.cols(); }
    void perform_op(const double* x, double* y) const
    {
        job_.throw_if_cancelled();
        Eigen::Map<Eigen::VectorXd>(y, rows()).noalias() = matrix_ * Eigen::Map<const Eigen::VectorXd>(x, cols());
    }

private:
    const Eigen::MatrixXd& matrix_;
    const Job& job_;
};

// Signs of eigenvectors are free; a solver's own depend on rounding.
void fix_signs(Eigen::MatrixXd& vectors)
{
    for (Eigen::Index i = 0; i < vectors.cols(); ++i) {
        Eigen::Index largest = 0;
        vectors.col(i).cwiseAbs().maxCoeff(&largest);
        if (vectors(largest, i) < 0.0) {
            vectors.col(i) *= -1.0;
        }
    }
}

Spectrum dense(const Eigen::MatrixXd& matrix, int count)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
    Spectrum spectrum;
    spectrum.values = solver.eigenvalues().reverse().head(count).cwiseMax(0.0);
    spectrum.vectors = solver.eigenvectors().rowwise().reverse().leftCols(count);
    fix_signs(spectrum.vectors);
    return spectrum;
}

}  // namespace

Spectrum largest_eigenpairs(const Eigen::MatrixXd& matrix, int count, const Job& job)
{
    job.throw_if_cancelled();
    const int size = static_cast<int>(matrix.rows());
    const int basis = std::max(2 * count + 8, 24);
    if (basis >= size / 2 || !(matrix.trace() > 0.0)) {
        return dense(matrix, count);
    }
    WatchedProduct product(matrix, job);
    Spectra::SymEigsSolver<WatchedProduct> solver(product, count, basis);
    solver.init();
    const auto found = solver.compute(Spectra::SortRule::LargestAlge, most_restarts, tolerance, Spectra::SortRule::LargestAlge);
    if (solver.info() != Spectra::CompInfo::Successful || found < count) {
        // A matrix of low rank can end the iteration early.
        return dense(matrix, count);
    }
    Spectrum spectrum;
    spectrum.values = solver.eigenvalues().cwiseMax(0.0);
    spectrum.vectors = solver.eigenvectors();
    fix_signs(spectrum.vectors);
    return spectrum;
}

}  // namespace mesoshell
