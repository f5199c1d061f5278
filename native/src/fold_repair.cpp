// Repair of folds. Every vertex has a share of the asked thickness, at most its limit; limits fall where prisms fold, and
// shares follow them with a bounded slope. A prism whose Jacobian gets too small is cut where it does, which scaling its
// thickness can tell in closed form; two prisms that overlap are scaled by bisection until they do not. As neighbors are
// lowered too, but not by as much, that is repeated for what has changed, and ends with an examination of everything.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "fold_overlaps.h"
#include "fold_search.h"
#include "fold_slope.h"
#include "mesoshell/folds.h"
#include "parallel.h"
#include "visible_normals.h"

namespace mesoshell {
namespace {

constexpr std::size_t per_task = 512;
// A prism keeps at least this much of its Jacobian on the surface: one that all but collapses to a triangle between base and
// top is sound by the sign of its Jacobian alone, but not by what it does to the pattern.
constexpr double least_jacobian = 0.01;
// Where a closed form or a bisection says by how much to lower, a little more, so that rounding does not bring it back.
constexpr float margin = 0.98f;
constexpr int bisections = 7;
// Less than this of the asked thickness becomes none, and so does what still folds after many rounds: prisms without
// thickness have no inside, so that the repair ends.
constexpr float least_share = 1.0f / 1024.0f;
constexpr int most_rounds = 40;
// The least thickness in units of the last place of positions: with less, rounding would turn prisms inside out.
constexpr float least_units = 64.0f;
constexpr int growths = 2;
constexpr float growth = 1.15f;

class Repair {
public:
    Repair(Shell& shell, Job& job)
        : shell_(shell),
          job_(job),
          asked_(shell.thickness),
          search_(shell, job),
          limits_(shell.thickness.size()),
          shares_(shell.thickness.size(), 1.0f),
          changed_(search_.prisms(), 1),
          unmatched_(search_.prisms(), 0)
    {
        for (std::atomic<float>& limit : limits_) {
            limit.store(1.0f, std::memory_order_relaxed);
        }
        for (const float thickness : asked_) {
            greatest_ = std::max(greatest_, thickness);
        }
        for (const glm::vec3& p : shell.positions) {
            farthest_ = std::max(farthest_, std::max(std::abs(p.x), std::max(std::abs(p.y), std::abs(p.z))));
        }
    }

    void run()
    {
        if (greatest_ <= 0.0f) {
            return;
        }
        turn_directors();
        follow_limits();
        std::fill(changed_.begin(), changed_.end(), std::uint8_t(1));
        const std::vector<std::uint8_t> none_inverted;
        OverlapFinder finder(search_, none_inverted, job_);
        if (!settle(finder, true)) {
            return;
        }
        for (int i = 0; i < growths; ++i) {
            grow();
            settle(finder, false);
        }
        sound_.clear();
        do {
            round_ = 0;
            std::fill(changed_.begin(), changed_.end(), std::uint8_t(1));
        } while (settle(finder, true));
    }

private:
    // Lowers what folds until nothing does, examining everything or what has changed. Whether there was anything to lower.
    bool settle(OverlapFinder& finder, bool everything)
    {
        for (bool lowered = false;; everything = false) {
            for (lower_inverted(); follow_limits(); lower_inverted()) {
                lowered = true;
            }
            finder.find(everything ? nullptr : &unmatched_);
            std::fill(unmatched_.begin(), unmatched_.end(), std::uint8_t(0));
            lower_overlapping(finder.pairs());
            if (!follow_limits()) {
                return lowered;
            }
            lowered = true;
        }
    }

    template <typename Work>
    void for_each(std::size_t count, const Work& work)
    {
        parallel_for(job_, static_cast<int>((count + per_task - 1) / per_task), [&](int task) {
            const std::size_t first = static_cast<std::size_t>(task) * per_task;
            for (std::size_t i = first; i < std::min(count, first + per_task); ++i) {
                work(static_cast<std::uint32_t>(i));
            }
        }, 0.0f);
    }

    const VertexPrisms& around()
    {
        if (!around_) {
            around_.emplace(shell_.positions.size(), shell_.topology->triangles);
        }
        return *around_;
    }

    // Directors that lie behind a face around their vertex, to where they are in front of all; without thickness where
    // nothing is.
    void turn_directors()
    {
        std::vector<std::uint8_t> hidden(search_.prisms());
        for_each(search_.prisms(),
                 [&](std::uint32_t p) { hidden[p] = static_cast<std::uint8_t>(search_.hidden_directors(p)); });
        for (std::uint32_t p = 0; p < search_.prisms(); ++p) {
            for (std::uint32_t i = 0; i < 3; ++i) {
                if ((hidden[p] >> i & 1) != 0) {
                    const std::uint32_t vertex = search_.vertices(p)[static_cast<glm::length_t>(i)];
                    const glm::vec3 dir = most_visible_normal(shell_, around(), vertex);
                    if (dir != glm::vec3(0.0f)) {
                        shell_.directors[vertex] = dir;
                    } else {
                        limits_[vertex].store(0.0f, std::memory_order_relaxed);
                    }
                }
            }
        }
    }

