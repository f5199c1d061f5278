#include "gdm_baker.h"

#include <algorithm>
#include <string>

#include "gdm_rays.h"
#include "gdm_slices.h"
#include "gdm_task.h"
#include "parallel.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

// Triangles of a tile up to which the slice engine is the faster one (docs/architecture.md, "What was measured").
constexpr std::size_t most_triangles_of_slices = 600000;

}  // namespace

void check_resolution(const GdmResolution& r)
{
    const auto refuse = [](const std::string& what, int value, int least) {
        throw InvalidArgument(what + " is " + std::to_string(value) + "; give at least " + std::to_string(least));
    };
    for (int axis = 0; axis < 3; ++axis) {
        if (r.nodes[axis] < 2) {
            refuse("a GDM resolution", r.nodes[axis], 2);
        }
    }
    if (r.ntheta < 2) {
        refuse("the number of polar directions", r.ntheta, 2);
    }
    if (r.nphi < 1) {
        refuse("the number of azimuth directions", r.nphi, 1);
    }
    if (std::int64_t(r.ntheta) * r.nodes.z > most_columns) {
        throw InvalidArgument("polar directions times nodes in height are " +
                              std::to_string(std::int64_t(r.ntheta) * r.nodes.z) + "; give at most " +
                              std::to_string(most_columns) + ", or compression takes too much memory");
    }
}

GdmBaker::GdmBaker(const Sample& sample, const GdmResolution& resolution, Engine engine, Job& job) : engine_(engine)
{
    check_resolution(resolution);
    task_ = std::make_unique<GdmTask>(GdmTask{sample, resolution, {}});
    task_->inside = classify_inside(sample, resolution.nodes, job);
    if (engine_ == Engine::automatic) {
        engine_ = sample.slab_triangles().size() <= most_triangles_of_slices ? Engine::slices : Engine::embree;
    }
    bool needs_rays = engine_ == Engine::embree;
    if (engine_ == Engine::slices) {
        slices_ = std::make_unique<SliceBaker>(*task_);
        for (int theta = 0; theta < resolution.ntheta; ++theta) {
            needs_rays = needs_rays || !slices_->takes(theta);
        }
    }
    if (needs_rays) {
        rays_ = std::make_unique<RayBaker>(*task_);
    }

    const glm::ivec3& n = resolution.nodes;
    const std::size_t slice = static_cast<std::size_t>(n.x) * n.y;
    for (int z = 0; z < n.z; ++z) {
        const auto begin = task_->inside.begin() + static_cast<std::ptrdiff_t>(z * slice);
        const auto outside = static_cast<std::uint64_t>(std::count(begin, begin + static_cast<std::ptrdiff_t>(slice), 0));
        for (int theta = 0; theta < resolution.ntheta; ++theta) {
            const auto vertical = static_cast<float>(gdm_direction(resolution, theta, 0).z);
            rays_per_azimuth_ += slab_exit(task_->node_z(z), vertical, sample.height()) > 0.0f ? outside : 0;
        }
    }
}

GdmBaker::~GdmBaker() = default;

void GdmBaker::bake(int first, int count, float* values, Job& job) const
{
    if (slices_ == nullptr) {
        rays_->bake(first, count, values, job);
        return;
    }
    const int ntheta = task_->resolution.ntheta;
    parallel_for(job, count * ntheta, [&](int index) {
        const int phi = index / ntheta;
        const int theta = index % ntheta;
        const bool pole = task_->is_pole(theta);
        if (pole && phi != 0) {
            return;  // baked with the first azimuth
        }
        const int copies = pole ? count : 1;
        float* const of_azimuth = values + task_->offset(phi, 0, 0, 0);
        if (slices_->takes(theta)) {
            slices_->bake_direction(first + phi, theta, copies, of_azimuth, job);
        } else {
            rays_->bake_direction(first + phi, theta, copies, of_azimuth);
        }
    });
}

}  // namespace mesoshell
