// The voxels of the slab that a tile's surface touches, and from which directions it can be met there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/sample.h"
#include "mesoshell/uninitialized.h"

namespace mesoshell {

// A cell is a block of 4 x 4 x 4 voxels: a bit each of 64.
constexpr int voxels_a_side = 4;

class SurfaceVoxels {
public:
    // directions: side of the octahedral map. Voxels are closed boxes, some 1e-5 tile widths larger than they are, and the
    // test of triangle against box is exact: no point of the surface lies in a voxel without a mark. A front that turns away
    // from every direction of a bin leaves no mark there, where the winding number says that rays from outside meet fronts
    // first.
    SurfaceVoxels(const Sample& sample, const glm::ivec3& cells, int directions, Job& job);

    // For a bin: the marked voxels of every cell [cz, cy, cx]; voxel (x, y, z) of a cell is bit (z 4 + y) 4 + x.
    std::vector<std::uint64_t> of_bin(int bin) const;

    static double bytes(const glm::ivec3& cells, int directions);

private:
    void clear(Job& job);
    void mark(const Sample& sample, int directions, Job& job);
    void transpose(Job& job);

    glm::ivec3 cells_;
    std::size_t groups_;  // of 64 bins
    // [group, cell, 64], a bit a bin of each voxel at first; transposed: a bit a voxel of each bin
    UninitializedVector<std::uint64_t> marks_;
};

}  // namespace mesoshell
