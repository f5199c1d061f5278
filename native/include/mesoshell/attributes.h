// What the surface of a tile looks like, as 3D textures over the slab: base color, roughness, metallic, smooth normal.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/sample.h"

namespace mesoshell {

// Grids as a distance field has them: node i at i / n along u and v, at i / (n - 1) along w. Every node has the attributes
// of the point of the surface nearest to it, so that textures go on smoothly on both sides of it: filtering meets no
// background.

// For every node the nearest point of the mesh that was given, or rather of its part within the slab, and the outside there.
struct SurfacePoints {
    glm::ivec3 nodes{0};
    std::vector<std::uint32_t> triangles;  // [nz, ny, nx], into Sample::input_triangles
    std::vector<glm::vec2> weights;        // [nz, ny, nx] of the triangle's second and third corner; the first has the rest
    std::vector<glm::vec3> outward;        // [nz, ny, nx] unit normals of the repaired surface nearest to the node
};

// What is shown, as a map holds it. Whoever knows the sample's materials makes it of SurfacePoints.
struct Attributes {
    glm::ivec3 nodes{0};         // all 0: none
    std::vector<float> color;    // [nz, ny, nx, 3] linear base color
    std::vector<float> surface;  // [nz, ny, nx, 2] roughness, metallic
    std::vector<float> normal;   // [nz, ny, nx, 3] smooth normals in metric texture space
};

// nodes: each 2 to 4096. Throws InvalidArgument for nodes out of range or more than memory holds; Cancelled.
SurfacePoints closest_points(const Sample& sample, const glm::ivec3& nodes, Job& job);

}  // namespace mesoshell
