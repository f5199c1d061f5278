// The largest eigenvalues of a Gram matrix and their vectors: the squared singular values and right singular vectors of an SVD.
#pragma once

#include <Eigen/Core>

#include "mesoshell/job.h"

namespace mesoshell {

struct Spectrum {
    Eigen::VectorXd values;   // largest first, not negative
    Eigen::MatrixXd vectors;  // orthonormal, a column each
};

// The `count` largest eigenpairs of a symmetric matrix that is positive semidefinite, to double precision. A few of many are found
// by Lanczos iterations with restarts (Lehoucq and Sorensen 1996; the Spectra library), which ask the job at every product; many
// of few by Eigen's dense solver, which does not.
// Throws Cancelled.
Spectrum largest_eigenpairs(const Eigen::MatrixXd& matrix, int count, const Job& job);

}  // namespace mesoshell
