// The reference renderer: the shader text of shaders/lib compiled as C++, and its lookups for tests and tools.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/compress.h"
#include "mesoshell/interface.h"
#include "mesoshell/job.h"
#include "mesoshell/sample.h"
#include "mesoshell/shell.h"

namespace mesoshell {

// A view: OpenGL clip space, column vectors, of `size` (width, height) pixels.
struct View {
    glm::dmat4 clip_from_object{1.0};
    glm::ivec2 size{512};
};

// The center of projection in object space, homogeneous: (position, 1), or (-view direction, 0) for an orthographic view.
// Throws InvalidArgument for a matrix that is not finite or cannot be inverted.
glm::dvec4 eye_of(const glm::dmat4& clip_from_object);

// The uniform block of shaders/interface.toml with everything set that the map and the view determine.
// Throws InvalidArgument for a map without a distance field, which every traversal asks.
ShellParams complete_params(const ShellParams& settings, const Map& map, const glm::dmat4& clip_from_object);

// A picture; row 0 is the bottom. Where nothing is hit: color 0, distance infinite, prism -1.
struct Rendering {
    glm::ivec2 size{0};
    std::vector<glm::vec4> color;       // linear, alpha 1 where hit
    std::vector<std::uint8_t> hit;      // 0 or 1
    std::vector<float> distance;        // object units, from the eye (perspective) or the near plane (orthographic)
    std::vector<glm::vec3> normal;      // object space, unit length
    std::vector<glm::vec3> texture;     // texture space
    std::vector<std::int32_t> prism;    // index of the prism hit
    std::vector<std::int32_t> fetches;  // texture instructions of the pixel's whole ray
};

// mode.x of the settings chooses the traversal (mesoshell/traversal.h), mode.z the fins; mode.y is ignored. `sample` is the tile
// itself: `exact` needs it, whose normals are those of its triangles. Throws InvalidArgument; Cancelled.
Rendering render(const Shell& shell, const Map& map, const View& view, const ShellParams& settings, Job& job,
                 const Sample* sample = nullptr);

// The shader text's lookup of the compressed GDM: tile widths, one a point. Directions need not be normalized.
std::vector<float> lookup_gdm(const Map& map, std::span<const glm::vec3> pos_texture, std::span<const glm::vec3> dir_metric);

// The shader text's lookup of the distance field: tile widths, one a point.
std::vector<float> lookup_sdf(const Map& map, std::span<const glm::vec3> pos_texture);

// Where one ray runs inside one prism, as the shader text finds it: rows of (t_in, t_out, q_in, q_out), nearest first.
struct PrismSpan {
    float t_in;
    float t_out;
    glm::vec3 q_in;
    glm::vec3 q_out;
};
// With `planes`, inside fins that are two planes each, as in the paper (section 3.2), instead of bilinear patches.
std::vector<PrismSpan> prism_spans(const PrismTexels& prism, const glm::vec3& origin, const glm::vec3& dir, float t_near,
                                   bool planes = false);

// The maps of a prism as the shader text computes them. Prism coordinates: weights of corners 1 and 2, and height.
glm::vec3 prism_position(const PrismTexels& prism, const glm::vec3& q);
glm::vec3 prism_texture(const PrismTexels& prism, const glm::vec3& q);
// A gradient of metric texture space carried to object space; scale = (1, aspect, height). Not normalized.
glm::vec3 prism_normal(const PrismTexels& prism, const glm::vec3& q, const glm::vec3& scale, const glm::vec3& gradient_metric);

// Their inverses: prism coordinates, 1e-5 exact for prisms that do not fold; nothing for a point outside the prism by more
// than roundings of its coordinates, or where its texture triangle has no area.
std::optional<glm::vec3> place_of_position(const PrismTexels& prism, const glm::vec3& pos_object);
std::optional<glm::vec3> place_of_texture(const PrismTexels& prism, const glm::vec3& pos_texture);

// From object space to texture space and back.
std::optional<glm::vec3> texture_of_position(const PrismTexels& prism, const glm::vec3& pos_object);
std::optional<glm::vec3> position_of_texture(const PrismTexels& prism, const glm::vec3& pos_texture);

}  // namespace mesoshell
