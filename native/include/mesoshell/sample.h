// A sample: the mesh of one periodic tile, checked and ready to bake.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

// Geometry is in metric texture space: lengths in tile widths, x with period 1, y with period `aspect`, the slab
// 0 <= z <= height. The mesh may cross the side borders (every copy by whole periods is implied) and must be closed, if
// need be only across the borders. What lies beyond the slab is clipped, and the solid is capped there.
class Sample {
public:
    // positions: [n]; triangles: [m] vertex indices, three a triangle; height and aspect: positive.
    // Throws InvalidArgument for values that are not finite, indices out of range, an empty mesh, an open mesh, a height or
    // aspect that is not positive, and a mesh without any geometry in the slab.
    Sample(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles, float height, float aspect);

    const std::vector<glm::vec3>& positions() const { return positions_; }
    const std::vector<glm::uvec3>& triangles() const { return triangles_; }
    float height() const { return height_; }
    float aspect() const { return aspect_; }

    // Whether neighboring triangles agree on which side is out: then solids may overlap, and a point is inside where the
    // winding number is not zero; otherwise inside means an odd number of crossings.
    bool oriented() const { return oriented_; }

    bool winds_outward() const;

    // The mesh clipped to the slab, without caps.
    const std::vector<glm::vec3>& slab_positions() const { return slab_positions_.empty() ? positions_ : slab_positions_; }
    const std::vector<glm::uvec3>& slab_triangles() const
    {
        return slab_positions_.empty() ? triangles_ : slab_triangles_;
    }
    // Triangles that the slab cuts or drops.
    std::size_t clipped_triangles() const { return clipped_; }

private:
    void check_values() const;
    void check_closed();
    void clip_to_slab();

    std::vector<glm::vec3> positions_;
    std::vector<glm::uvec3> triangles_;
    std::vector<glm::vec3> slab_positions_;
    std::vector<glm::uvec3> slab_triangles_;
    float height_;
    float aspect_;
    bool oriented_ = false;
    std::size_t clipped_ = 0;
};

}  // namespace mesoshell
