// Bakes a GDM azimuth by azimuth, so that whoever compresses can take it in pieces.
#pragma once

#include <memory>

#include "mesoshell/bake.h"
#include "mesoshell/sample.h"

namespace mesoshell {

struct GdmTask;
class RayBaker;
class SliceBaker;

class GdmBaker {
public:
    // `sample` must outlive this. Builds what the engine needs. Throws InvalidArgument for a resolution out of range; Cancelled.
    GdmBaker(const Sample& sample, const GdmResolution& resolution, Engine engine, Job& job);
    ~GdmBaker();
    GdmBaker(const GdmBaker&) = delete;
    GdmBaker& operator=(const GdmBaker&) = delete;

    // Azimuth nodes [first, first + count), by all threads of the job: values [count, ny, nx, ntheta, nz]. The values of a node do
    // not depend on how azimuths are grouped, nor on the number of threads. Throws Cancelled.
    void bake(int first, int count, float* values, Job& job) const;

    Engine engine() const { return engine_; }  // never automatic
    // Rays of one azimuth: nodes outside the solid times directions into the slab.
    std::uint64_t rays_per_azimuth() const { return rays_per_azimuth_; }

private:
    std::unique_ptr<GdmTask> task_;
    std::unique_ptr<RayBaker> rays_;
    std::unique_ptr<SliceBaker> slices_;
    Engine engine_;
    std::uint64_t rays_per_azimuth_ = 0;
};

}  // namespace mesoshell
