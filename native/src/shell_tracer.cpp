#include "shell_tracer.h"

#include <algorithm>
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
    state_->scene.visit_along(origin, dir, std::max(t_near, 0.0f), [&](std::uint32_t index, float t_before) {
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
    });
    result.hit = nearest.hit;
    if (result.hit) {
        result.t = nearest.t;
        result.normal = shader::hit_normal(shader::prism_of(state_->shell.prisms[result.prism]), nearest, state_->tile);
        result.pos_texture = nearest.pos_texture;
    }
    return result;
}

}  // namespace mesoshell
