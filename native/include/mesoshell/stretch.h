// How far a shell stretches the pattern it carries (Zhou et al. 2006, the metric "StreMe" of the survey of 2014, section
// 4.3).
#pragma once

#include <vector>

#include "mesoshell/job.h"
#include "mesoshell/shell.h"

namespace mesoshell {

// The tile's own proportions, tile widths: v and w of metric texture space. 0: those at which the shell's total is least, so
// that only what differs from place to place counts as stretch, not how the whole pattern was placed.
struct Proportions {
    double aspect = 0.0;
    double height = 0.0;
};

struct Stretch {
    // One a prism: the root mean square of the singular values of the map from metric texture space to object space, over
    // the prism and the three directions, in units of the shell's mean scale, the cube root of its volume in object space
    // over that in texture space. 1 is no stretch, 2 a pattern twice as large as on average. Infinite where the UVs have no
    // area at some height; 0 for a prism without volume.
    std::vector<float> rms;
    // One a prism: between dP/du and dP/dv in object space at half the height, 0 to pi; pi / 2 is no shear. 0 where UVs have
    // no area there.
    std::vector<float> angle;
    // Root mean square over the volume in object space of all prisms with finite stretch: at least 1 (by the means
    // of powers), and 1 only for a similarity. 0 without such prisms.
    double total = 0.0;
    std::size_t infinite = 0;  // prisms
    Proportions proportions;   // given or found
};

// Zhou et al. take singular values from object to texture space. From texture to object space they are their inverses, as in
// Sander et al. 2001: large where the pattern is large, infinite where UVs collapse. Integrals are exact where base and top
// have the same UVs and no column of the prism is turned over; else Gauss quadrature of three heights, exact across each.
// Throws InvalidArgument for proportions that are negative or not finite; Cancelled.
Stretch stretch(const Shell& shell, const Proportions& proportions, Job& job);
inline Stretch stretch(const Shell& shell, const Proportions& proportions = {})
{
    Job job;
    return stretch(shell, proportions, job);
}

}  // namespace mesoshell
