// Closed forms, in double precision, of what a periodic lattice of balls in a slab must bake to.
//
// A polyhedron that contains one ball and lies in another, about the same center, bakes to values between those of the
// two lattices: a larger solid is hit no later, and its signed distance is nowhere larger. So no test has to guess a
// tolerance for the tessellation or for grazing rays.
#pragma once

#include <glm/glm.hpp>

namespace mesoshell {

struct BallLattice {
    glm::dvec3 center;
    double radius;
    double height;
    double aspect;

    // Distance along a unit direction to the first ball; 0 inside one; where there is none, to the end of the slab, at
    // most horizon_distance.
    double cast(const glm::dvec3& origin, const glm::dvec3& dir) const;

    // Signed distance, for a point in the slab, to the balls cut off at the slab's two planes.
    double signed_distance(const glm::dvec3& point) const;
};

// Distance to where a ray leaves the slab 0 <= z <= height; at most horizon_distance.
double slab_end(double z, double dir_z, double height);

}  // namespace mesoshell
