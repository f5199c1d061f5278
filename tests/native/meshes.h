// The meshes of the tests: solids for tiles, surfaces for shells.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/sample.h"
#include "mesoshell/shell.h"

namespace mesoshell {

// Triangles that wind counterclockwise seen from outside.
struct Mesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;

    Sample sample(float height, float aspect = 1.0f) const { return Sample(positions, triangles, height, aspect); }
};

Mesh merged(const Mesh& a, const Mesh& b);
Mesh moved(Mesh mesh, const glm::vec3& offset);
Mesh flipped(Mesh mesh);

// Vertices on multiples of 2^-12, so that moving them by such multiples is exact.
Mesh snapped(Mesh mesh);

// A UV sphere: a convex polyhedron with its vertices on the sphere and its poles on the z axis.
Mesh sphere(const glm::vec3& center, float radius, int rings, int segments);

// Radius of the largest ball about the center inside a polyhedron that is star-shaped seen from there.
double inner_radius(const Mesh& mesh, const glm::dvec3& center);
// Radius of the smallest ball about the center around a polyhedron.
double outer_radius(const Mesh& mesh, const glm::dvec3& center);

// Two sheets over one period, without side walls: the solid below <= z <= above.
Mesh slab(float below, float above, float aspect = 1.0f, int columns = 3, int rows = 3);

// The solid above z = floor under a roof that rises from z = low at x = start to z = high at x = start + 1, where a
// wall falls back to low; alike for every y.
Mesh sawtooth(float floor, float low, float high, float start, float aspect, int columns = 3, int rows = 3);

// What build_shell reads, with the arrays that it points to.
struct SurfaceMesh {
    std::vector<glm::vec3> positions;
    std::vector<std::int32_t> face_sizes;
    std::vector<std::int32_t> corners;
    std::vector<glm::vec2> uvs;
    std::vector<glm::vec3> normals;

    Surface surface() const { return {positions, face_sizes, corners, uvs, normals, {}, {}, {}, {}}; }
    Shell shell(float thickness, int levels = 0, Scheme scheme = Scheme::catmark) const
    {
        ShellOptions options;
        options.thickness = thickness;
        options.refinement.levels = levels;
        options.refinement.scheme = scheme;
        return build_shell(surface(), options);
    }
};

// Quads over [0, width] x [0, depth] in the plane z = 0 facing up; (u, v) = (x, y) tiles.
SurfaceMesh flat_grid(int columns, int rows, float width, float depth);

// A torus about the z axis; u runs around the axis, v around the tube.
SurfaceMesh torus(float major, float minor, int around, int along, float tiles_u, float tiles_v);

// The triangle (0, 0, 0), (1, 0, 0), (0, 2, 0), whose corners name its vertices in another order; given normals along
// +z.
SurfaceMesh one_triangle();

// The cube [-1, 1]^3 of six quads, each with the whole tile.
SurfaceMesh cube();

// The regular octahedron with vertices at distance 1, of triangles.
SurfaceMesh octahedron();

// An octahedron split `levels` times, its vertices on the unit sphere.
SurfaceMesh round_octahedron(int levels);

}  // namespace mesoshell
