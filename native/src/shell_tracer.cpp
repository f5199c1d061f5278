#include "shell_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "embree_scene.h"
#include "exact_tracer.h"
#include "mesoshell/error.h"
#include "mesoshell/sample.h"
#include "mesoshell/traversal.h"
#include "seen_along.h"
#include "shader_text.h"

namespace mesoshell {
namespace {

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

std::unique_ptr<const ExactTracer> exact_tracer(const Map& map, const ShellParams& params, const Sample* sample)
{
    if (params.mode.x != static_cast<int>(Traversal::exact)) {
        return nullptr;
    }
    if (sample == nullptr) {
        throw InvalidArgument("the traversal 'exact' asks the tile itself; pass the sample that the map was baked from");
    }
    if (sample->height() != map.height || sample->aspect() != map.aspect) {
        throw InvalidArgument("the sample's height is " + std::to_string(sample->height()) + " and its aspect " +
                              std::to_string(sample->aspect()) + ", the map's " + std::to_string(map.height) + " and " +
                              std::to_string(map.aspect) + "; pass the sample that the map was baked from");
    }
    return std::make_unique<const ExactTracer>(*sample);
}

// `exact` reads no map.
MapVolumes volumes_for(const Map& map, const ShellParams& params)
{
    const auto traversal = static_cast<Traversal>(params.mode.x);
    if (traversal == Traversal::exact) {
        return {};
    }
    const bool dense = traversal == Traversal::march || traversal == Traversal::slices;
    return {map, dense ? MapVolumes::Parts::sdf_and_density : MapVolumes::Parts::sdf};
}

// Tile widths that a ray must be away from a surface in order not to meet it again: what a traversal takes for the surface,
// and half a voxel, or a whole one for a lookup between whose nodes the surface lies.
float clear_distance(const ShellParams& params)
{
    switch (static_cast<Traversal>(params.mode.x)) {
    case Traversal::exact:
        return 10.0f * static_cast<float>(ExactTracer::most_bulge);
    case Traversal::gdm:
        return (params.tolerance.x + 1.0f) / params.sdf_nodes.x;
    default:
        return (params.tolerance.y + 0.5f) / params.sdf_nodes.x;
    }
}

// Object units along a normal of the solid in which the distance from it grows by a tile width: the length of J^T n, where
// J takes metric texture space to object space. 0 where the texture is flat.
float tile_width_along(const shader::Prism& prism, const glm::vec3& q, const glm::vec3& scale, const glm::vec3& normal)
{
    const glm::vec3 p_q1 = prism.base[1] - prism.base[0] + (prism.director[1] - prism.director[0]) * q.z;
    const glm::vec3 p_q2 = prism.base[2] - prism.base[0] + (prism.director[2] - prism.director[0]) * q.z;
    const glm::vec3 p_w = prism.director[0] * (1.0f - q.x - q.y) + prism.director[1] * q.x + prism.director[2] * q.y;
    const glm::vec2 t_q1 = prism.uv_base[1] - prism.uv_base[0] + (prism.uv_rise[1] - prism.uv_rise[0]) * q.z;
    const glm::vec2 t_q2 = prism.uv_base[2] - prism.uv_base[0] + (prism.uv_rise[2] - prism.uv_rise[0]) * q.z;
    const glm::vec2 t_w = prism.uv_rise[0] * (1.0f - q.x - q.y) + prism.uv_rise[1] * q.x + prism.uv_rise[2] * q.y;
    const glm::mat3 texture_from_place(glm::vec3(t_q1, 0.0f), glm::vec3(t_q2, 0.0f), glm::vec3(t_w, 1.0f));
    const glm::vec3 rises(glm::dot(p_q1, normal), glm::dot(p_q2, normal), glm::dot(p_w, normal));
    const float length = glm::length(glm::transpose(glm::inverse(texture_from_place)) * rises / scale);
    return std::isfinite(length) ? length : 0.0f;
}

}  // namespace

struct ShellTracer::State {
    const Shell& shell;
    const Map& map;
    ShellParams params;
    BoxScene scene;
    MapVolumes volumes;
    shader::Tile tile;
    shader::Tolerance tolerance;
    std::unique_ptr<const ExactTracer> exact;  // null for other traversals

