#include "mesoshell/render.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "embree_scene.h"
#include "parallel.h"
#include "shader_text.h"
#include "view_rays.h"

namespace mesoshell {
namespace {

constexpr int tile_pixels = 16;

std::vector<BoxScene::Box> prism_boxes(const Shell& shell)
{
    std::vector<BoxScene::Box> boxes(shell.prisms.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        glm::vec3 lower(shell.prisms[i][0]);
        glm::vec3 upper = lower;
        for (int corner = 1; corner < 6; ++corner) {
            lower = glm::min(lower, glm::vec3(shell.prisms[i][corner]));
            upper = glm::max(upper, glm::vec3(shell.prisms[i][corner]));
        }
        // The fins lie in the convex hull of the corners; the margin covers rounding of the spans.
        const glm::vec3 margin(1e-5f * glm::length(upper - lower));
        boxes[i] = {lower - margin, upper + margin};
    }
    return boxes;
}

class PixelRenderer {
public:
    PixelRenderer(const Shell& shell, const View& view, const ViewRays& rays, const ShellParams& params, const BoxScene& scene,
                  Rendering& picture)
        : shell_(shell), view_(view), rays_(rays), params_(params), scene_(scene), picture_(picture),
          clip_from_object_(view.clip_from_object), tile_(shader::tile_of(params)), tolerance_(shader::tolerance_of(params))
    {
    }

    void render_pixel(int x, int y) const
    {
        const PixelRay ray = rays_.at(x, y);
        const glm::vec3& origin = ray.origin;
        const glm::vec3& dir = ray.dir;
        const float t_near = shader::ray_near(clip_from_object_, origin, dir);

        shader::ShellHit nearest;
        nearest.hit = false;
        std::uint32_t prism_hit = 0;
        int fetches = 0;
        scene_.visit_along(origin, dir, std::max(t_near, 0.0f), [&](std::uint32_t index, float tfar) {
            const shader::ShellHit hit = shader::trace_prism(shader::prism_of(shell_.prisms[index]), origin, dir, t_near,
                                                             params_.mode.z, params_.mode.x, tile_, tolerance_);
            fetches += hit.fetches;
            if (!hit.hit || hit.t >= tfar || shader::window_depth(clip_from_object_, origin + dir * hit.t) > 1.0f) {
                return tfar;
            }
            nearest = hit;
            prism_hit = index;
            return hit.t;
        });

        const std::size_t pixel = static_cast<std::size_t>(y) * view_.size.x + x;
        picture_.fetches[pixel] = fetches;
        if (!nearest.hit) {
            return;
        }
        const glm::vec3 normal = shader::hit_normal(shader::prism_of(shell_.prisms[prism_hit]), nearest, tile_);
        picture_.hit[pixel] = 1;
        picture_.color[pixel] = glm::vec4(shader::hit_color(params_, normal), 1.0f);
        picture_.distance[pixel] = shader::seen_distance(params_.eye_object, nearest.t, t_near);
        picture_.normal[pixel] = normal;
        picture_.texture[pixel] = nearest.pos_texture;
        picture_.prism[pixel] = static_cast<std::int32_t>(prism_hit);
    }

private:
    const Shell& shell_;
    const View& view_;
    const ViewRays& rays_;
    const ShellParams& params_;
    const BoxScene& scene_;
    Rendering& picture_;
    glm::mat4 clip_from_object_;
    shader::Tile tile_;
    shader::Tolerance tolerance_;
};

// Nodes of the azimuth along the weights and the eigenmaps; 0 where they have no such axis.
glm::vec2 azimuth_axes(const Map& map)
{
    const auto axis = [](int azimuths) { return azimuths > 1 ? static_cast<float>(azimuths) : 0.0f; };
    return glm::vec2(axis(map.weight_azimuths()), axis(map.eigen_azimuths()));
}

void check_sdf(const Map& map)
{
    if (map.sdf.empty()) {
        throw InvalidArgument("the map has no distance field; bake one and pass it to compress(..., sdf=...)");
    }
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
    if (settings.mode.x != shader::TRAVERSAL_GDM && settings.mode.x != shader::TRAVERSAL_SDF) {
        throw InvalidArgument("traversal " + std::to_string(settings.mode.x) + " does not exist; choose gdm or sdf");
    }
    if (settings.mode.z != shader::FINS_EXACT && settings.mode.z != shader::FINS_PAPER) {
        throw InvalidArgument("fins " + std::to_string(settings.mode.z) + " do not exist; choose 0 for exact or 1 for the paper's two planes each");
    }
    ShellParams params = settings;
    params.eye_object = glm::vec4(eye_of(clip_from_object));
    params.gdm_nodes = glm::vec4(glm::vec3(map.resolution.nodes), static_cast<float>((map.terms + 3) / 4));
    params.gdm_directions = glm::vec4(map.resolution.ntheta, azimuth_axes(map), 0.0f);
    params.sdf_nodes = glm::vec4(glm::vec3(map.sdf_nodes), 0.0f);
    params.tile = glm::vec4(map.height, map.aspect, map.layout == Layout::share ? 1.0f : 0.0f, 0.0f);
    return params;
}

Rendering render(const Shell& shell, const Map& map, const View& view, const ShellParams& settings, Job& job)
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

