#include "shell_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "embree_scene.h"
#include "mesoshell/sample.h"
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

// Object units along the normal in which the distance to the solid rises by a tile width; 0 where the prism is flat.
float tile_width_at(const shader::Prism& prism, const glm::vec3& q, const shader::Tile& tile, const glm::vec3& gradient)
{
    const glm::vec3 p_q1 = prism.base[1] - prism.base[0] + (prism.director[1] - prism.director[0]) * q.z;
    const glm::vec3 p_q2 = prism.base[2] - prism.base[0] + (prism.director[2] - prism.director[0]) * q.z;
    const glm::vec3 p_w = prism.director[0] * (1.0f - q.x - q.y) + prism.director[1] * q.x + prism.director[2] * q.y;
    // prism_normal is the gradient in object space times the Jacobian's determinant.
    const float slope = glm::length(shader::prism_normal(prism, q, tile.scale, gradient));
    const float volume = std::abs(glm::dot(p_q1, glm::cross(p_q2, p_w)));
    return slope > 0.0f ? volume * glm::length(gradient) / slope : 0.0f;
}

// Voxels that a ray must be away from a surface in order not to meet it again: what a traversal takes for the surface, and half a
// voxel, or a whole one for a lookup between whose nodes the surface lies.
float clear_voxels(const ShellParams& params)
{
    return params.mode.x == shader::TRAVERSAL_GDM ? params.tolerance.x + 1.0f : params.tolerance.y + 0.5f;
}

}  // namespace

struct ShellTracer::State {
    const Shell& shell;
    const Map& map;
    ShellParams params;
    BoxScene scene;
    shader::Tile tile;
    shader::Tolerance tolerance;
};

ShellTracer::ShellTracer(const Shell& shell, const Map& map, const ShellParams& params, const Sample* /*sample*/)
    : state_(new State{shell, map, params, BoxScene(prism_boxes(shell)), shader::tile_of(params), shader::tolerance_of(params)})
{
}

ShellTracer::~ShellTracer() = default;

ShellTraceHit ShellTracer::nearest(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const
{
    const shader::FetchScope scope(state_->map);
    shader::ShellHit nearest;
    nearest.hit = false;
    ShellTraceHit result;
    const auto visit = [&](std::uint32_t index, float t_before) {
        const shader::ShellHit hit =
            shader::trace_prism(shader::prism_of(state_->shell.prisms[index]), origin, dir, t_near, state_->params.mode.z,
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
        const shader::Prism prism = shader::prism_of(state_->shell.prisms[result.prism]);
        result.t = nearest.t;
        result.normal = shader::hit_normal(prism, nearest, state_->tile);
        result.pos_texture = nearest.pos_texture;
        // The hit lies on the ray, but was found on a chord.
        const float off_the_chord = glm::length(origin + dir * nearest.t - shader::prism_position(prism, nearest.q));
        const glm::vec3 gradient = shader::sdf_gradient(state_->tile, nearest.pos_texture);
        result.clearance = off_the_chord + clear_voxels(state_->params) / state_->params.sdf_nodes.x *
                                               tile_width_at(prism, nearest.q, state_->tile, gradient);
    }
    return result;
}

ShellOcclusion ShellTracer::any(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const
{
    const shader::FetchScope scope(state_->map);
    ShellOcclusion result;
    const auto visit = [&](std::uint32_t index, float t_before) {
        if (!result.hit) {  // the other boxes of a leaf come too
            const shader::ShellHit hit =
                shader::trace_prism(shader::prism_of(state_->shell.prisms[index]), origin, dir, t_near, state_->params.mode.z,
                                    state_->params.mode.x, state_->tile, state_->tolerance);
            result.fetches += hit.fetches;
            result.hit = hit.hit && hit.t < t_far;
        }
        return result.hit ? -std::numeric_limits<float>::infinity() : t_before;
    };
    state_->scene.visit_along(origin, dir, std::max(t_near, 0.0f), visit, t_far);
    return result;
}

}  // namespace mesoshell
