// The UVs of a shell's top, moved to lower the total stretch.
#pragma once

#include "mesoshell/job.h"
#include "mesoshell/shell.h"

namespace mesoshell {

// Sets shell.top_uvs by at most `steps` steps of conjugate gradients on the total of mesoshell/stretch.h in the shell's own
// proportions, preconditioned by its second derivatives (Gauss and Newton), which makes fine shells need no more steps than
// coarse ones. No step raises the total, and none turns UVs over at any height. UVs on both sides of an edge across which
// the pattern continues move alike, so that it still does; on borders and on seams that cut the pattern each side moves for
// itself. UVs of prisms that have no area at the base stay. Where nothing is gained top_uvs stays empty. The result does not
// depend on the number of threads.
void relax_top_uvs(Shell& shell, int steps, Job& job);

}  // namespace mesoshell
