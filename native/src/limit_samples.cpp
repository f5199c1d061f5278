#include "limit_samples.h"

#include <utility>

namespace mesoshell {
namespace {

class SampleEvaluator : public LimitEvaluator {
public:
    SampleEvaluator(std::vector<Patch> patches, LimitSamples samples, std::size_t points)
        : patches_(std::move(patches)), samples_(std::move(samples)), points_(points)
    {
    }

    LimitPoints evaluate(std::span<const glm::vec3> positions, Job& job) const override
    {
        LimitPoints limit;
        limit.positions.resize(points_);
        limit.tangents.resize(points_, glm::mat2x3(0.0f));
        std::copy(positions.begin(), positions.end(), limit.positions.begin());  // for vertices without faces
        for_faces(job, static_cast<int>(patches_.size()), [&](int face) {
            const PatchOver<glm::vec3> patch(patches_[face], positions);
            for (const LimitSample& sample : samples_.of(face)) {
                glm::mat2x3& tangents = limit.tangents[sample.point];
                limit.positions[sample.point] = patch.at(sample.place, tangents[0], tangents[1]);
            }
        });
        return limit;
    }

    std::vector<float> interpolate(std::span<const float> values, Job& job) const override
    {
        std::vector<float> limit(points_);
        std::copy(values.begin(), values.end(), limit.begin());
        for_faces(job, static_cast<int>(patches_.size()), [&](int face) {
            const PatchOver<float> patch(patches_[face], values);
            // Patches around extraordinary points are fitted, and may have small negative weights.
            const auto [least, greatest] = std::minmax_element(patch.controls().begin(), patch.controls().end());
            for (const LimitSample& sample : samples_.of(face)) {
                limit[sample.point] = std::clamp(patch.at(sample.place), *least, *greatest);
            }
        });
        return limit;
    }

    std::size_t bytes() const override
    {
        return patches_.capacity() * sizeof(Patch) + samples_.all.capacity() * sizeof(LimitSample);
    }

private:
    std::vector<Patch> patches_;
    LimitSamples samples_;
    std::size_t points_;
};

}  // namespace

std::unique_ptr<LimitEvaluator> evaluate_samples(std::vector<Patch> patches, LimitSamples samples, std::size_t points)
{
    return std::make_unique<SampleEvaluator>(std::move(patches), std::move(samples), points);
}

}  // namespace mesoshell
