// What a shell keeps of the surface and the options it was built from, so that it can be updated.
#pragma once

#include <memory>
#include <vector>

#include "director_smoothing.h"
#include "limit_surface.h"
#include "mesoshell/shell.h"

namespace mesoshell {

struct ShellRig {
    ShellRig(const Surface& surface, const ShellOptions& options, Job& job)
        : limit(surface, options.refinement, job), director_smoothing(options.director_smoothing), repair(options.repair)
    {
    }

    LimitSurface limit;
    std::shared_ptr<BlockPool> pool = std::make_shared<BlockPool>();  // of the tables of all shells that have this rig
    // Asked, one a vertex of the shell, object units: as the shell was built, and where all thickness factors are 1.
    std::vector<float> thickness;
    std::vector<float> full_thickness;
    // Options whose work depends on positions.
    int director_smoothing;
    FaceLists smoothed;  // none without smoothing
    bool repair;
};

}  // namespace mesoshell
