#include "mesoshell/bake.h"

#include <cmath>
#include <numbers>

#include "gdm_baker.h"
#include "gdm_task.h"
#include "tile_space.h"

namespace mesoshell {

glm::dvec3 gdm_direction(const GdmResolution& resolution, int theta, int phi)
{
    const double polar = std::numbers::pi * theta / (resolution.ntheta - 1);
    const double azimuth = 2.0 * std::numbers::pi * phi / resolution.nphi;
    if (theta == 0 || theta == resolution.ntheta - 1) {
        return glm::dvec3(0.0, 0.0, theta == 0 ? 1.0 : -1.0);
    }
    return glm::dvec3(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
}

Gdm bake_gdm(const Sample& sample, const GdmResolution& resolution, Engine engine, Job& job, float end)
{
    check_resolution(resolution);
    const double bytes =
        4.0 * resolution.nodes.x * resolution.nodes.y * resolution.nodes.z * resolution.ntheta * resolution.nphi;
    check_memory("the raw GDM", bytes, "lower the resolution or the number of directions");
    Gdm gdm;
    gdm.resolution = resolution;
    gdm.height = sample.height();
    gdm.aspect = sample.aspect();
    job.stage(0.0f, 0.05f * end);
    const GdmBaker baker(sample, resolution, engine, job);
    job.stage(0.05f * end, end);
    gdm.values.resize(static_cast<std::size_t>(bytes / sizeof(float)));
    baker.bake(0, resolution.nphi, gdm.values.data(), job);
    gdm.ray_count = baker.rays_per_azimuth() * static_cast<std::uint64_t>(resolution.nphi);
    return gdm;
}

}  // namespace mesoshell
