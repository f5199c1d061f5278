// The surface a shell lies on: a polygon mesh as a host hands it over, and how it is to be refined.
#pragma once

#include <cstdint>
#include <span>

#include <glm/glm.hpp>

#include "mesoshell/error.h"

namespace mesoshell {

// Faces of any size; `corners` lists the vertices of each face in turn.
struct Surface {
    std::span<const glm::vec3> positions;     // object space
    std::span<const std::int32_t> face_sizes;
    std::span<const std::int32_t> corners;
    std::span<const glm::vec2> uvs;           // one a corner
    std::span<const glm::vec3> normals;       // one a vertex, used at level 0; computed where empty
    // Sharpness as OpenSubdiv has it: 0 smooth, 10 and more infinitely sharp; not negative. Of several for one edge the last
    // counts, and edges that no face has are left out. Used where the surface is refined.
    std::span<const glm::ivec2> crease_edges;  // two vertices each
    std::span<const float> crease_sharpness;
    std::span<const std::int32_t> corner_vertices;
    std::span<const float> corner_sharpness;
};

enum class Scheme { catmark, loop, bilinear };

// What keeps its place where the surface ends: edges follow a curve of their own, corners of one face may be sharp.
enum class Boundary { edges_and_corners, edges };

// Where UVs stay linear (OpenSubdiv's face-varying rules, from all smooth to all linear).
enum class UvRule { smooth, corners, corners_and_junctions, corners_junctions_and_concave, boundaries, linear };

struct Refinement {
    // 0 to 8; 0 keeps the mesh. With an edge length or pixels an edge gets at most 2^levels parts, 2^6 at 0.
    int levels = 0;
    Scheme scheme = Scheme::catmark;
    Boundary boundary = Boundary::edges_and_corners;
    UvRule uv_rule = UvRule::boundaries;
    // Adaptive where positive: each edge of a face is split until its parts are at most this long, with both by whichever
    // asks for more. On the screen only what is in front of the camera and not far beside the picture counts.
    float edge_length = 0.0f;  // object units
    float edge_pixels = 0.0f;  // on the screen of `clip_from_object`
    glm::dmat4 clip_from_object{1.0};
    glm::ivec2 screen{0};  // pixels
};

}  // namespace mesoshell
