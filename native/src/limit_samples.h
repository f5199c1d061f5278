// Points of a refined surface as places on the patches of faces, and what they are evaluated by.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "limit_patches.h"
#include "limit_surface.h"
#include "parallel.h"

namespace mesoshell {

// work(face) for every face, some at a time.
template <typename Work>
void for_faces(Job& job, int faces, const Work& work)
{
    constexpr int faces_per_task = 64;
    parallel_for(job, (faces + faces_per_task - 1) / faces_per_task, [&](int task) {
        for (int face = task * faces_per_task; face < std::min(faces, (task + 1) * faces_per_task); ++face) {
            work(face);
        }
    }, 0.0f);
}

// A face's patch over vectors of `Value`, floats without gaps.
template <typename Value>
class PatchOver {
public:
    PatchOver(const Patch& patch, std::span<const Value> values) : patch_(patch), points_(patch.GetNumPatchPoints())
    {
        const Patch::PointDescriptor rows(size);
        patch.PreparePatchPoints(reinterpret_cast<const float*>(values.data()), rows,
                                 reinterpret_cast<float*>(points_.data()), rows);
    }
    Value at(const glm::vec2& place) const
    {
        Value value;
        patch_.Evaluate(&place.x, reinterpret_cast<const float*>(points_.data()), size, reinterpret_cast<float*>(&value));
        return value;
    }
    Value at(const glm::vec2& place, Value& along_u, Value& along_v) const
    {
        Value value;
        patch_.Evaluate(&place.x, reinterpret_cast<const float*>(points_.data()), size, reinterpret_cast<float*>(&value),
                        reinterpret_cast<float*>(&along_u), reinterpret_cast<float*>(&along_v));
        return value;
    }
    // The patch's control points come first among its points.
    std::span<const Value> controls() const
    {
        return {points_.data(), static_cast<std::size_t>(patch_.GetNumControlPoints())};
    }

private:
    static constexpr int size = sizeof(Value) / sizeof(float);
    const Patch& patch_;
    std::vector<Value> points_;
};

// A point of the refined surface: where it is on the patch of the face that evaluates it.
struct LimitSample {
    std::uint32_t point;
    glm::vec2 place;
};

// Samples by face.
struct LimitSamples {
    std::vector<std::size_t> firsts;  // one a face, and the end
    std::vector<LimitSample> all;

    std::span<const LimitSample> of(int face) const { return {all.data() + firsts[face], firsts[face + 1] - firsts[face]}; }
};

// Evaluates `points` points: the samples of every face on its patch, one a face. Vertices without faces come first and stay.
std::unique_ptr<LimitEvaluator> evaluate_samples(std::vector<Patch> patches, LimitSamples samples, std::size_t points);

}  // namespace mesoshell
