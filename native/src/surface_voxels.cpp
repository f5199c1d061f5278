#include "surface_voxels.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "direction_bins.h"
#include "parallel.h"

namespace mesoshell {
namespace {

constexpr int triangles_a_task = 256;

using Triangle = std::array<glm::dvec3, 3>;

// Akenine-Moller 2001, "Fast 3D triangle-box overlap testing": separating axes, for closed sets.
bool overlap(const Triangle& triangle, const glm::dvec3& center, const glm::dvec3& half)
{
    const Triangle t{triangle[0] - center, triangle[1] - center, triangle[2] - center};
    const auto separates = [&](const glm::dvec3& axis) {
        const double reach = half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
        const double a = glm::dot(axis, t[0]);
        const double b = glm::dot(axis, t[1]);
        const double c = glm::dot(axis, t[2]);
        return std::min(a, std::min(b, c)) > reach || std::max(a, std::max(b, c)) < -reach;
    };
    for (int axis = 0; axis < 3; ++axis) {
        const double least = std::min(t[0][axis], std::min(t[1][axis], t[2][axis]));
        const double most = std::max(t[0][axis], std::max(t[1][axis], t[2][axis]));
        if (least > half[axis] || most < -half[axis]) {
            return false;
        }
    }
    if (separates(glm::cross(t[1] - t[0], t[2] - t[0]))) {
        return false;
    }
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 edge = t[(i + 1) % 3] - t[i];
        if (separates({0.0, -edge.z, edge.y}) || separates({edge.z, 0.0, -edge.x}) || separates({-edge.y, edge.x, 0.0})) {
            return false;
        }
    }
    return true;
}

// Visits the unit boxes, larger by `slack` on every side, of [lower, upper) that a triangle touches: halving, so that the
// cost is that of the boxes found and not of the triangle's own box.
template <typename Visit>
void for_each_voxel(const Triangle& triangle, const glm::ivec3& lower, const glm::ivec3& upper, const glm::dvec3& slack,
                    const Job& job, const Visit& visit)
{
    const glm::ivec3 extent = upper - lower;
    if (extent.x <= 0 || extent.y <= 0 || extent.z <= 0 || job.cancelled()) {
        return;
    }
    const glm::dvec3 half = 0.5 * glm::dvec3(extent) + slack;
    if (!overlap(triangle, 0.5 * glm::dvec3(lower + upper), half)) {
        return;
    }
    if (extent == glm::ivec3(1)) {
        visit(lower);
        return;
    }
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    glm::ivec3 middle_upper = upper;
    glm::ivec3 middle_lower = lower;
    middle_upper[axis] = middle_lower[axis] = lower[axis] + extent[axis] / 2;
    for_each_voxel(triangle, lower, middle_upper, slack, job, visit);
    for_each_voxel(triangle, middle_lower, upper, slack, job, visit);
}

int wrapped(int i, int period)
{
    const int rest = i % period;
    return rest < 0 ? rest + period : rest;
}

// A 64 x 64 matrix of bits, rows of words (Warren 2012, "Hacker's Delight", section 7-3).
void transpose_bits(std::uint64_t* rows)
{
    std::uint64_t mask = 0x00000000FFFFFFFFu;
    for (int step = 32; step != 0; step >>= 1, mask ^= mask << step) {
        for (int k = 0; k < 64; k = ((k | step) + 1) & ~step) {
            const std::uint64_t moved = ((rows[k] >> step) ^ rows[k | step]) & mask;
            rows[k] ^= moved << step;
            rows[k | step] ^= moved;
        }
    }
}

}  // namespace

double SurfaceVoxels::bytes(const glm::ivec3& cells, int directions)
{
    return 512.0 * std::ceil(directions * directions / 64.0) * cells.x * cells.y * cells.z;
}

SurfaceVoxels::SurfaceVoxels(const Sample& sample, const glm::ivec3& cells, int directions, Job& job)
    : cells_(cells), groups_((static_cast<std::size_t>(directions) * directions + 63) / 64)
{
    marks_.resize(groups_ * cells.x * cells.y * cells.z * 64);
    clear(job);
    mark(sample, directions, job);
    transpose(job);
}

