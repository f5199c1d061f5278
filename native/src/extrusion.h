// What a shell is told beside its surface: checked before anything is computed; and the prisms that have no volume.
#pragma once

#include <span>

#include "mesoshell/shell.h"

namespace mesoshell {

// Throws InvalidArgument, as build_shell does, for covered faces, thickness factors, an image, an offset, smoothing,
// relaxation or a placement that cannot be meant.
void check_extrusion(const Surface& surface, const ShellOptions& options);

// Leaves out the prisms whose three columns have thickness 0. `thickness` is one a vertex. Throws Error if none is left.
void leave_out_flat_prisms(ShellTopology& topology, std::span<const float> thickness);

}  // namespace mesoshell
