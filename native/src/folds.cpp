#include "mesoshell/folds.h"

#include <algorithm>
#include <atomic>
#include <iterator>

#include "fold_search.h"
#include "parallel.h"
#include "visible_normals.h"

namespace mesoshell {
namespace {

constexpr std::size_t pieces_per_task = 512;
constexpr std::size_t tasks_per_block = 128;
constexpr std::size_t most_spread_pairs = std::size_t(1) << 24;
constexpr std::size_t most_pairs_of_a_piece = 64;  // listed; prisms of more are marked all the same

class Finder {
public:
    Finder(const Shell& shell, Job& job) : shell_(shell), job_(job), search_(shell, job), intersecting_(search_.prisms()) {}

    Folds run()
    {
        const bool any = find_inverted();
        add_lasting();
        cross(any);
        if (!any) {
            spread_pairs();
        }
        folds_.intersecting.resize(search_.prisms());
        for (std::size_t p = 0; p < search_.prisms(); ++p) {
            folds_.intersecting[p] = intersecting_[p].load(std::memory_order_relaxed);
        }
        sort_unique(folds_.pairs);
        folds_.pairs.resize(std::min(folds_.pairs.size(), most_fold_pairs));
        for (const glm::uvec2& pair : folds_.pairs) {
            if (search_.of_base(pair.x, pair.y)) {
                folds_.base[pair.x] = folds_.base[pair.y] = 1;
            }
        }
        return std::move(folds_);
    }

private:
    // Whether any is.
    bool find_inverted()
    {
        const std::size_t count = search_.prisms();
        folds_.inverted.assign(count, 0);
        folds_.base.assign(count, 0);
        std::atomic<bool> any = false;
        const int tasks = static_cast<int>((count + pieces_per_task - 1) / pieces_per_task);
        parallel_for(job_, tasks, [&](int task) {
            const std::size_t first = static_cast<std::size_t>(task) * pieces_per_task;
            for (std::size_t i = first; i < std::min(count, first + pieces_per_task); ++i) {
                const std::uint32_t p = static_cast<std::uint32_t>(i);
                if (inverted(search_.corners(p))) {
                    folds_.inverted[p] = 1;
                    any = true;
                }
            }
        }, 0.2f);
        if (any) {
            const VisibleNormals normals(shell_);
            for (std::uint32_t p = 0; p < count; ++p) {
                folds_.base[p] = folds_.inverted[p] != 0 && !search_.faces_directors(p) && !normals.mendable(p) ? 1 : 0;
            }
        }
        return any;
    }

    void add(std::uint32_t a, std::uint32_t b)
    {
        intersecting_[a].store(1, std::memory_order_relaxed);
        intersecting_[b].store(1, std::memory_order_relaxed);
    }

    // Overlaps that no thickness mends, where there is one.
    void add_lasting()
    {
        for (const std::vector<glm::uvec2>* pairs : {&search_.crossing_surfaces(), &search_.same_side()}) {
            for (const glm::uvec2& pair : *pairs) {
                if (!search_.empty(pair.x) && !search_.empty(pair.y)) {
                    add(pair.x, pair.y);
                    folds_.pairs.push_back(pair);
                    folds_.base[pair.x] = folds_.base[pair.y] = 1;
                }
            }
        }
    }

    void cross(bool all_fins)
    {
        search_.make_pieces(all_fins);
        search_.piece_boxes(boxes_, job_);
        const BoxTree tree(boxes_, job_);
        const std::size_t tasks = (search_.pieces() + pieces_per_task - 1) / pieces_per_task;
        for (std::size_t first = 0; first < tasks; first += tasks_per_block) {
            const std::size_t count = std::min(tasks_per_block, tasks - first);
            const std::size_t room = folds_.pairs.size() < most_fold_pairs ? most_pairs_of_a_piece : 0;
            std::vector<std::vector<glm::uvec2>> found(count);
            parallel_for(job_, static_cast<int>(count), [&](int task) {
                const std::size_t begin = (first + static_cast<std::size_t>(task)) * pieces_per_task;
                for (std::size_t i = begin; i < std::min(search_.pieces(), begin + pieces_per_task); ++i) {
                    cross_piece(tree, static_cast<std::uint32_t>(i), room, found[static_cast<std::size_t>(task)]);
                }
            }, 0.8f * static_cast<float>(count) / static_cast<float>(tasks));
            for (const std::vector<glm::uvec2>& pairs : found) {
                folds_.pairs.insert(folds_.pairs.end(), pairs.begin(), pairs.end());
            }
        }
    }

