#include "shell_tracer.h"

#include <algorithm>
#include <string>
#include <vector>

#include "embree_scene.h"
#include "exact_tracer.h"
#include "mesoshell/error.h"
#include "mesoshell/sample.h"
#include "mesoshell/traversal.h"
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

}  // namespace

struct ShellTracer::State {
    const Shell& shell;
    const Map& map;
    ShellParams params;
    BoxScene scene;
    shader::Tile tile;
    shader::Tolerance tolerance;
    std::unique_ptr<const ExactTracer> exact;  // null for other traversals

    ShellTraceHit nearest_exact(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const;
};

ShellTracer::ShellTracer(const Shell& shell, const Map& map, const ShellParams& params, const Sample* sample)
    : state_(new State{shell, map, params, BoxScene(prism_boxes(shell)), shader::tile_of(params),
                       shader::tolerance_of(params), exact_tracer(map, params, sample)})
{
}

ShellTracer::~ShellTracer() = default;

// `exact` knows no fins but the true ones: mode.z is not asked.
ShellTraceHit ShellTracer::State::nearest_exact(const glm::vec3& origin, const glm::vec3& dir, float t_near,
                                                float t_far) const
{
    ExactHit nearest;
    ShellTraceHit result;
    scene.visit_along(origin, dir, std::max(t_near, 0.0f), [&](std::uint32_t index, float t_before) {
        const ExactHit hit = exact->nearest(shell.prisms[index], glm::dvec3(origin), glm::dvec3(dir), t_near,
                                            std::min(t_before, t_far));
        const auto t = static_cast<float>(hit.t);
        if (!hit.hit || t >= t_before || t >= t_far) {
            return t_before;
        }
        nearest = hit;
        result.prism = index;
        return t;
    });
    result.hit = nearest.hit;
    result.t = static_cast<float>(nearest.t);
    result.normal = glm::vec3(nearest.normal);
    result.pos_texture = glm::vec3(nearest.pos_texture);
    return result;
}

ShellTraceHit ShellTracer::nearest(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const
{
    if (state_->exact) {
        return state_->nearest_exact(origin, dir, t_near, t_far);
    }
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
