// A whole scene in one picture: shells among meshes, under lamps and a sky, as Blender's final render shows them.
//
// World space is right-handed with z up; lengths are in world units, colors linear. Nothing is copied: what the spans and
// pointers name must live as long as the call.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/compress.h"
#include "mesoshell/interface.h"
#include "mesoshell/job.h"
#include "mesoshell/sample.h"
#include "mesoshell/shell.h"

namespace mesoshell {

struct SceneShell {
    const Shell* shell = nullptr;
    const Map* map = nullptr;
    const Sample* sample = nullptr;      // the tile, which the traversal `exact` alone asks
    glm::dmat4 world_from_object{1.0};   // any that can be inverted: uneven scales, shears and mirrors too
    ShellParams settings;                // traversal, fins and tolerance; lamps, sky and color are the scene's
    glm::vec3 base_color{0.8f};
    std::int32_t object_index = 0;
    bool visible_camera = true;
    bool visible_shadow = true;          // it casts shadows, on itself too
};

struct SceneMesh {
    std::span<const glm::vec3> positions;   // [n], world space
    std::span<const glm::uvec3> triangles;  // [m], indices of positions
    std::span<const glm::vec3> normals;     // [n] or [3 m] (one a corner), of any length; empty: flat
    std::span<const glm::vec3> colors;      // [m]; empty: base_color
    glm::vec3 base_color{0.8f};
    std::int32_t object_index = 0;
    bool visible_camera = true;
    bool visible_shadow = true;
};

enum class LightType { sun, point, spot, area };
enum class AreaShape { rectangle, ellipse };

// Lamps as Cycles has them (Blender 3.4.1, measured): per cosine of the light's incidence, a white diffuse surface answers
//   sun    color / pi
//   point  color / (4 pi^2 d^2)
//   spot   the same times smoothstep((cos - rim) / ((1 - rim) spot_blend)), where cos is that of the angle to the spot's
//          direction and rim is cos(spot_size / 2); times cos once more with spot_cosine
//   area   color cos / (4 pi d^2), cos being that at the lamp; nothing behind it. (The lamp's radiance is color / (4 A).)
struct SceneLight {
    LightType type = LightType::sun;
    glm::dvec3 position{0.0};             // of all but a sun
    glm::dvec3 direction{0.0, 0.0, -1.0};  // the way the light shines, of any length; of all but a point
    glm::vec3 color{1.0f};                // W/m^2 of a sun, W of the others; not negative
    float radius = 0.0f;                  // of a point or a spot: light comes from a disk that faces the surface
    float angle = 0.0f;                   // of a sun: the angle it covers in the sky, radians, up to pi
    float spot_size = 0.785f;             // the cone's whole angle, radians, up to pi
    float spot_blend = 0.15f;             // 0 to 1
    bool spot_cosine = false;             // as in Cycles 3.4
    AreaShape shape = AreaShape::rectangle;
    glm::vec2 size{1.0f};                 // sides or diameters of an area
    glm::dvec3 axis_x{1.0, 0.0, 0.0};     // where they point, of any length
    glm::dvec3 axis_y{0.0, 1.0, 0.0};
    bool cast_shadow = true;
};

// What surrounds the scene: seen by the camera, and light on every surface without any shadow, as in the viewport.
struct SceneWorld {
    glm::vec3 color{0.0f};  // where there is no image
    // [height, width], row 0 at the bottom (-z); direction d is at u = 1/2 - atan2(d.y, d.x) / 2 pi and v = 1/2 + asin(d.z)
    // / pi, as Blender has it.
    std::span<const glm::vec3> image;
    glm::ivec2 image_size{0};  // width, height
};

struct Scene {
    std::vector<SceneShell> shells;
    std::vector<SceneMesh> meshes;
    std::vector<SceneLight> lights;
    SceneWorld world;
};

struct Film {
    glm::dmat4 clip_from_world{1.0};  // OpenGL clip space, column vectors; perspective or orthographic
    glm::ivec2 size{512};             // width, height
    int samples = 1;                  // rays a pixel, 1 to 65536
    std::uint32_t seed = 0;           // another one has another noise
    // Pixels are averaged with a Blackman-Harris window that ends so many pixels from their centers, 0 to 16, as Cycles
    // does with Blender's filter width; 0: a box of one pixel.
    float filter_width = 1.5f;
    bool transparent = false;         // the sky is not seen: color 0, alpha 0
};

// A picture; row 0 is the bottom. Where nothing is seen: depth 1e10, normal 0, index -1. Depth, normal and index are those
// of the ray through the pixel's center.
struct ScenePicture {
    glm::ivec2 size{0};
    std::vector<glm::vec4> color;       // linear, alpha premultiplied, averaged over the samples
    std::vector<float> depth;           // along the view axis, from the eye (perspective) or the near plane (orthographic)
    std::vector<glm::vec3> normal;      // world space, unit length; a mesh's faces the camera
    std::vector<std::int32_t> index;    // object_index
    std::vector<std::int32_t> fetches;  // texture instructions of all the pixel's rays, shadow rays included
};

// A finished part of the picture's color: `size` pixels from `first`, rows from the bottom.
struct SceneTile {
    glm::ivec2 first{0};
    glm::ivec2 size{0};
    std::vector<glm::vec4> color;
};
// Called by the threads that work, any of them and several at once.
using TileDone = std::function<void(SceneTile)>;

// The first sample of a pixel goes through its center; with more, others are spread by an Owen-scrambled Sobol sequence,
// and positions within the filter follow its window, so that all samples weigh the same. Each of them asks a sun, a point
// or a spot at one place (the center of all is that of a picture of one sample: hard shadows), an area at so many that a
// pixel has 16. Random numbers depend on pixel, sample and seed alone: threads and tiles change no bit.
//
// A shadow ray starts half a voxel above a shell's surface, beyond the traversal's tolerance and what the chord of a prism
// errs there (two and a half voxels for `gdm`, a thousandth of a tile width for `exact`), so contact shadows begin that far
// away. Of a mesh with smooth normals it starts on the round surface that they stand for.
//
// Throws InvalidArgument for what is not finite, out of range or of counts that do not fit, naming it ("meshes[2]: ..."),
// for a map without a distance field and `exact` without a sample; Cancelled.
ScenePicture render_scene(const Scene& scene, const Film& film, Job& job, const TileDone& tile_done = {});

}  // namespace mesoshell
