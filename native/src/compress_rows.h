// The layouts whose rows are nodes and azimuths: one eigenproblem of as many unknowns as there are columns (theta, z).
#pragma once

#include "gdm_source.h"
#include "mesoshell/compress.h"

namespace mesoshell {

// Fills in a map's terms and errors; its other members are set. Walks the source three times within [begin, end] of the job.
void compress_rows(GdmSource& source, const CompressOptions& options, Map& map, Job& job, float begin, float end);

}  // namespace mesoshell