    const BoxScene scene(prism_boxes(shell));
    const PixelRenderer renderer(shell, view, rays, params, scene, picture);
    const int columns = (view.size.x + tile_pixels - 1) / tile_pixels;
    const int rows = (view.size.y + tile_pixels - 1) / tile_pixels;
    parallel_for(job, columns * rows, [&](int task) {
        const shader::FetchScope scope(map);
        const glm::ivec2 first(task % columns * tile_pixels, task / columns * tile_pixels);
        const glm::ivec2 last = glm::min(first + tile_pixels, view.size);
        for (int y = first.y; y < last.y; ++y) {
            for (int x = first.x; x < last.x; ++x) {
                renderer.render_pixel(x, y);
            }
        }
    });
    return picture;
}

namespace {

// A lookup at what is no number would read anywhere.
void check_finite(std::span<const glm::vec3> vectors, const std::string& what)
{
    for (std::size_t i = 0; i < vectors.size(); ++i) {
        if (!std::isfinite(glm::dot(vectors[i], vectors[i]))) {
            throw InvalidArgument(what + " " + std::to_string(i) + " is not finite");
        }
    }
}

}  // namespace

std::vector<float> lookup_gdm(const Map& map, std::span<const glm::vec3> pos_texture, std::span<const glm::vec3> dir_metric)
{
    if (pos_texture.size() != dir_metric.size()) {
        throw InvalidArgument("there are " + std::to_string(pos_texture.size()) + " positions but " +
                              std::to_string(dir_metric.size()) + " directions; give one each");
    }
    check_finite(pos_texture, "position");
    check_finite(dir_metric, "direction");
    for (std::size_t i = 0; i < dir_metric.size(); ++i) {
        if (glm::dot(dir_metric[i], dir_metric[i]) == 0.0f) {
            throw InvalidArgument("direction " + std::to_string(i) + " has no length");
        }
    }
    const shader::FetchScope scope(map);
    shader::Tile tile;
    tile.scale = glm::vec3(1.0f, map.aspect, map.height);
    tile.gdm_nodes = glm::vec3(map.resolution.nodes);
    tile.gdm_polar = static_cast<float>(map.resolution.ntheta);
    tile.gdm_azimuths = azimuth_axes(map);
    tile.gdm_groups = (map.terms + 3) / 4;
    tile.gdm_shares = map.layout == Layout::share;
    tile.sdf_nodes = glm::vec3(0.0f);
    std::vector<float> distances(pos_texture.size());
    for (std::size_t i = 0; i < distances.size(); ++i) {
        distances[i] = shader::lookup_gdm(tile, pos_texture[i], glm::normalize(dir_metric[i]));
    }
    return distances;
}

std::vector<float> lookup_sdf(const Map& map, std::span<const glm::vec3> pos_texture)
{
    check_sdf(map);
    check_finite(pos_texture, "position");
    const shader::FetchScope scope(map);
    shader::Tile tile{};
    tile.sdf_nodes = glm::vec3(map.sdf_nodes);
    std::vector<float> distances(pos_texture.size());
    for (std::size_t i = 0; i < distances.size(); ++i) {
        distances[i] = shader::lookup_sdf(tile, pos_texture[i]);
    }
    return distances;
}

std::vector<PrismSpan> prism_spans(const PrismTexels& prism, const glm::vec3& origin, const glm::vec3& dir, float t_near,
                                   bool planes)
{
    const shader::Prism loaded = shader::prism_of(prism);
    shader::PrismPath path = shader::make_prism_path(loaded, origin, dir);
    path.level = path.level || planes;
    std::vector<PrismSpan> result;
    const auto add = [&](const shader::PrismSpan& span) {
        const shader::PrismSpan seen = shader::clip_span(path, span, t_near);
        if (seen.found) {
            result.push_back({seen.t_in, seen.t_out, seen.q_in, seen.q_out});
        }
    };
    if (planes) {
        for (shader::PrismSpan span = shader::plane_span(loaded, origin, dir, -std::numeric_limits<float>::max()); span.found;
             span = shader::plane_span(loaded, origin, dir, span.t_out)) {
            add(span);
        }
        return result;
    }
    if (path.level) {
        add(shader::level_span(loaded, origin, dir, path.level_height));
        return result;
    }
    for (shader::PrismSpan span = shader::next_span(path, -std::numeric_limits<float>::max()); span.found;
         span = shader::next_span(path, span.t_out)) {
        add(span);
    }
    return result;
}

glm::vec3 prism_position(const PrismTexels& prism, const glm::vec3& q)
{
    return shader::prism_position(shader::prism_of(prism), q);
}

glm::vec3 prism_texture(const PrismTexels& prism, const glm::vec3& q)
{
    return shader::prism_texture(shader::prism_of(prism), q);
}

glm::vec3 prism_normal(const PrismTexels& prism, const glm::vec3& q, const glm::vec3& scale, const glm::vec3& gradient_metric)
{
    return shader::prism_normal(shader::prism_of(prism), q, scale, gradient_metric);
}

std::optional<glm::vec3> place_of_position(const PrismTexels& prism, const glm::vec3& pos_object)
{
    const shader::PrismPlace place = shader::place_of_position(shader::prism_of(prism), pos_object);
    return place.found ? std::optional(place.q) : std::nullopt;
}

std::optional<glm::vec3> place_of_texture(const PrismTexels& prism, const glm::vec3& pos_texture)
{
    const shader::PrismPlace place = shader::place_of_texture(shader::prism_of(prism), pos_texture);
    return place.found ? std::optional(place.q) : std::nullopt;
}

std::optional<glm::vec3> texture_of_position(const PrismTexels& prism, const glm::vec3& pos_object)
{
    const shader::PrismPoint point = shader::prism_texture_of_position(shader::prism_of(prism), pos_object);
    return point.found ? std::optional(point.point) : std::nullopt;
}

std::optional<glm::vec3> position_of_texture(const PrismTexels& prism, const glm::vec3& pos_texture)
{
    const shader::PrismPoint point = shader::prism_position_of_texture(shader::prism_of(prism), pos_texture);
    return point.found ? std::optional(point.point) : std::nullopt;
}

}  // namespace mesoshell
