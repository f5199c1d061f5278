// The generalized winding number of any triangle mesh and all its copies by whole periods, fast.
//
// A tree of dipoles (Barill et al. 2018, "Fast winding numbers for soups and clouds"): far away, a node of the tree is its
// area vectors' sum, first and second moments; near, it is its children, and its triangles at last (van Oosterom and
// Strackee 1983). Near copies of the tile go through the tree, far ones are smeared into a plane, and one fades into the
// other: a sharp border between them would count some directions more than others.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "periodic_mesh.h"

namespace mesoshell {

class WindingNumber {
public:
    // Of the triangles given alone.
    WindingNumber(const PeriodicMesh& mesh, std::span<const glm::uvec3> triangles);

    // At a point in tile widths, to within winding_accuracy. Copies on either side of the point count alike, so that an
    // infinite sheet that faces up gives one half below and minus one half above.
    double at(const glm::dvec3& point) const;

private:
    struct Node {
        glm::dvec3 center{0.0};
        double radius = 0.0;           // of a ball about the center that holds the triangles
        glm::dvec3 area{0.0};          // the sum of area vectors
        glm::dmat3 first_moment{0.0};  // of area vectors times offsets from the center, one column a component of those
        std::array<glm::dmat3, 3> second_moment{glm::dmat3(0.0), glm::dmat3(0.0), glm::dmat3(0.0)};  // one a component
        std::uint32_t first = 0, last = 0;  // triangles
        std::uint32_t right = 0;       // the other child; the one follows its parent. 0 in a leaf
    };
    using Corners = std::array<glm::dvec3, 3>;

    void build(std::uint32_t first, std::uint32_t last);
    double of_tree(const glm::dvec3& point) const;

    double aspect_;
    std::vector<Corners> triangles_;  // in the order of the leaves
    std::vector<Node> nodes_;
};

// Of WindingNumber::at for a mesh about one period in size, farther from edges than rounding.
constexpr double winding_accuracy = 4e-3;

}  // namespace mesoshell
