// The layout whose rows are nodes (y, x) alone: columns (phi, theta, z).
#pragma once

#include "mesoshell/compress.h"

namespace mesoshell {

// Fills in a map's terms and errors; its other members are set. Within [begin, end] of the job.
void compress_nodes(const Gdm& gdm, const CompressOptions& options, Map& map, Job& job, float begin, float end);

}  // namespace mesoshell
