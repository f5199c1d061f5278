// The shader text of shaders/lib as C++, over fetches from a map. Every file that includes it has the text for itself: GLSL's
// functions are not inline.
//
// GLSL functions take no context, so the map they fetch from is the calling thread's FetchScope.
#pragma once

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

#include "map_volumes.h"
#include "mesoshell/compress.h"
#include "mesoshell/interface.h"
#include "mesoshell/shell.h"

namespace mesoshell::shader {
namespace {

thread_local const Map* fetched_map = nullptr;
thread_local const MapVolumes* fetched_volumes = nullptr;

// Sets what the calling thread fetches from, for its lifetime: a map, and of its volumes those that will be asked.
class FetchScope {
public:
    FetchScope(const Map& map, const MapVolumes& volumes) : map_before_(fetched_map), volumes_before_(fetched_volumes)
    {
        fetched_map = &map;
        fetched_volumes = &volumes;
    }
    ~FetchScope()
    {
        fetched_map = map_before_;
        fetched_volumes = volumes_before_;
    }
    FetchScope(const FetchScope&) = delete;
    FetchScope& operator=(const FetchScope&) = delete;

private:
    const Map* map_before_;
    const MapVolumes* volumes_before_;
};

// The two nodes around a coordinate and the share of the second, on a periodic axis or one that clamps.
struct Bracket {
    int low;
    int high;
    float share;
};

inline Bracket periodic_bracket(float node, int count)
{
    // What is no number stays within the array, and the result is no number either.
    const float below = node >= 0.0f ? std::floor(node) : 0.0f;
    const int low = static_cast<int>(below) % count;
    return {low, (low + 1) % count, node - below};
}

inline Bracket clamped_bracket(float node, int count)
{
    const float inside = node >= 0.0f ? std::min(node, static_cast<float>(count - 1)) : 0.0f;
    const int low = std::min(static_cast<int>(inside), count - 1);
    return {low, std::min(low + 1, count - 1), inside - static_cast<float>(low)};
}

// In an array [nz, ny, nx].
inline float trilinear(const float* values, int nx, int ny, const Bracket& x, const Bracket& y, const Bracket& z)
{
    const auto row = [&](int iz, int iy) {
        const float* const line = values + (static_cast<std::size_t>(iz) * ny + iy) * nx;
        return glm::mix(line[x.low], line[x.high], x.share);
    };
    const float low = glm::mix(row(z.low, y.low), row(z.low, y.high), y.share);
    const float high = glm::mix(row(z.high, y.low), row(z.high, y.high), y.share);
    return glm::mix(low, high, z.share);
}

using namespace glm;  // NOLINT: the shader text speaks GLSL

// GLSL may rearrange sums unless told otherwise; C++ never does.
#define precise
#include "../../shaders/lib/pixel.glsl"
#include "../../shaders/lib/prism_inverse.glsl"
#undef precise

inline Prism prism_of(const PrismTexels& t)
{
    return make_prism(t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7]);
}

// Four terms of a stack of arrays [terms, azimuths, ny, nx].
inline vec4 fetch_terms(const std::vector<float>& stack, int terms, int group, glm::ivec3 nodes, const Bracket& x, const Bracket& y,
                        const Bracket& azimuth)
{
    const std::size_t slice = static_cast<std::size_t>(nodes.x) * nodes.y * nodes.z;
    vec4 four(0.0f);
    for (int i = 0; i < 4 && 4 * group + i < terms; ++i) {
        four[i] = trilinear(stack.data() + (4 * group + i) * slice, nodes.x, nodes.y, x, y, azimuth);
    }
    return four;
}

inline vec4 fetch_gdm_weights(vec3 node, int group)
{
    const Map& map = *fetched_map;
    const glm::ivec3 nodes(map.resolution.nodes.x, map.resolution.nodes.y, map.weight_azimuths());
    return fetch_terms(map.weights, map.terms, group, nodes, periodic_bracket(node.x, nodes.x), periodic_bracket(node.y, nodes.y),
                       periodic_bracket(node.z, nodes.z));
}

inline vec4 fetch_gdm_eigenmaps(vec3 node, int group)
{
    const Map& map = *fetched_map;
    const glm::ivec3 nodes(map.resolution.nodes.z, map.resolution.ntheta, map.eigen_azimuths());
    return fetch_terms(map.eigenmaps, map.terms, group, nodes, clamped_bracket(node.x, nodes.x), clamped_bracket(node.y, nodes.y),
                       periodic_bracket(node.z, nodes.z));
}

inline float fetch_sdf(vec3 node)
{
    return fetched_volumes->sdf.at(node);
}

inline float fetch_density(vec3 node)
{
    return fetched_volumes->density.at(node);
}

inline vec4 fetch_facets(vec3 texel)
{
    const Facets& facets = fetched_map->facets;
    const std::size_t row = static_cast<std::size_t>(texel.z) * facets.cells.y + static_cast<std::size_t>(texel.y);
    const float* const words = facets.texels.data() + 4 * (row * facets.cells.x + static_cast<std::size_t>(texel.x));
    return vec4(words[0], words[1], words[2], words[3]);
}

}  // namespace
}  // namespace mesoshell::shader
