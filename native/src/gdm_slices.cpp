#include "gdm_slices.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "instruction_set.h"
#include "mesoshell/uninitialized.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

constexpr double steps_per_node = 1 << simd::lattice_bits;
// Of fixed-point coordinates, so that differences of two still fit 32 bits.
constexpr double largest_coordinate = 1 << 29;
// Triangles between two looks at whether the job was cancelled.
constexpr int batch = 1 << 11;

// Whole part, toward minus infinity, of a number below largest_coordinate: a cast alone truncates, and calling floor
// for every vertex costs more than all else here.
std::int32_t whole(double value)
{
    constexpr double shift = 1 << 30;
    return static_cast<std::int32_t>(value + shift) - (1 << 30);
}

}  // namespace

// A thread's arrays, kept from direction to direction.
struct SliceBaker::Scratch {
    UninitializedVector<std::int32_t> x, y;
    UninitializedVector<float> x_rest, y_rest, t;
    std::vector<std::int32_t> slice_x, slice_y;
    std::vector<float> slice_x_rest, slice_y_rest, slice_t, limit;
    UninitializedVector<float> nearest;  // [ny, nx, nz]
};

SliceBaker::SliceBaker(const GdmTask& task) : task_(task), keep_front_(task.sample.winds_outward() ? 1 : 0), reach_(0.0f)
{
    for (const glm::vec3& p : task.sample.slab_positions()) {
        reach_ = std::max(reach_, std::max(std::abs(p.x), std::abs(p.y)));
    }
    const glm::ivec3& n = task.resolution.nodes;
    outside_.resize(task.inside.size());
    for (int y = 0; y < n.y; ++y) {
        for (int x = 0; x < n.x; ++x) {
            for (int z = 0; z < n.z; ++z) {
                outside_[(static_cast<std::size_t>(y) * n.x + x) * n.z + z] =
                    task.inside[(static_cast<std::size_t>(z) * n.y + y) * n.x + x] != 0 ? 0 : 1;
            }
        }
    }
}

bool SliceBaker::takes(int theta) const
{
    const glm::ivec3& n = task_.resolution.nodes;
    const double polar = std::acos(gdm_direction(task_.resolution, theta, 0).z);
    const double farthest = reach_ + task_.sample.height() * std::abs(std::tan(polar));
    const double nodes_per_width = std::max(double(n.x), n.y / double(task_.sample.aspect()));
    return std::abs(std::cos(polar)) > 1e-4 && farthest * nodes_per_width * steps_per_node < largest_coordinate;
}

void SliceBaker::bake_direction(int phi, int theta, int copies, float* values, const Job& job) const
{
    thread_local Scratch s;
    const Sample& sample = task_.sample;
    const glm::ivec3& n = task_.resolution.nodes;
    const glm::dvec3 dir = gdm_direction(task_.resolution, theta, phi);
    const double scale_x = n.x * steps_per_node;
    const double scale_y = n.y * steps_per_node / sample.aspect();
    const double shear_x = dir.x / dir.z * scale_x;
    const double shear_y = dir.y / dir.z * scale_y;
    const double one_over_z = 1.0 / dir.z;

    const auto& positions = sample.slab_positions();
    const std::size_t vertices = positions.size();
    s.x.resize(vertices);
    s.y.resize(vertices);
    s.x_rest.resize(vertices);
    s.y_rest.resize(vertices);
    s.t.resize(vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
        const glm::dvec3 p(positions[i]);
        const double x = p.x * scale_x - p.z * shear_x;
        const double y = p.y * scale_y - p.z * shear_y;
        s.x[i] = whole(x + 0.5);
        s.y[i] = whole(y + 0.5);
        s.x_rest[i] = static_cast<float>(x - s.x[i]);
        s.y_rest[i] = static_cast<float>(y - s.y[i]);
        s.t[i] = static_cast<float>(p.z * one_over_z);
    }
    const std::size_t slices = static_cast<std::size_t>(n.z) + simd::slice_padding;
    s.slice_x.assign(slices, 0);
    s.slice_y.assign(slices, 0);
    s.slice_x_rest.assign(slices, 0.0f);
    s.slice_y_rest.assign(slices, 0.0f);
    s.slice_t.assign(slices, std::numeric_limits<float>::infinity());
    s.limit.resize(slices);
    for (int z = 0; z < n.z; ++z) {
        const double height = task_.node_z(z);
        s.slice_x[z] = whole(-height * shear_x + 0.5);
        s.slice_y[z] = whole(-height * shear_y + 0.5);
        s.slice_x_rest[z] = static_cast<float>(-height * shear_x - s.slice_x[z]);
        s.slice_y_rest[z] = static_cast<float>(-height * shear_y - s.slice_y[z]);
        s.slice_t[z] = static_cast<float>(height * one_over_z);
        s.limit[z] = slab_exit(static_cast<float>(height), static_cast<float>(dir.z), sample.height());
    }

    const std::size_t columns = static_cast<std::size_t>(n.x) * n.y;
    s.nearest.resize(columns * n.z);
    for (std::size_t i = 0; i < columns; ++i) {
        const std::uint8_t* outside = outside_.data() + i * n.z;
        float* nearest = s.nearest.data() + i * n.z;
        for (int z = 0; z < n.z; ++z) {
            nearest[z] = s.limit[z] * static_cast<float>(outside[z]);
        }
    }

    simd::Slices input{};
    input.vertex_count = static_cast<int>(vertices);
    input.x = s.x.data();
    input.y = s.y.data();
    input.x_rest = s.x_rest.data();
    input.y_rest = s.y_rest.data();
    input.t = s.t.data();
    // A face that a ray enters through shows the slab's far end its back: clockwise seen against an upward ray.
    input.keep_sign = dir.z > 0.0 ? -keep_front_ : keep_front_;
    input.nx = n.x;
    input.ny = n.y;
    input.nz = n.z;
    input.slice_x = s.slice_x.data();
    input.slice_y = s.slice_y.data();
    input.slice_x_rest = s.slice_x_rest.data();
    input.slice_y_rest = s.slice_y_rest.data();
    input.slice_t = s.slice_t.data();
    input.slice_t_step = static_cast<float>(sample.height() * one_over_z / (n.z - 1));
    const auto& triangles = sample.slab_triangles();
    for (std::size_t first = 0; first < triangles.size() && !job.cancelled(); first += batch) {
        input.corners = &triangles[first].x;
        input.triangle_count = static_cast<int>(std::min<std::size_t>(batch, triangles.size() - first));
        kernels().rasterize_slices(input, s.nearest.data());
    }

    for (int copy = 0; copy < copies; ++copy) {
        float* to = values + task_.offset(copy, 0, 0, theta);
        for (std::size_t i = 0; i < columns; ++i) {
            std::memcpy(to + i * n.z * task_.resolution.ntheta, s.nearest.data() + i * n.z, n.z * sizeof(float));
        }
    }
}

}  // namespace mesoshell
