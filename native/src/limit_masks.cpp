#include "limit_masks.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "mesoshell/error.h"
#include "parallel.h"

namespace mesoshell {
namespace {

constexpr std::size_t rows_per_task = 4096;

template <typename Weights>
std::uint64_t hash_of(const std::vector<Weights>& row)
{
    std::uint64_t hash = 0xcbf29ce484222325u ^ row.size();
    const auto* words = reinterpret_cast<const unsigned char*>(row.data());
    for (std::size_t i = 0; i < row.size() * sizeof(Weights); i += sizeof(std::uint32_t)) {
        std::uint32_t word = 0;
        std::memcpy(&word, words + i, sizeof(word));
        hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
    }
    return hash;
}

// work(row) for every row in [first, last).
template <typename Work>
void for_rows(Job& job, std::size_t first, std::size_t last, const Work& work)
{
    const int tasks = static_cast<int>((last - first + rows_per_task - 1) / rows_per_task);
    parallel_for(job, tasks, [&](int task) {
        const std::size_t begin = first + static_cast<std::size_t>(task) * rows_per_task;
        for (std::size_t row = begin; row < std::min(last, begin + rows_per_task); ++row) {
            work(row);
        }
    }, 0.0f);
}

template <typename Value>
void refine_all(const LimitMasks& masks, Value* points, Job& job)
{
    for (std::size_t i = 0; i + 1 < masks.stretches.size(); ++i) {
        for_rows(job, masks.stretches[i], masks.stretches[i + 1], [&](std::size_t row) {
            const std::span<const std::uint32_t> indices = masks.refinement.indices(row);
            const float* weights = masks.refinement.weights(row);
            Value sum{};
            for (std::size_t k = 0; k < indices.size(); ++k) {
                sum += points[indices[k]] * weights[k];
            }
            points[masks.vertices + row] = sum;
        });
    }
}

glm::vec3 vector_of(const Lanes& lanes)
{
    return {lanes[0], lanes[1], lanes[2]};
}

}  // namespace

template <typename Weights>
void MaskRows<Weights>::end_row()
{
    const auto is_row = [&](const std::pair<std::uint32_t, std::uint32_t>& stored) {
        return stored.second == row_.size() && std::equal(row_.begin(), row_.end(), weights_.begin() + stored.first);
    };
    if (!is_row(last_)) {  // neighbors are mostly alike
        const std::uint64_t hash = hash_of(row_);
        const auto [begin, end] = known_.equal_range(hash);
        const auto same = std::find_if(begin, end, [&](const auto& entry) { return is_row(entry.second); });
        if (same != end) {
            last_ = same->second;
        } else {
            if (weights_.size() + row_.size() > std::numeric_limits<std::uint32_t>::max()) {
                throw Error("the surface has too many faces around its vertices to be subdivided; use levels = 0");
            }
            last_ = {static_cast<std::uint32_t>(weights_.size()), static_cast<std::uint32_t>(row_.size())};
            known_.emplace(hash, last_);
            weights_.insert(weights_.end(), row_.begin(), row_.end());
        }
    }
    rows_.back().first_weight = last_.first;
    row_.clear();
    if (indices_.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw Error("the surface is too large to be subdivided; use fewer levels or a coarser mesh");
    }
    rows_.push_back({static_cast<std::uint32_t>(indices_.size()), 0});
}

template <typename Weights>
void MaskRows<Weights>::reserve(std::size_t rows, std::size_t entries)
{
    rows_.reserve(rows + 1);
    indices_.reserve(entries);
}

template <typename Weights>
void MaskRows<Weights>::finish()
{
    known_ = {};
    row_ = {};
    weights_.shrink_to_fit();
    if (indices_.capacity() > indices_.size() + indices_.size() / 4) {
        indices_.shrink_to_fit();
    }
}

template class MaskRows<float>;
template class MaskRows<LimitWeights>;

LimitFrames apply_masks(const LimitMasks& masks, std::span<const glm::vec3> positions, Job& job)
{
    RecycledVector<Lanes> points(masks.vertices + masks.refinement.size(), RecycledAllocator<Lanes>(masks.pool));
    for (std::size_t i = 0; i < masks.vertices; ++i) {
        points[i] = Lanes{positions[i].x, positions[i].y, positions[i].z, 0.0f};
    }
    refine_all(masks, points.data(), job);
    LimitFrames frames;
    frames.positions.resize(masks.limit.size());
    frames.tangents.resize(masks.limit.size());
    for_rows(job, 0, masks.limit.size(), [&](std::size_t row) {
        const std::span<const std::uint32_t> indices = masks.limit.indices(row);
        const LimitWeights* weights = masks.limit.weights(row);
        Lanes position{};
        Lanes tangent_1{};
        Lanes tangent_2{};
        for (std::size_t k = 0; k < indices.size(); ++k) {
            const Lanes point = points[indices[k]];
            position += point * weights[k].position;
            tangent_1 += point * weights[k].tangent_1;
            tangent_2 += point * weights[k].tangent_2;
        }
        frames.positions[row] = vector_of(position);
        frames.tangents[row] = glm::mat2x3(vector_of(tangent_1), vector_of(tangent_2));
    });
    return frames;
}

std::vector<float> apply_masks(const LimitMasks& masks, std::span<const float> values, Job& job)
{
    UninitializedVector<float> points(masks.vertices + masks.refinement.size());
    std::copy(values.begin(), values.end(), points.begin());
    refine_all(masks, points.data(), job);
    std::vector<float> limit(masks.limit.size());
    for_rows(job, 0, masks.limit.size(), [&](std::size_t row) {
        const std::span<const std::uint32_t> indices = masks.limit.indices(row);
        const LimitWeights* weights = masks.limit.weights(row);
        float sum = 0.0f;
        for (std::size_t k = 0; k < indices.size(); ++k) {
            sum += points[indices[k]] * weights[k].position;
        }
        limit[row] = sum;
    });
    return limit;
}

}  // namespace mesoshell
