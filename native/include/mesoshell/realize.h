// The independent truth: the tile's own triangles warped into the shell, and Embree on that mesh.
// Nothing here shares code with the traversals or with the shader text.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/render.h"
#include "mesoshell/sample.h"
#include "mesoshell/shell.h"

namespace mesoshell {

struct RealizeOptions {
    // How far the straight edges may lie beside the curves that the prism map makes of the tile's, in tile widths as wide as
    // the shell's tiles are in the mean; positive.
    float error = 1e-3f;
    // Close the solid where the slab cuts it at w = 0 and w = 1, and where the pattern ends, at the border of the shell and
    // at seams that cut it. Without, it is open there.
    bool caps = true;
    // Three a triangle of Sample::input_triangles, unit length: how its corners are shaded. Empty: none are made.
    std::span<const glm::vec3> normals;
};

struct RealizedMesh {
    std::vector<glm::vec3> positions;   // object space; no two are equal
    std::vector<glm::uvec3> triangles;  // counterclockwise seen from outside
    // Three a triangle.
    std::vector<glm::vec3> texture;  // (u, v, w): tiles, as the prism's UVs count them, and height
    std::vector<glm::vec2> weights;  // in the source triangle, of its corners b and c; a has the rest
    // Unit length, where RealizeOptions has normals: the input's by the inverse transpose of the map's Jacobian, one for all
    // corners at a vertex where they are one in the tile, though the map has a kink at a fin. Caps have their faces'.
    std::vector<glm::vec3> normals;
    // One a triangle.
    std::vector<std::uint32_t> source;  // of Sample::input_triangles: what it shows; at caps, what is near
    std::vector<std::uint32_t> prism;
    std::size_t open_edges = 0;  // out of balance: used more often one way than the other
};

// For every prism: the tile's triangles that its texture triangle covers, clipped to it, split until the bilinear map bends
// them by little, and mapped. Vertices on a fin are the same from both sides, and edges there are split alike, so that the
// result is closed wherever the tile is and the pattern continues. Solids of the tile that cross one another still do.
//
// Where base and top have different UVs the texture triangle is another at each height: the tile's triangles are split
// first, and a few small holes may be left where one of its edges passes a prism's column very near. open_edges counts what
// is open.
//
// Throws InvalidArgument for options out of range or of a wrong count, UVs that span more than 4096 tiles in a prism, a prism whose UVs turn
// over between base and top, and a result of more than 2^30 triangles; Cancelled.
RealizedMesh realize(const Shell& shell, const Sample& sample, const RealizeOptions& options, Job& job);
inline RealizedMesh realize(const Shell& shell, const Sample& sample, Job& job)
{
    return realize(shell, sample, {}, job);
}

// A picture of any triangle mesh; row 0 is the bottom. Nothing hit: distance infinite, normal 0.
struct Trace {
    glm::ivec2 size{0};
    std::vector<std::uint8_t> hit;
    std::vector<float> distance;    // as in Rendering
    std::vector<glm::vec3> normal;  // of the triangle, unit length, facing as it winds
};

Trace trace(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, const View& view, Job& job);

}  // namespace mesoshell
