// The Embree engine of a GDM bake: sixteen rays of one direction, side by side, against instances of the tile.
#pragma once

#include "embree_scene.h"
#include "gdm_task.h"
#include "mesoshell/job.h"

namespace mesoshell {

class RayBaker {
public:
    explicit RayBaker(const GdmTask& task);

    // See GdmBaker::bake.
    void bake(int first, int count, float* values, Job& job) const;
    // One direction alone, into `count` azimuths' values if it is a pole, else into those of the first.
    void bake_direction(int phi, int theta, int count, float* values) const;

private:
    void bake_packets(int phi, int theta, int y_first, int copies, float* values) const;

    const GdmTask& task_;
    TriangleScene scene_;
};

}  // namespace mesoshell