    // Neighbors that were lowered as well may have left room. Raises all that is lowered, a little; where that folds,
    // settling takes it back to what it was.
    void grow()
    {
        sound_ = shares_;
        round_ = 0;
        std::vector<std::uint32_t> raised;
        for (std::uint32_t v = 0; v < shares_.size(); ++v) {
            if (shares_[v] > 0.0f && shares_[v] < 1.0f) {
                shares_[v] = std::min(1.0f, shares_[v] * growth);
                limits_[v].store(shares_[v], std::memory_order_relaxed);
                raised.push_back(v);
            } else if (shares_[v] == 0.0f) {
                raised.push_back(v);  // its slope bounds what is around it
            }
        }
        limit_slope(shell_, around(), repair_slope / greatest_, raised, shares_);
        for (const std::uint32_t v : raised) {
            shell_.thickness[v] = asked_[v] * shares_[v];
            for (const std::uint32_t p : around().around(v)) {
                changed_[p] = unmatched_[p] = 1;
            }
        }
    }

    void lower(std::uint32_t prism, float share)
    {
        if (!sound_.empty()) {
            for (int i = 0; i < 3; ++i) {
                const std::uint32_t vertex = search_.vertices(prism)[i];
                limits_[vertex].store(sound_[vertex], std::memory_order_relaxed);
            }
            return;
        }
        if (round_ >= most_rounds) {
            share = 0.0f;
        }
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t vertex = search_.vertices(prism)[i];
            float limit = shares_[vertex] * share * margin;
            if (limit < least_share || limit * asked_[vertex] < least_units * 0x1p-24f * farthest_) {
                limit = 0.0f;
            }
            std::atomic<float>& least = limits_[vertex];
            float seen = least.load(std::memory_order_relaxed);
            while (limit < seen && !least.compare_exchange_weak(seen, limit, std::memory_order_relaxed)) {
            }
        }
    }

    void lower_inverted()
    {
        for_each(search_.prisms(), [&](std::uint32_t p) {
            if (changed_[p] == 0) {
                return;
            }
            const PrismCorners prism = search_.corners(p);
            if (prism.empty()) {
                return;
            }
            const float share = static_cast<float>(sound_share(prism, -shell_.shift, least_jacobian));
            if (share < 1.0f || inverted(prism)) {
                lower(p, share);
            }
        });
    }

    void lower_overlapping(const std::vector<glm::uvec2>& pairs)
    {
        for_each(pairs.size(), [&](std::uint32_t i) {
            const glm::uvec2& pair = pairs[i];
            if (search_.of_base(pair.x, pair.y)) {
                return;
            }
            float sound = 0.0f;
            float folded = 1.0f;
            for (int k = 0; k < bisections; ++k) {
                const float middle = 0.5f * (sound + folded);
                (search_.prisms_overlap(pair.x, pair.y, middle) ? folded : sound) = middle;
            }
            // If they still do at its end, the next rounds go on.
            const float share = std::max(sound, 1.0f / 128.0f);
            lower(pair.x, share);
            lower(pair.y, share);
        });
    }

    // Whether any thickness changed; those prisms are to be examined again.
    bool follow_limits()
    {
        std::fill(changed_.begin(), changed_.end(), std::uint8_t(0));
        std::vector<std::uint32_t> lowered;
        for (std::uint32_t v = 0; v < shares_.size(); ++v) {
            const float limit = limits_[v].load(std::memory_order_relaxed);
            if (limit < shares_[v]) {
                shares_[v] = limit;
                lowered.push_back(v);
            }
        }
        if (lowered.empty()) {
            return false;
        }
        ++round_;
        for (const std::uint32_t v : limit_slope(shell_, around(), repair_slope / greatest_, lowered, shares_)) {
            shell_.thickness[v] = asked_[v] * shares_[v];
            for (const std::uint32_t p : around().around(v)) {
                changed_[p] = unmatched_[p] = 1;
            }
        }
        return true;
    }

    Shell& shell_;
    Job& job_;
    const std::vector<float> asked_;
    FoldSearch search_;
    std::vector<std::atomic<float>> limits_;
    std::vector<float> shares_;
    std::vector<float> sound_;  // shares with which nothing folds; none yet while it is empty
    // One a prism: its thickness has changed since its Jacobian, or its overlaps, were examined.
    std::vector<std::uint8_t> changed_;
    std::vector<std::uint8_t> unmatched_;
    std::optional<VertexPrisms> around_;
    float greatest_ = 0.0f;  // asked thickness
    float farthest_ = 0.0f;  // coordinate
    int round_ = 0;
};

}  // namespace

void repair_folds(Shell& shell, Job& job)
{
    Repair(shell, job).run();
}

}  // namespace mesoshell
