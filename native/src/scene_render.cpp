#include "mesoshell/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/gtc/matrix_access.hpp>

#include "parallel.h"
#include "scene_check.h"
#include "scene_film.h"
#include "scene_geometry.h"
#include "scene_lamps.h"
#include "scene_sky.h"
#include "view_rays.h"

namespace mesoshell {
namespace {

constexpr int tile_pixels = 32;
constexpr float no_depth = 1e10f;

// A plane: its value at a point is the distance from it, where `of` has unit length.
double plane_at(const glm::dvec4& plane, const glm::dvec3& point)
{
    return glm::dot(plane, glm::dvec4(point, 1.0));
}

class SceneRenderer {
public:
    SceneRenderer(const Scene& scene, const Film& film, Job& job)
        : film_(film), rays_({film.clip_from_world, film.size}), filter_(film.filter_width), geometry_(scene),
          sky_(scene.world, job), lamps_(scene.lights.begin(), scene.lights.end()),
          near_(glm::row(film.clip_from_world, 3) + glm::row(film.clip_from_world, 2)),
          far_(glm::row(film.clip_from_world, 3) - glm::row(film.clip_from_world, 2))
    {
        // The view axis is perpendicular to the plane of the eye, clip w = 0; a parallel view has none, but its near plane.
        const glm::dvec4 w = glm::row(film.clip_from_world, 3);
        depth_ = eye_of(film.clip_from_world).w == 0.0 ? near_ : w;
        depth_ /= glm::length(glm::dvec3(depth_));
    }

    void render_pixel(ScenePicture& picture, int x, int y) const
    {
        const std::size_t pixel = static_cast<std::size_t>(y) * film_.size.x + x;
        glm::dvec4 sum(0.0);
        int fetches = 0;
        for (int sample = 0; sample < film_.samples; ++sample) {
            const Place place{mixed(static_cast<std::uint32_t>(pixel), film_.seed), sample};
            const glm::dvec2 offset =
                sample == 0 ? glm::dvec2(0.0) : filter_.offset(spread_point(static_cast<std::uint32_t>(sample), place.seed));
            const WorldRay ray = clipped(rays_.through(glm::dvec2(x + 0.5, y + 0.5) + offset));
            const WorldHit hit = geometry_.nearest(ray, fetches);
            if (hit.hit) {
                sum += glm::dvec4(hit.base_color * light_at(hit, place, fetches), 1.0);
            } else if (!film_.transparent) {
                sum += glm::dvec4(sky_.radiance(ray.dir), 1.0);
            }
            if (sample == 0 && hit.hit) {
                picture.depth[pixel] = static_cast<float>(plane_at(depth_, hit.position));
                picture.normal[pixel] = hit.normal;
                picture.index[pixel] = hit.object_index;
            }
        }
        picture.color[pixel] = glm::vec4(sum / static_cast<double>(film_.samples));
        picture.fetches[pixel] = fetches;
    }

private:
    // Which random numbers a sample has.
    struct Place {
        std::uint32_t seed;  // of the pixel
        int sample;
    };

    WorldRay clipped(const ExactRay& ray) const
    {
        WorldRay clipped{ray.origin, ray.dir, 0.0, std::numeric_limits<double>::infinity()};
        const double toward_near = glm::dot(glm::dvec3(near_), ray.dir);
        if (toward_near != 0.0) {
            clipped.t_near = -plane_at(near_, ray.origin) / toward_near;
        }
        const double toward_far = glm::dot(glm::dvec3(far_), ray.dir);
        if (toward_far < 0.0) {
            clipped.t_far = -plane_at(far_, ray.origin) / toward_far;
        }
        return clipped;
    }

