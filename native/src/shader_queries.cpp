// The shader text's lookups and maps for tests, tools and scripts: many points at once, or one ray and one prism.
#include <cmath>
#include <limits>
#include <string>

#include "map_grids.h"
#include "mesoshell/render.h"
#include "shader_text.h"

namespace mesoshell {
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
    const MapVolumes none;
    const shader::FetchScope scope(map, none);
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
    const MapVolumes volumes(map, MapVolumes::Parts::sdf);
    const shader::FetchScope scope(map, volumes);
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
