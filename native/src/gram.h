// The Gram matrix of a raw GDM, whose rows are nodes and azimuths and whose columns are (theta, z).
#pragma once

#include <Eigen/Core>

#include "gdm_source.h"

namespace mesoshell {

// Sums of products, single precision within a few hundred rows, double beyond; the same bits whatever the number of threads. Walks
// the source once, within [begin, end] of the job, as `share` of walk says.
//
// At the poles all azimuths are one direction, so that their columns need only be multiplied with the sums over azimuths.
Eigen::MatrixXd gram_matrix(GdmSource& source, Job& job, float begin, float end, float share);

}  // namespace mesoshell
