// The shell: a layer of prisms over a refined surface, each prism a volume of texture space (GDM paper, section 3.1).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/recycled.h"
#include "mesoshell/surface.h"

namespace mesoshell {

// Factors of the thickness, sampled bilinearly and repeating at UVs before they are placed.
struct FactorImage {
    std::span<const float> values;  // [height, width], row 0 at v = 0
    glm::ivec2 size{0};             // width, height
};

// Tiles from UVs: scaled, then turned counterclockwise, then moved. A negative scale mirrors; whole tiles of an offset do nothing.
struct Placement {
    glm::vec2 scale{1.0f};
    float rotation = 0.0f;  // radians
    glm::vec2 offset{0.0f};
};

struct ShellOptions {
    Refinement refinement;
    float thickness = 0.1f;                      // object units, positive
    std::span<const float> thickness_factors;    // one a vertex of the surface, 0 to 1; empty: all 1. A prism
                                                 // of thickness 0 at all its corners is left out
    FactorImage thickness_image;                 // no values: all 1
    float shift = 0.0f;                          // 0 outward, -1/2 centered, -1 inward
    int director_smoothing = 0;                  // steps, 0 to 100
    std::span<const std::uint8_t> covered;       // one a face of the surface: 0 has no prisms; empty: all have
    Placement placement;
    bool repair = false;   // reduce the thickness where prisms fold
    int relax_steps = 0;   // 0 to 100: move the UVs of the top to reduce stretch
};

// One row of the prism table: eight texels (docs/architecture.md).
using PrismTexels = std::array<glm::vec4, 8>;
static_assert(sizeof(PrismTexels) == 128);

// The triangles to rasterize for one prism: indices 6 p + corner, base 2 triangles' worth of corners 0..2, top 3..5.
// The two triangles of a fin use the diagonal that bulges outward, so that the hull holds the bilinear fin.
using PrismIndices = std::array<std::uint32_t, 24>;

// What stays while a surface moves: which vertices and which UVs the prisms have.
struct ShellTopology {
    std::vector<glm::uvec3> triangles;     // one a prism: vertices, counterclockwise seen from outside
    // one a prism: entries of `uvs`, two of which are one where a vertex has equal UVs
    std::vector<glm::uvec3> uv_triangles;
    std::vector<glm::vec2> uvs;            // tiles, at the base
    std::vector<std::int32_t> faces;       // one a prism: the face of the surface it comes from
};

// What an update computes a shell from, beside positions (src/shell_rig.h).
struct ShellRig;

struct Shell {
    std::shared_ptr<const ShellTopology> topology;
    std::shared_ptr<const ShellRig> rig;
    // One a vertex, shared by all prisms around it, so that a fin is the same from both sides.
    std::vector<glm::vec3> positions;  // on the surface, object space
    std::vector<glm::vec3> directors;  // unit length; where no prism has the vertex, the surface's normal or zero
    std::vector<float> thickness;      // object units, from base to top along the director
    // Two directions in the limit surface's tangent plane, of any length; empty at level 0, where there is no limit. Where
    // the surface has several tangent planes, as on a crease, two unit vectors perpendicular to its normal.
    std::vector<glm::mat2x3> tangents;
    std::vector<glm::vec2> top_uvs;    // one an entry of topology->uvs; empty where they are those of the base
    // The base lies at position + shift * thickness * director, the top one thickness above it: 0 outward, -1 inward.
    float shift = 0.0f;

    // The same as the draw program reads it (shell_table.h makes these).
    RecycledVector<PrismTexels> prisms;
    RecycledVector<PrismIndices> indices;
    glm::vec3 lower{0.0f};
    glm::vec3 upper{0.0f};

    glm::vec3 base(std::uint32_t vertex) const
    {
        return positions[vertex] + directors[vertex] * (shift * thickness[vertex]);
    }
    glm::vec3 top(std::uint32_t vertex) const
    {
        return positions[vertex] + directors[vertex] * ((shift + 1.0f) * thickness[vertex]);
    }
};

// Prisms of one shell, at most: what the draw program's prism table holds.
constexpr std::int64_t most_prisms = std::int64_t(1) << 22;

// Limit positions and normals where the surface is refined, the mesh's own vertices and normals at level 0.
// Throws InvalidArgument for values that are not finite, indices or sizes out of range, missing UVs, a thickness that is not
// positive, no covered face, other options out of range or of a wrong count, more prisms than most_prisms; Error for a mesh that
// cannot be subdivided, a face of more than four corners at level 0, a thickness of 0 everywhere, or, where refinement is
// adaptive, more than 256 faces around a vertex or corners around a face, or creases crowded around triangles.
Shell build_shell(const Surface& surface, const ShellOptions& options, Job& job);
inline Shell build_shell(const Surface& surface, const ShellOptions& options)
{
    Job job;
    return build_shell(surface, options, job);
}

// What changes from frame to frame.
struct Pose {
    std::span<const glm::vec3> positions;      // one a vertex of the surface
    std::span<const glm::vec3> normals;        // one a vertex, used at level 0; computed where empty
    std::span<const float> thickness_factors;  // one a vertex, 0 to 1; empty: the thickness stays
};

// The same shell over the same surface elsewhere: topology, UVs and options stay, and so do the diagonals of quads and the
// choice of faces that have an area. Positions, directors and tangents are, bit by bit, those of a shell built there. Throws
// InvalidArgument for counts that do not fit and values that are not finite; Error where a vertex has no normal.
Shell update_shell(const Shell& shell, const Pose& pose, Job& job);
inline Shell update_shell(const Shell& shell, const Pose& pose)
{
    Job job;
    return update_shell(shell, pose, job);
}

}  // namespace mesoshell
