// Baking a sample: its generalized displacement map (GDM paper, section 3.1) and its signed distance field.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/sample.h"
#include "mesoshell/uninitialized.h"

namespace mesoshell {

// Rays that never leave the slab, or leave it far away, end here. Tile widths.
constexpr float horizon_distance = 16.0f;

// theta nodes times w nodes, at most: compression holds several matrices with that many rows and columns.
constexpr int most_columns = 4096;

// How a GDM is baked. `embree` casts rays in packets. `slices` rasterizes the triangles onto the rays of a direction, which is
// faster for tiles up to some hundred thousand triangles; directions within a hundredth of a degree of the horizon are cast even
// then. Both agree but for rays that pass an edge within rounding.
enum class Engine { automatic, embree, slices };

// nodes (nx, ny, nz), node i at i / n along u and v and at i / (n - 1) along w.
struct GdmResolution {
    glm::ivec3 nodes{64, 64, 32};  // each at least 2
    int ntheta = 16;               // at least 2, theta node i at i pi / (ntheta - 1)
    int nphi = 32;                 // at least 1, phi node i at 2 pi i / nphi
};

// Unit vector of a direction node, metric texture space.
glm::dvec3 gdm_direction(const GdmResolution& resolution, int theta, int phi);

struct Gdm {
    GdmResolution resolution;
    float height = 0.0f;
    float aspect = 1.0f;
    // [nphi, ny, nx, ntheta, nz], tile widths: to the first surface; 0 inside; to the end of the slab where there is none.
    UninitializedVector<float> values;
    std::uint64_t ray_count = 0;  // rays answered: nodes outside the solid times directions into the slab

    std::size_t index(int phi, int y, int x, int theta, int z) const
    {
        const GdmResolution& r = resolution;
        return (((static_cast<std::size_t>(phi) * r.nodes.y + y) * r.nodes.x + x) * r.ntheta + theta) * r.nodes.z + z;
    }
};

struct Sdf {
    glm::ivec3 nodes{0};  // (mx, my, mz)
    float height = 0.0f;
    float aspect = 1.0f;
    std::vector<float> values;  // [mz, my, mx], tile widths, negative inside
};

// Throws InvalidArgument for a resolution out of range or one that needs more memory than there is; Cancelled.
// Covers the fractions up to `end` of the job.
Gdm bake_gdm(const Sample& sample, const GdmResolution& resolution, Engine engine, Job& job, float end = 1.0f);

inline Gdm bake_gdm(const Sample& sample, const GdmResolution& resolution, Job& job)
{
    return bake_gdm(sample, resolution, Engine::automatic, job);
}

// nodes: each at least 2.
Sdf bake_sdf(const Sample& sample, const glm::ivec3& nodes, Job& job);

}  // namespace mesoshell