    // Radiance of a white diffuse surface.
    glm::vec3 light_at(const WorldHit& hit, const Place& place, int& fetches) const
    {
        glm::vec3 sum = sky_.ambient(hit.normal);
        for (std::size_t i = 0; i < lamps_.size(); ++i) {
            const Lamp& lamp = lamps_[i];
            const int places = lamp.places(film_.samples);
            const bool spread = lamp.is_soft() && film_.samples * places > 1;
            glm::vec3 light(0.0f);
            for (int k = 0; k < places; ++k) {
                const auto index = static_cast<std::uint32_t>(place.sample * places + k);
                const glm::dvec2 point =
                    spread ? spread_point(index, mixed(place.seed, static_cast<std::uint32_t>(i) + 1)) : glm::dvec2(0.5);
                light += light_from(lamp.at(hit.position, point), lamp.casts_shadow(), hit, fetches);
            }
            sum += light / static_cast<float>(places);
        }
        return sum;
    }

    glm::vec3 light_from(const Incidence& light, bool casts_shadow, const WorldHit& hit, int& fetches) const
    {
        const auto cosine = static_cast<float>(glm::dot(glm::dvec3(hit.normal), light.to_light));
        if (!(cosine > 0.0f) || light.radiance == glm::vec3(0.0f)) {
            return glm::vec3(0.0f);
        }
        if (casts_shadow) {
            WorldRay shadow{hit.above, light.to_light, 0.0, light.distance};
            if (std::isfinite(light.distance)) {
                // From where the ray starts to the very place on the lamp.
                const glm::dvec3 across = hit.position + light.to_light * light.distance - hit.above;
                shadow.t_far = glm::length(across);
                shadow.dir = across / shadow.t_far;
            }
            if (geometry_.occluded(shadow, fetches)) {
                return glm::vec3(0.0f);
            }
        }
        return light.radiance * cosine;
    }

    const Film& film_;
    ViewRays rays_;
    FilmFilter filter_;
    SceneGeometry geometry_;
    Sky sky_;
    std::vector<Lamp> lamps_;
    glm::dvec4 near_;   // clip planes, positive between them
    glm::dvec4 far_;
    glm::dvec4 depth_;  // a point's depth
};

// The pixels of a part of the picture, for whoever shows it while it grows.
SceneTile cut_out(const ScenePicture& picture, const glm::ivec2& first, const glm::ivec2& last)
{
    SceneTile tile{first, last - first, {}};
    for (int y = first.y; y < last.y; ++y) {
        const auto row = picture.color.begin() + static_cast<std::ptrdiff_t>(y) * picture.size.x;
        tile.color.insert(tile.color.end(), row + first.x, row + last.x);
    }
    return tile;
}

}  // namespace

ScenePicture render_scene(const Scene& scene, const Film& film, Job& job, const TileDone& tile_done)
{
    check_film(film);
    check_scene(scene);
    job.throw_if_cancelled();
    const SceneRenderer renderer(scene, film, job);
    const std::size_t pixels = static_cast<std::size_t>(film.size.x) * film.size.y;
    ScenePicture picture;
    picture.size = film.size;
    picture.color.assign(pixels, glm::vec4(0.0f));
    picture.depth.assign(pixels, no_depth);
    picture.normal.assign(pixels, glm::vec3(0.0f));
    picture.index.assign(pixels, -1);
    picture.fetches.assign(pixels, 0);
    const int columns = (film.size.x + tile_pixels - 1) / tile_pixels;
    const int rows = (film.size.y + tile_pixels - 1) / tile_pixels;
    const auto render_tile = [&](int task) {
        const glm::ivec2 first(task % columns * tile_pixels, task / columns * tile_pixels);
        const glm::ivec2 last = glm::min(first + tile_pixels, film.size);
        // A pixel may have thousands of samples: a tile is too long to wait for, be it for an end or for news.
        for (int y = first.y; y < last.y; ++y) {
            for (int x = first.x; x < last.x && !job.cancelled(); ++x) {
                renderer.render_pixel(picture, x, y);
            }
            job.advance(static_cast<float>(last.x - first.x) / static_cast<float>(pixels));
        }
        if (tile_done && !job.cancelled()) {
            tile_done(cut_out(picture, first, last));
        }
    };
    parallel_for(job, columns * rows, render_tile, 0.0f);
    return picture;
}

}  // namespace mesoshell
