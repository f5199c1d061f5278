#include "limit_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "limit_refiner.h"
#include "parallel.h"

namespace mesoshell {
namespace {

constexpr std::size_t vertices_per_task = 4096;

// work(first, last) for stretches of [0, count).
template <typename Work>
void for_stretches(Job& job, std::size_t count, const Work& work)
{
    const int tasks = static_cast<int>((count + vertices_per_task - 1) / vertices_per_task);
    parallel_for(job, tasks, [&](int task) {
        const std::size_t first = static_cast<std::size_t>(task) * vertices_per_task;
        work(first, std::min(count, first + vertices_per_task));
    }, 0.0f);
}

glm::vec3 unit_or_zero(const glm::vec3& v)
{
    const float size = glm::length(v);
    return size > 0.0f && std::isfinite(size) ? v / size : glm::vec3(0.0f);
}

// Zero where the tangents are parallel but for what rounding leaves of them.
glm::vec3 normal_of(const glm::mat2x3& tangents)
{
    constexpr float least_sine = 1e-5f;
    const glm::vec3 normal = glm::cross(tangents[0], tangents[1]);
    const float size = glm::length(normal);
    const float sides = glm::length(tangents[0]) * glm::length(tangents[1]);
    return size > least_sine * sides && std::isfinite(size) ? normal / size : glm::vec3(0.0f);
}

glm::mat2x3 frame_of(const glm::vec3& normal)
{
    if (normal == glm::vec3(0.0f)) {
        return glm::mat2x3(0.0f);
    }
    const glm::vec3 axis = std::abs(normal.x) < 0.6f ? glm::vec3(1.0f, 0.0f, 0.0f) : glm::vec3(0.0f, 1.0f, 0.0f);
    const glm::vec3 along = glm::normalize(axis - normal * glm::dot(axis, normal));
    return glm::mat2x3(along, glm::cross(normal, along));
}

RefinedTopology unrefined(const Surface& surface)
{
    RefinedTopology same;
    same.face_sizes.assign(surface.face_sizes.begin(), surface.face_sizes.end());
    same.corners.assign(surface.corners.begin(), surface.corners.end());
    same.faces.resize(surface.face_sizes.size());
    std::iota(same.faces.begin(), same.faces.end(), 0);
    UvTopology uvs = share_uvs(surface);
    same.uv_corners = std::move(uvs.indices);
    same.uvs = std::move(uvs.values);
    return same;
}

}  // namespace

LimitSurface::LimitSurface(const Surface& surface, const Refinement& refinement, Job& job)
    : vertices_(surface.positions.size())
{
    const bool adaptive = refinement.edge_length > 0.0f || refinement.edge_pixels > 0.0f;
    if (refinement.levels == 0 && !adaptive) {
        topology_ = unrefined(surface);
    } else {
        Refined refined = adaptive ? refine_adaptively(surface, refinement, job)
                                    : refine_uniformly(surface, refinement, job);
        topology_ = std::move(refined.topology);
        evaluator_ = std::move(refined.evaluator);
        sharp_ = CornerFans(topology_.face_sizes, topology_.corners, refined.sharp);
    }
    face_sizes_ = topology_.face_sizes;
    corners_ = topology_.corners;
}

void LimitSurface::mend_normals(LimitPoints& points, const CornerFans& fans, Job& job) const
{
    for_stretches(job, fans.size(), [&](std::size_t first, std::size_t last) {
        for (std::size_t fan = first; fan < last; ++fan) {
            const std::uint32_t vertex = fans.vertex(fan);
            points.normals[vertex] = fans.normal(fan, points.positions);
            if (!points.tangents.empty()) {
                points.tangents[vertex] = frame_of(points.normals[vertex]);
            }
        }
    });
}

LimitPoints LimitSurface::evaluate(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals, Job& job) const
{
    if (!evaluator_) {
        LimitPoints points;
        points.positions.assign(positions.begin(), positions.end());
        points.normals.resize(vertices_);
        if (normals.empty()) {
            std::call_once(fans_made_, [&] {
                fans_ = CornerFans(face_sizes_, corners_, std::vector<bool>(vertices_, true));
            });
            mend_normals(points, fans_, job);
        } else {
            std::transform(normals.begin(), normals.end(), points.normals.begin(), unit_or_zero);
        }
        return points;
    }
    LimitPoints points = evaluator_->evaluate(positions, job);
    points.normals.resize(points.positions.size());
    std::mutex lock;
    std::vector<std::uint32_t> without;
    for_stretches(job, points.positions.size(), [&](std::size_t first, std::size_t last) {
        std::vector<std::uint32_t> here;
        for (std::size_t i = first; i < last; ++i) {
            points.normals[i] = normal_of(points.tangents[i]);
            if (points.normals[i] == glm::vec3(0.0f)) {
                here.push_back(static_cast<std::uint32_t>(i));
            }
        }
        if (!here.empty()) {
            const std::lock_guard guard(lock);
            without.insert(without.end(), here.begin(), here.end());
        }
    });
    if (!without.empty()) {
        std::vector<bool> chosen(points.positions.size(), false);
        for (const std::uint32_t vertex : without) {
            chosen[vertex] = true;
        }
        mend_normals(points, CornerFans(face_sizes_, corners_, chosen), job);
    }
    mend_normals(points, sharp_, job);
    return points;
}

std::vector<float> LimitSurface::interpolate(std::span<const float> values, Job& job) const
{
    return evaluator_ ? evaluator_->interpolate(values, job) : std::vector<float>(values.begin(), values.end());
}

std::size_t LimitSurface::bytes() const
{
    return (evaluator_ ? evaluator_->bytes() : 0) + face_sizes_.capacity() * sizeof(std::int32_t) +
           corners_.capacity() * sizeof(std::int32_t) + sharp_.bytes() + fans_.bytes();
}

}  // namespace mesoshell
