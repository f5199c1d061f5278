#include "mesoshell/render.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <glm/gtc/matrix_access.hpp>

#include "map_grids.h"
#include "mesoshell/traversal.h"
#include "parallel.h"
#include "shader_text.h"
#include "shell_tracer.h"
#include "view_rays.h"

namespace mesoshell {
namespace {

constexpr int tile_pixels = 16;

// Ray parameter where the ray crosses the far plane, clip z = w; infinite where it does not.
float far_end(const glm::dmat4& clip_from_object, const glm::vec3& origin, const glm::vec3& dir)
{
    const glm::dvec4 far_row = glm::row(clip_from_object, 3) - glm::row(clip_from_object, 2);
    const double at_origin = glm::dot(far_row, glm::dvec4(origin, 1.0));
    const double along = glm::dot(far_row, glm::dvec4(dir, 0.0));
    return along < 0.0 ? static_cast<float>(-at_origin / along) : std::numeric_limits<float>::infinity();
}

}  // namespace

glm::dvec4 eye_of(const glm::dmat4& clip_from_object)
{
    const glm::dmat4 inverse = glm::inverse(clip_from_object);
    // The eye is the one point that the view maps to (0, 0, z, 0).
    const glm::dvec4 eye = inverse * glm::dvec4(0.0, 0.0, 1.0, 0.0);
    const double size = glm::length(glm::dvec3(eye));
    if (!std::isfinite(glm::dot(eye, eye)) || glm::dot(eye, eye) == 0.0) {
        throw InvalidArgument("clip_from_object cannot be inverted; give a projection times a view matrix");
    }
    if (std::abs(eye.w) <= 1e-9 * size) {
        return glm::dvec4(-glm::dvec3(eye) / size, 0.0);
    }
    return eye / eye.w;
}

ShellParams complete_params(const ShellParams& settings, const Map& map, const glm::dmat4& clip_from_object)
{
    check_sdf(map);
    check_traversal(settings.mode.x);
    if (settings.mode.z != shader::FINS_EXACT && settings.mode.z != shader::FINS_PAPER) {
        throw InvalidArgument("fins " + std::to_string(settings.mode.z) + " do not exist; choose 0 for exact or 1 for the paper's two planes "
                              "each");
    }
    ShellParams params = settings;
    params.eye_object = glm::vec4(eye_of(clip_from_object));
    params.gdm_nodes = glm::vec4(glm::vec3(map.resolution.nodes), static_cast<float>((map.terms + 3) / 4));
    params.gdm_directions = glm::vec4(map.resolution.ntheta, azimuth_axes(map), 0.0f);
    params.sdf_nodes = glm::vec4(glm::vec3(map.sdf_nodes), 0.0f);
    params.facet_cells = glm::vec4(glm::vec3(map.facets.cells), 0.0f);
    params.tile = glm::vec4(map.height, map.aspect, map.layout == Layout::share ? 1.0f : 0.0f, 0.0f);
    return params;
}

Rendering render(const Shell& shell, const Map& map, const View& view, const ShellParams& settings, Job& job,
                 const Sample* sample)
{
    const ShellParams params = complete_params(settings, map, view.clip_from_object);
    const ViewRays rays(view);
    const std::size_t pixels = static_cast<std::size_t>(view.size.x) * view.size.y;
    Rendering picture;
    picture.size = view.size;
    picture.color.assign(pixels, glm::vec4(0.0f));
    picture.hit.assign(pixels, 0);
    picture.distance.assign(pixels, std::numeric_limits<float>::infinity());
    picture.normal.assign(pixels, glm::vec3(0.0f));
    picture.texture.assign(pixels, glm::vec3(0.0f));
    picture.prism.assign(pixels, -1);
    picture.fetches.assign(pixels, 0);

    const glm::mat4 clip_from_object(view.clip_from_object);
    const ShellTracer tracer(shell, map, params, sample);
    const auto render_pixel = [&](int x, int y) {
        const PixelRay ray = rays.at(x, y);
        const float t_near = shader::ray_near(clip_from_object, ray.origin, ray.dir);
        const ShellTraceHit hit = tracer.nearest(ray.origin, ray.dir, t_near, far_end(view.clip_from_object, ray.origin, ray.dir));
        const std::size_t pixel = static_cast<std::size_t>(y) * view.size.x + x;
        picture.fetches[pixel] = hit.fetches;
        if (!hit.hit) {
            return;
        }
        picture.hit[pixel] = 1;
        picture.color[pixel] = glm::vec4(shader::hit_color(params, hit.normal), 1.0f);
        picture.distance[pixel] = shader::seen_distance(params.eye_object, hit.t, t_near);
        picture.normal[pixel] = hit.normal;
        picture.texture[pixel] = hit.pos_texture;
        picture.prism[pixel] = static_cast<std::int32_t>(hit.prism);
    };
    const int columns = (view.size.x + tile_pixels - 1) / tile_pixels;
    const int rows = (view.size.y + tile_pixels - 1) / tile_pixels;
    parallel_for(job, columns * rows, [&](int task) {
        const glm::ivec2 first(task % columns * tile_pixels, task / columns * tile_pixels);
        const glm::ivec2 last = glm::min(first + tile_pixels, view.size);
        for (int y = first.y; y < last.y; ++y) {
            for (int x = first.x; x < last.x; ++x) {
                render_pixel(x, y);
            }
        }
    });
    return picture;
}

}  // namespace mesoshell