    shader::Prism prism(std::uint32_t index) const { return shader::prism_of(shell.prisms[index]); }
    // Whether meet(prism) is true of any prism along the ray.
    template <typename Meet>
    bool any(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far, const Meet& meet) const;
    ShellTraceHit nearest_exact(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const;
};

ShellTracer::ShellTracer(const Shell& shell, const Map& map, const ShellParams& params, const Sample* sample)
    : state_(new State{shell, map, params, BoxScene(prism_boxes(shell)), volumes_for(map, params), shader::tile_of(params),
                       shader::tolerance_of(params), exact_tracer(map, params, sample)})
{
}

ShellTracer::~ShellTracer() = default;

// `exact` knows no fins but the true ones: mode.z is not asked.
ShellTraceHit ShellTracer::State::nearest_exact(const glm::vec3& origin, const glm::vec3& dir, float t_near,
                                                float t_far) const
{
    const ExactRay ray{glm::dvec3(origin), glm::dvec3(dir)};
    ExactHit nearest;
    ShellTraceHit result;
    const SeenAlong seen(origin, dir);
    const auto visit = [&](std::uint32_t index, float t_before) {
        if (!seen.may_meet(shell.prisms[index])) {
            return t_before;
        }
        const ExactHit hit = exact->nearest(shell.prisms[index], ray, t_near, std::min(t_before, t_far));
        const auto t = static_cast<float>(hit.t);
        if (!hit.hit || t >= t_before || t >= t_far) {
            return t_before;
        }
        nearest = hit;
        result.prism = index;
        return t;
    };
    scene.visit_along(origin, dir, std::max(t_near, 0.0f), visit, t_far);
    result.hit = nearest.hit;
    if (result.hit) {
        result.t = static_cast<float>(nearest.t);
        result.normal = glm::vec3(nearest.normal);
        result.pos_texture = glm::vec3(nearest.pos_texture);
        result.clearance = clear_distance(params) *
                           tile_width_along(prism(result.prism), glm::vec3(nearest.q), tile.scale, result.normal);
    }
    return result;
}

ShellTraceHit ShellTracer::nearest(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const
{
    if (state_->exact) {
        return state_->nearest_exact(origin, dir, t_near, t_far);
    }
    const shader::FetchScope scope(state_->map, state_->volumes);
    shader::ShellHit nearest;
    nearest.hit = false;
    ShellTraceHit result;
    const SeenAlong seen(origin, dir);
    const auto visit = [&](std::uint32_t index, float t_before) {
        if (!seen.may_meet(state_->shell.prisms[index])) {
            return t_before;
        }
        const shader::ShellHit hit = shader::trace_prism(state_->prism(index), origin, dir, t_near, state_->params.mode.z,
                                                         state_->params.mode.x, state_->tile, state_->tolerance);
        result.fetches += hit.fetches;
        if (!hit.hit || hit.t >= t_before || hit.t >= t_far) {
            return t_before;
        }
        nearest = hit;
        result.prism = index;
        return hit.t;
    };
    state_->scene.visit_along(origin, dir, std::max(t_near, 0.0f), visit, t_far);
    result.hit = nearest.hit;
    if (result.hit) {
        const shader::Prism prism = state_->prism(result.prism);
        result.t = nearest.t;
        result.normal = shader::hit_normal(prism, nearest, state_->params.mode.x, state_->tile);
        result.pos_texture = nearest.pos_texture;
        // The hit lies on the ray, but was found on a chord.
        const float off_the_chord = glm::length(origin + dir * nearest.t - shader::prism_position(prism, nearest.q));
        result.clearance = off_the_chord + clear_distance(state_->params) *
                                               tile_width_along(prism, nearest.q, state_->tile.scale, result.normal);
    }
    return result;
}

template <typename Meet>
bool ShellTracer::State::any(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far,
                             const Meet& meet) const
{
    bool met = false;
    const SeenAlong seen(origin, dir);
    const auto visit = [&](std::uint32_t index, float t_before) {
        // The other boxes of a leaf come too.
        met = met || (seen.may_meet(shell.prisms[index]) && meet(index));
        return met ? -std::numeric_limits<float>::infinity() : t_before;
    };
    scene.visit_along(origin, dir, std::max(t_near, 0.0f), visit, t_far);
    return met;
}

ShellOcclusion ShellTracer::any(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const
{
    ShellOcclusion result;
    if (state_->exact) {
        const ExactRay ray{glm::dvec3(origin), glm::dvec3(dir)};
        result.hit = state_->any(origin, dir, t_near, t_far, [&](std::uint32_t index) {
            const ExactHit hit = state_->exact->nearest(state_->shell.prisms[index], ray, t_near, t_far);
            return hit.hit && static_cast<float>(hit.t) < t_far;
        });
        return result;
    }
    const shader::FetchScope scope(state_->map, state_->volumes);
    result.hit = state_->any(origin, dir, t_near, t_far, [&](std::uint32_t index) {
        const shader::ShellHit hit = shader::trace_prism(state_->prism(index), origin, dir, t_near, state_->params.mode.z,
                                                         state_->params.mode.x, state_->tile, state_->tolerance);
        result.fetches += hit.fetches;
        return hit.hit && hit.t < t_far;
    });
    return result;
}

}  // namespace mesoshell
