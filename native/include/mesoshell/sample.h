// A sample: the mesh of one periodic tile, repaired and ready to bake.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

struct PeriodicMesh;

struct SampleOptions {
    // Tile widths, not negative. Open parts of the mesh become sheets of this thickness, half of it to either side; where it
    // is zero, they are solid where the winding number says so, and left out where that is nowhere; terrain that does not fit
    // its copies gets walls at the borders.
    float thickness = 0.0f;
};

// Geometry is in metric texture space: lengths in tile widths, x with period 1, y with period `aspect`, the slab
// 0 <= z <= height. The mesh may cross the side borders (every copy by whole periods is implied). What lies beyond the slab
// is clipped, and the solid is capped there.
//
// Any mesh will do that has an area and encloses something, be it by a sheet's thickness. Vertices at one place modulo the
// periods are one; degenerate and duplicate faces are dropped; faces are turned over until neighbors agree and solids have
// their outsides out. A point is inside where the generalized winding number of the result is at least one half, whatever
// its sign (Jacobson et al. 2013, "Robust inside-outside segmentation using generalized winding numbers"): holes get caps
// where it is one half, and the number of what is baked is whole. High above the tile it is zero; under a surface that spans
// the tile and faces up it is one; where such a surface has holes, it is as far from either on both sides.
class Sample {
public:
    // positions: [n], at most 64 periods from the tile; triangles: [m] vertex indices, three a triangle; height and aspect:
    // positive.
    // Throws InvalidArgument for values that are not finite or too far away, indices out of range, an empty mesh, one without
    // any area, one that encloses nothing, options out of range, a height or aspect that is not positive, and a mesh without
    // any geometry in the slab.
    Sample(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles, float height, float aspect,
           const SampleOptions& options = {});

    // The surface of the solid, which rays meet and distances are taken to: repaired, capped, facing outward. Solids may
    // overlap.
    const std::vector<glm::vec3>& positions() const { return positions_; }
    const std::vector<glm::uvec3>& triangles() const { return triangles_; }
    // The mesh as it was given.
    const std::vector<glm::vec3>& input_positions() const { return input_positions_; }
    const std::vector<glm::uvec3>& input_triangles() const { return input_triangles_; }
    float height() const { return height_; }
    float aspect() const { return aspect_; }

    // What was repaired, and what the user should know: whole sentences.
    const std::vector<std::string>& notices() const { return notices_; }

    // Whether no winding number is negative: then a ray from outside meets front faces first.
    bool winds_outward() const { return winding_range_.x >= 0; }
    // Whether solids overlap: then `triangles` also has walls inside the solid.
    bool overlaps() const { return winding_range_.x < -1 || winding_range_.y > 1; }
    // The repaired mesh, closed modulo the periods: its winding number, a whole one, says what is inside.
    const PeriodicMesh& winding_mesh() const { return *winding_mesh_; }

    // The mesh clipped to the slab, without caps.
    const std::vector<glm::vec3>& slab_positions() const { return slab_positions_.empty() ? positions_ : slab_positions_; }
    const std::vector<glm::uvec3>& slab_triangles() const
    {
        return slab_positions_.empty() ? triangles_ : slab_triangles_;
    }
    // Triangles that the slab cuts or drops.
    std::size_t clipped_triangles() const { return clipped_; }

private:
    void check_values(const SampleOptions& options) const;
    void repair(const SampleOptions& options);
    void clip_to_slab();

    std::vector<glm::vec3> input_positions_;
    std::vector<glm::uvec3> input_triangles_;
    std::vector<glm::vec3> positions_;
    std::vector<glm::uvec3> triangles_;
    std::vector<glm::vec3> slab_positions_;
    std::vector<glm::uvec3> slab_triangles_;
    std::shared_ptr<const PeriodicMesh> winding_mesh_;
    std::vector<std::string> notices_;
    float height_;
    float aspect_;
    glm::ivec2 winding_range_{0};
    std::size_t clipped_ = 0;
};

}  // namespace mesoshell
