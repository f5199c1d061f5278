// The bins of shaders/lib/octahedral.glsl as cones, for bounds that hold for every direction of a bin.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

// Lengths and cosines of directions are trusted to this: what the shader text's rounding may put on the other side of a
// border. Tile widths where it is a length.
constexpr double bin_slack = 1e-5;

// A box.
struct Bounds {
    glm::dvec3 lower;
    glm::dvec3 upper;
};

// All directions of a bin: the cone over a spherical quadrangle, whose corners are those of the bin.
class BinCone {
public:
    BinCone(int bin, int side);

    const std::array<glm::dvec3, 4>& corners() const { return corners_; }

    // A lower bound on the length of the vectors of the cone, at most `limit` long, that end in the box; `limit` where there
    // are none. Exact where the end nearest to the cone's apex is in the cone, or lies on one face of the box alone.
    double distance(const Bounds& box, double limit) const;

    // No vector of the cone ends in the box; if false, some may.
    bool misses(const Bounds& box) const;

private:
    std::array<glm::dvec3, 4> corners_;
    std::array<glm::dvec3, 4> inward_;  // unit normals of the planes that bound the cone
    glm::dvec3 least_;                  // of the components of its unit vectors, with the slack
    glm::dvec3 most_;
};

// Unit vector of a node of the square's grid, column and row in [0, side].
glm::dvec3 octahedral_node(int column, int row, int side);

// One bit a bin.
class BinSet {
public:
    explicit BinSet(int side) : words((static_cast<std::size_t>(side) * side + 63) / 64) {}
    void add(int bin) { words[static_cast<std::size_t>(bin) / 64] |= std::uint64_t(1) << (bin % 64); }

    std::vector<std::uint64_t> words;
};

// Which bins have a direction that meets a triangle from its front.
class FacingBins {
public:
    explicit FacingBins(int side);
    // area_vector: along the triangle's normal, of any length; all bins where it is zero.
    void facing(const glm::dvec3& area_vector, BinSet& bins) const;

private:
    int side_;
    std::vector<glm::dvec3> nodes_;  // of the grid, [side + 1, side + 1]
};

}  // namespace mesoshell