    // Where nothing is inverted, an overlap's rim is where the boundary crosses; within, prisms overlap neighbors of those that do.
    void spread_pairs()
    {
        std::vector<glm::uvec2> all = folds_.pairs;
        sort_unique(all);
        std::vector<glm::uvec2> front = all;
        while (!front.empty() && all.size() < most_spread_pairs) {
            std::vector<glm::uvec2> next;
            for (const glm::uvec2& pair : front) {
                for (std::uint32_t side = 0; side < 3; ++side) {
                    const auto offer = [&](std::uint32_t a, std::uint32_t b) {
                        if (a != no_neighbor && a != b) {
                            next.emplace_back(std::min(a, b), std::max(a, b));
                        }
                    };
                    const std::uint32_t beside = search_.neighbor(pair.x, side);
                    offer(beside, pair.y);
                    offer(search_.neighbor(pair.y, side), pair.x);
                    // Where columns stand on columns, an overlap goes on only to the next of both.
                    for (std::uint32_t other = 0; beside != no_neighbor && other < 3; ++other) {
                        offer(search_.neighbor(pair.y, other), beside);
                    }
                }
            }
            sort_unique(next);
            std::vector<glm::uvec2> fresh;
            std::set_difference(next.begin(), next.end(), all.begin(), all.end(), std::back_inserter(fresh), ascending);
            std::vector<std::uint8_t> overlap(fresh.size());
            const int tasks = static_cast<int>((fresh.size() + pieces_per_task - 1) / pieces_per_task);
            parallel_for(job_, tasks, [&](int task) {
                const std::size_t first = static_cast<std::size_t>(task) * pieces_per_task;
                for (std::size_t i = first; i < std::min(fresh.size(), first + pieces_per_task); ++i) {
                    overlap[i] = search_.prisms_overlap(fresh[i].x, fresh[i].y, 1.0f) ? 1 : 0;
                }
            }, 0.0f);
            front.clear();
            for (std::size_t i = 0; i < fresh.size(); ++i) {
                if (overlap[i] != 0) {
                    front.push_back(fresh[i]);
                    add(fresh[i].x, fresh[i].y);
                }
            }
            std::vector<glm::uvec2> both;
            std::merge(all.begin(), all.end(), front.begin(), front.end(), std::back_inserter(both), ascending);
            all.swap(both);
        }
        folds_.pairs = std::move(all);
    }

    static void sort_unique(std::vector<glm::uvec2>& pairs)
    {
        std::sort(pairs.begin(), pairs.end(), ascending);
        pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    }

    void cross_piece(const BoxTree& tree, std::uint32_t piece, std::size_t room, std::vector<glm::uvec2>& found)
    {
        const std::uint32_t p = search_.prism_of(piece);
        const std::size_t until = found.size() + room;
        tree.overlapping(boxes_[piece], [&](std::uint32_t other) {
            const std::uint32_t q = search_.prism_of(other);
            if (other <= piece || p == q) {
                return true;
            }
            // Whoever finds them first, both end up marked.
            const bool marked = intersecting_[p].load(std::memory_order_relaxed) != 0 &&
                                intersecting_[q].load(std::memory_order_relaxed) != 0;
            if ((found.size() < until || !marked) && search_.pieces_cross(piece, other)) {
                add(p, q);
                if (found.size() < until) {
                    found.emplace_back(std::min(p, q), std::max(p, q));
                }
            }
            return true;
        });
    }

    const Shell& shell_;
    Job& job_;
    FoldSearch search_;
    std::vector<std::atomic<std::uint8_t>> intersecting_;
    std::vector<Box> boxes_;
    Folds folds_;
};

}  // namespace

Folds find_folds(const Shell& shell, Job& job)
{
    return Finder(shell, job).run();
}

}  // namespace mesoshell
