// Subdivision as a table of masks: each refined point is a weighted sum of points before it, so that moved vertices are
// refined again without looking at the topology.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/recycled.h"

namespace mesoshell {

// Three numbers and one unused, so that a point is one SIMD register.
using Lanes __attribute__((vector_size(16))) = float;

// Rows of (index, weights), `Weights` a type of one or more floats. Rows with the same weights share them, which a regular
// mesh has a dozen of: a row costs its indices and 8 bytes.
template <typename Weights>
class MaskRows {
public:
    // Room for so many rows and entries, so that what is about right is never moved.
    void reserve(std::size_t rows, std::size_t entries);
    // Rows are made in turn: entries, then the end of the row.
    void add(std::uint32_t index, const Weights& weights)
    {
        indices_.push_back(index);
        row_.push_back(weights);
    }
    void end_row();
    // No more rows: what only making them needs is freed.
    void finish();

    std::size_t size() const { return rows_.size() - 1; }
    std::span<const std::uint32_t> indices(std::size_t row) const
    {
        return {indices_.data() + rows_[row].first_index, rows_[row + 1].first_index - rows_[row].first_index};
    }
    const Weights* weights(std::size_t row) const { return weights_.data() + rows_[row].first_weight; }
    std::size_t bytes() const
    {
        return rows_.capacity() * sizeof(Row) + indices_.capacity() * sizeof(std::uint32_t) +
            weights_.capacity() * sizeof(Weights);
    }

private:
    struct Row {
        std::uint32_t first_index;
        std::uint32_t first_weight;
    };
    std::vector<Row> rows_{{0, 0}};
    std::vector<std::uint32_t> indices_;
    std::vector<Weights> weights_;

    std::vector<Weights> row_;
    std::pair<std::uint32_t, std::uint32_t> last_{0, 0};  // what the row before has: first weight, count
    std::unordered_multimap<std::uint64_t, std::pair<std::uint32_t, std::uint32_t>> known_;  // by hash: first weight, count
};

struct LimitWeights {
    float position;
    float tangent_1;
    float tangent_2;
    bool operator==(const LimitWeights&) const = default;
};

extern template class MaskRows<float>;
extern template class MaskRows<LimitWeights>;

// The points of all levels in one array, level 0 (the vertices) first. A stretch of rows depends only on points before it.
struct LimitMasks {
    std::size_t vertices = 0;
    MaskRows<float> refinement;                // one a point after the vertices
    std::vector<std::size_t> stretches{0};     // ends of stretches of rows, ascending from 0
    std::size_t last_level = 0;                // the first point of the last level
    MaskRows<LimitWeights> limit;              // one a point of the last level
    std::shared_ptr<BlockPool> pool = std::make_shared<BlockPool>();  // of the points while they are summed

    std::size_t bytes() const { return refinement.bytes() + limit.bytes(); }
};

struct LimitFrames {
    std::vector<glm::vec3> positions;
    std::vector<glm::mat2x3> tangents;  // not of unit length; zero where a mask is
};

// Refines positions, one a vertex. Sums are taken in the order of the rows, whatever the threads.
LimitFrames apply_masks(const LimitMasks& masks, std::span<const glm::vec3> positions, Job& job);

// The same for a number a vertex, without tangents.
std::vector<float> apply_masks(const LimitMasks& masks, std::span<const float> values, Job& job);

}  // namespace mesoshell
