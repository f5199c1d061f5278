// Winding numbers by brute force: the solid angles of all triangles and of their copies, one after the other, in double.
#pragma once

#include <span>

#include <glm/glm.hpp>

namespace mesoshell {

// The generalized winding number of a mesh with periods 1 and aspect, zero high above: copies as far as `copies` periods of
// the larger length, and the constant that the lattice's in-plane symmetry leaves. What is cut off falls with 1 / copies for
// an open mesh and much faster for a closed one.
double brute_force_winding(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, float aspect,
                           const glm::dvec3& point, int copies);

// The same without a constant, far copies smeared into a plane: an infinite sheet that faces up has one half below and minus
// one half above. From a quarter of `copies` periods on, copies fade into the plane.
double balanced_winding(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, float aspect,
                        const glm::dvec3& point, int copies);

// Distance to the nearest triangle or copy of one, for a mesh within `copies` periods.
double brute_force_distance(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, float aspect,
                            const glm::dvec3& point, int copies);

}  // namespace mesoshell
