// Surfaces whose shells fold.
#pragma once

#include "meshes.h"

namespace mesoshell {

// Flat parts of two surfaces put together, with normals of their own vertices.
SurfaceMesh joined(const SurfaceMesh& a, const SurfaceMesh& b);

// Two unit squares that face each other at a distance, each of cells x cells quads.
SurfaceMesh facing_plates(float distance, int cells);

// Two plates of cells x cells quads, 1 long, that meet at a concave angle (radians) along the y axis.
SurfaceMesh valley(float angle, int cells);

// A sphere of radius 1 with its vertices moved in and out by up to `amount`.
SurfaceMesh bumpy(int levels, float amount, unsigned seed);

// The height field z(x, y) over [0, 1]^2, facing up.
template <typename Height>
SurfaceMesh height_field(int cells, const Height& height)
{
    SurfaceMesh mesh = flat_grid(cells, cells, 1.0f, 1.0f);
    for (glm::vec3& p : mesh.positions) {
        p.z = height(p.x, p.y);
    }
    mesh.normals.clear();
    return mesh;
}

// A head: a sphere with two pits like eye sockets, each with an eyeball of its own inside that does not touch it.
SurfaceMesh sockets(int levels);

// A sphere with long thin spikes.
SurfaceMesh spikes(int levels);

}  // namespace mesoshell
