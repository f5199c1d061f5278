#include "fold_overlaps.h"

#include <algorithm>
#include <iterator>

#include "mesoshell/folds.h"
#include "parallel.h"

namespace mesoshell {
namespace {

constexpr std::size_t per_task = 512;
constexpr std::size_t tasks_per_block = 128;
constexpr std::size_t most_pairs_of_a_piece = 64;
constexpr std::size_t most_spread_pairs = std::size_t(1) << 24;

int task_count(std::size_t count)
{
    return static_cast<int>((count + per_task - 1) / per_task);
}

void sort_unique(std::vector<glm::uvec2>& pairs)
{
    std::sort(pairs.begin(), pairs.end(), ascending);
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

}  // namespace

OverlapFinder::OverlapFinder(FoldSearch& search, const std::vector<std::uint8_t>& inverted, Job& job)
    : search_(search), inverted_(inverted), job_(job), parts_(search), marks_(search.prisms())
{
    search_.make_pieces(inverted);
}

bool OverlapFinder::both_inverted(std::uint32_t a, std::uint32_t b) const
{
    return !inverted_.empty() && inverted_[a] != 0 && inverted_[b] != 0;
}

void OverlapFinder::find(const std::vector<std::uint8_t>* active)
{
    search_.piece_boxes(boxes_, job_);
    if (tree_) {
        tree_->refit(boxes_, job_);
    } else {
        tree_.emplace(boxes_, job_);
    }
    for (std::atomic<std::uint8_t>& mark : marks_) {
        mark.store(0, std::memory_order_relaxed);
    }
    pairs_.clear();
    for (const std::vector<glm::uvec2>* lasting : {&search_.crossing_surfaces(), &search_.same_side()}) {
        for (const glm::uvec2& pair : *lasting) {
            if (!search_.empty(pair.x) && !search_.empty(pair.y)) {
                mark(pair.x, pair.y);
                pairs_.push_back(pair);
            }
        }
    }
    cross_pieces(active);
    for (const glm::uvec2& pair : parts_.nested(search_, job_)) {
        mark(pair.x, pair.y);
        pairs_.push_back(pair);
    }
    sort_unique(pairs_);
    spread();
}

void OverlapFinder::mark(std::uint32_t a, std::uint32_t b)
{
    marks_[a].store(1, std::memory_order_relaxed);
    marks_[b].store(1, std::memory_order_relaxed);
}

void OverlapFinder::cross_pieces(const std::vector<std::uint8_t>* active)
{
    // In blocks, so that the number of pairs, and not the time at which threads find them, decides when no more are listed.
    const std::size_t tasks = static_cast<std::size_t>(task_count(search_.pieces()));
    for (std::size_t first = 0; first < tasks; first += tasks_per_block) {
        const std::size_t count = std::min(tasks_per_block, tasks - first);
        const std::size_t room = pairs_.size() < most_fold_pairs ? most_pairs_of_a_piece : 0;
        std::vector<std::vector<glm::uvec2>> found(count);
        parallel_for(job_, static_cast<int>(count), [&](int task) {
            const std::size_t begin = (first + static_cast<std::size_t>(task)) * per_task;
            for (std::size_t i = begin; i < std::min(search_.pieces(), begin + per_task); ++i) {
                cross_piece(static_cast<std::uint32_t>(i), room, active, found[static_cast<std::size_t>(task)]);
            }
        }, 0.0f);
        for (const std::vector<glm::uvec2>& pairs : found) {
            pairs_.insert(pairs_.end(), pairs.begin(), pairs.end());
        }
    }
}

void OverlapFinder::cross_piece(std::uint32_t piece, std::size_t room, const std::vector<std::uint8_t>* active,
                                std::vector<glm::uvec2>& found)
{
    const std::uint32_t p = search_.prism_of(piece);
    if (active != nullptr && (*active)[p] == 0) {
        return;
    }
    const std::size_t until = found.size() + room;
    tree_->overlapping(boxes_[piece], [&](std::uint32_t other) {
        const std::uint32_t q = search_.prism_of(other);
        const bool asks_too = active == nullptr || (*active)[q] != 0;
        if (p == q || (asks_too && other < piece) || both_inverted(p, q)) {
            return true;
        }
        // Whoever finds them first, both end up marked.
        if ((found.size() < until || !marked(p) || !marked(q)) && search_.pieces_cross(piece, other)) {
            mark(p, q);
            if (found.size() < until) {
                found.emplace_back(std::min(p, q), std::max(p, q));
            }
        }
        return true;
    });
}

// An overlap's rim is where the boundary crosses; within, prisms overlap neighbors of those that do.
void OverlapFinder::spread()
{
    std::vector<glm::uvec2> front = pairs_;
    while (!front.empty() && pairs_.size() < most_spread_pairs) {
        const std::vector<glm::uvec2> next = beside(front);
        std::vector<glm::uvec2> fresh;
        std::set_difference(next.begin(), next.end(), pairs_.begin(), pairs_.end(), std::back_inserter(fresh), ascending);
        std::vector<std::uint8_t> overlap(fresh.size());
        parallel_for(job_, task_count(fresh.size()), [&](int task) {
            const std::size_t first = static_cast<std::size_t>(task) * per_task;
            for (std::size_t i = first; i < std::min(fresh.size(), first + per_task); ++i) {
                overlap[i] = search_.prisms_overlap(fresh[i].x, fresh[i].y, 1.0f) ? 1 : 0;
            }
        }, 0.0f);
        front.clear();
        for (std::size_t i = 0; i < fresh.size(); ++i) {
            if (overlap[i] != 0) {
                front.push_back(fresh[i]);
                mark(fresh[i].x, fresh[i].y);
            }
        }
        std::vector<glm::uvec2> both;
        std::merge(pairs_.begin(), pairs_.end(), front.begin(), front.end(), std::back_inserter(both), ascending);
        pairs_.swap(both);
    }
}

std::vector<glm::uvec2> OverlapFinder::beside(const std::vector<glm::uvec2>& pairs) const
{
    std::vector<glm::uvec2> next;
    const auto offer = [&](std::uint32_t a, std::uint32_t b) {
        if (a != no_neighbor && b != no_neighbor && a != b && !both_inverted(a, b)) {
            next.emplace_back(std::min(a, b), std::max(a, b));
        }
    };
    for (const glm::uvec2& pair : pairs) {
        for (std::uint32_t side = 0; side < 3; ++side) {
            const std::uint32_t next_x = search_.neighbor(pair.x, side);
            offer(next_x, pair.y);
            offer(search_.neighbor(pair.y, side), pair.x);
            // Where columns stand on columns, an overlap goes on only to the next of both.
            for (std::uint32_t other = 0; other < 3; ++other) {
                offer(next_x, search_.neighbor(pair.y, other));
            }
        }
    }
    sort_unique(next);
    return next;
}

}  // namespace mesoshell
