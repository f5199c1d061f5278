// The terms of a map between the SVD that found them and the precision they are stored in.
#pragma once

#include <vector>

#include "mesoshell/compress.h"

namespace mesoshell {

// Rounds the eigenmaps of a map, whose weights are still to be found, to halves where its precision asks for that.
void round_eigenmaps(Map& map);

// Rounds weights, and in a byte map rescales both factors, term by term. The larger factor becomes bytes.
void round_terms(Map& map);

// Distances to the end of the slab of the columns (theta, z), tile widths.
std::vector<float> exit_distances(const GdmResolution& resolution, float height);

// The basis that weights of one azimuth are multiplied with to give distances: eigenmaps of it, [terms, ntheta nz].
std::vector<float> distance_basis(const Map& map, int eigen_azimuth);

}  // namespace mesoshell