// Half a gigabyte at the finest: threads and a cancel count even here.
void SurfaceVoxels::clear(Job& job)
{
    const std::size_t layer = static_cast<std::size_t>(cells_.x) * cells_.y * 64;
    parallel_for(job, static_cast<int>(groups_) * cells_.z, [&](int i) {
        std::fill_n(marks_.begin() + static_cast<std::ptrdiff_t>(i * layer), layer, std::uint64_t(0));
    }, 0.1f);
}

void SurfaceVoxels::mark(const Sample& sample, int directions, Job& job)
{
    const glm::ivec3 voxels = cells_ * voxels_a_side;
    const glm::dvec3 scale = glm::dvec3(voxels) / glm::dvec3(1.0, sample.aspect(), sample.height());
    const glm::dvec3 slack = bin_slack * scale;
    const FacingBins facing(directions);
    const bool fronts_only = sample.winds_outward();
    const std::vector<glm::vec3>& positions = sample.positions();
    const std::vector<glm::uvec3>& triangles = sample.triangles();
    const int tasks = static_cast<int>((triangles.size() + triangles_a_task - 1) / triangles_a_task);
    parallel_for(job, tasks, [&](int task) {
        BinSet bins(directions);
        const std::size_t first = static_cast<std::size_t>(task) * triangles_a_task;
        for (std::size_t i = first; i < std::min(first + triangles_a_task, triangles.size()); ++i) {
            Triangle t;
            for (int corner = 0; corner < 3; ++corner) {
                t[corner] = glm::dvec3(positions[triangles[i][corner]]);
            }
            facing.facing(fronts_only ? glm::cross(t[1] - t[0], t[2] - t[0]) : glm::dvec3(0.0), bins);
            for (glm::dvec3& corner : t) {
                corner *= scale;
            }
            glm::dvec3 lower = glm::floor(glm::min(t[0], glm::min(t[1], t[2])) - slack);
            glm::dvec3 upper = glm::floor(glm::max(t[0], glm::max(t[1], t[2])) + slack) + 1.0;
            lower.z = std::max(lower.z, 0.0);
            upper.z = std::clamp(upper.z, lower.z, std::max(lower.z, double(voxels.z)));
            for_each_voxel(t, glm::ivec3(lower), glm::ivec3(upper), slack, job, [&](const glm::ivec3& voxel) {
                const glm::ivec3 place(wrapped(voxel.x, voxels.x), wrapped(voxel.y, voxels.y), voxel.z);
                const glm::ivec3 cell = place / voxels_a_side;
                const glm::ivec3 within = place - cell * voxels_a_side;
                const std::size_t cell_index = (static_cast<std::size_t>(cell.z) * cells_.y + cell.y) * cells_.x + cell.x;
                const std::size_t bit = (within.z * voxels_a_side + within.y) * voxels_a_side + within.x;
                for (std::size_t group = 0; group < groups_; ++group) {
                    const std::size_t cells = static_cast<std::size_t>(cells_.x) * cells_.y * cells_.z;
                    // The order of threads does not matter to a union.
                    const std::atomic_ref<std::uint64_t> word(marks_[(group * cells + cell_index) * 64 + bit]);
                    if ((bins.words[group] & ~word.load(std::memory_order_relaxed)) != 0) {
                        word.fetch_or(bins.words[group], std::memory_order_relaxed);
                    }
                }
            });
        }
    }, 0.8f);
}

void SurfaceVoxels::transpose(Job& job)
{
    const int tasks = static_cast<int>(groups_) * cells_.z;
    const std::size_t words = static_cast<std::size_t>(cells_.x) * cells_.y * 64;
    parallel_for(job, tasks, [&](int task) {
        for (std::size_t i = 0; i < words; i += 64) {
            transpose_bits(marks_.data() + task * words + i);
        }
    }, 0.1f);
}

std::vector<std::uint64_t> SurfaceVoxels::of_bin(int bin) const
{
    const std::size_t cells = static_cast<std::size_t>(cells_.x) * cells_.y * cells_.z;
    std::vector<std::uint64_t> marks(cells);
    for (std::size_t cell = 0; cell < cells; ++cell) {
        marks[cell] = marks_[(static_cast<std::size_t>(bin) / 64 * cells + cell) * 64 + bin % 64];
    }
    return marks;
}

}  // namespace mesoshell
