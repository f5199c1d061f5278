// The slice engine of a GDM bake: triangles are rasterized, direction by direction, onto the nodes of all slices at once.
// The kernel is native/simd/slices.cpp.
#pragma once

#include <cstdint>
#include <vector>

#include "gdm_task.h"
#include "mesoshell/job.h"

namespace mesoshell {

class SliceBaker {
public:
    explicit SliceBaker(const GdmTask& task);

    // Whether the direction is steep enough for its shear to fit the lattice's fixed point.
    bool takes(int theta) const;

    // One direction, into `copies` azimuths' values. Ends early, with values unfinished, where the job is cancelled.
    void bake_direction(int phi, int theta, int copies, float* values, const Job& job) const;

private:
    struct Scratch;

    const GdmTask& task_;
    int keep_front_;                     // 1 if back faces can never be a ray's first surface, else 0
    float reach_;                        // of the mesh beyond the origin, sideways
    std::vector<std::uint8_t> outside_;  // [ny, nx, nz]
};

}  // namespace mesoshell
