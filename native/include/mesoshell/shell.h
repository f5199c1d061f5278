// The shell: a layer of prisms over a refined surface, each prism a volume of texture space (GDM paper, section 3.1).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/error.h"

namespace mesoshell {

enum class Scheme { catmark, loop, bilinear };

// A polygon mesh as a host hands it over. Faces of any size; `corners` lists the vertices of each face in turn.
struct Surface {
    std::span<const glm::vec3> positions;
    std::span<const std::int32_t> face_sizes;
    std::span<const std::int32_t> corners;
    std::span<const glm::vec2> uvs;      // one a corner, in tiles
    std::span<const glm::vec3> normals;  // one a vertex, used at level 0; computed where empty
};

struct ShellOptions {
    float thickness = 0.1f;  // object units, positive
    int levels = 0;          // 0 to 8 levels of subdivision
    Scheme scheme = Scheme::catmark;
};

// One row of the prism table: eight texels (docs/architecture.md).
using PrismTexels = std::array<glm::vec4, 8>;
static_assert(sizeof(PrismTexels) == 128);

// The triangles to rasterize for one prism: indices 6 p + corner, base 2 triangles' worth of corners 0..2, top 3..5.
// The two triangles of a fin use the diagonal that bulges outward, so that the hull holds the bilinear fin.
using PrismIndices = std::array<std::uint32_t, 24>;

struct Shell {
    std::vector<PrismTexels> prisms;
    std::vector<PrismIndices> indices;
    glm::vec3 lower{0.0f};
    glm::vec3 upper{0.0f};
};

// Prisms of one shell, at most: what the draw program's prism table holds.
constexpr std::int64_t most_prisms = std::int64_t(1) << 22;

// Limit positions and normals where levels > 0, the mesh's own vertices and normals at level 0.
// Throws InvalidArgument for values that are not finite, indices or sizes out of range, missing UVs, a thickness that is not
// positive, more prisms than most_prisms; Error for a mesh that cannot be subdivided, or a face of more than four corners at level 0.
Shell build_shell(const Surface& surface, const ShellOptions& options);

}  // namespace mesoshell
