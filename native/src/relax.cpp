#include "relax.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "groups.h"
#include "incidence.h"
#include "mesoshell/seams.h"
#include "parallel.h"
#include "prism_stretch.h"

namespace mesoshell {
namespace {

constexpr std::size_t items_per_task = 2048;
constexpr int halvings = 12;

// Of the linear system of one step. About thickness over edge length many are needed.
constexpr int most_inner_steps = 100;

// A step that promises less of the total's logarithm than this is rounding.
constexpr double least_gain = 1e-9;

// The share of the promised gain that a step must keep (Armijo's rule).
constexpr double kept_gain = 1e-4;

class Relaxation {
public:
    Relaxation(const Shell& shell, Job& job) : shell_(shell), job_(job), uvs_(shell.topology->uvs), groups_(group_entries())
    {
        const std::size_t count = shell.topology->triangles.size();
        prisms_.reserve(count);
        active_.reserve(count);
        for (std::size_t p = 0; p < count; ++p) {
            prisms_.emplace_back(shell, p);
            active_.push_back(prisms_.back().keeps_winding());
        }
        held_.assign(group_count_, false);
        for (std::size_t p = 0; p < count; ++p) {
            for (int i = 0; i < 3; ++i) {
                corner_groups_.push_back(groups_[shell.topology->uv_triangles[p][i]]);
                if (!active_[p]) {
                    held_[corner_groups_.back()] = true;
                }
            }
        }
        corners_ = std::make_unique<Incidence>(std::span<const std::uint32_t>(corner_groups_), group_count_);
    }

    // The UVs of the top; empty where they stay.
    std::vector<glm::vec2> run(int steps)
    {
        std::vector<glm::dvec2> moved(group_count_, glm::dvec2(0.0));
        std::vector<glm::vec2> top = uvs_;
        double value = evaluate(top).value_or(0.0);
        std::vector<glm::dvec2> direction(group_count_, glm::dvec2(0.0));
        std::vector<glm::dvec2> slope_before;
        double product_before = 0.0;
        double length = 1.0;
        bool gained = false;
        for (int step = 0; step < steps; ++step) {
            const Slopes here = slopes();
            const double product = dot(here.slope, here.downhill);
            // Polak and Ribiere, begun anew where the last direction is of no use.
            double keep = 0.0;
            if (product_before > 0.0) {
                keep = std::max(0.0, (product - dot(slope_before, here.downhill)) / product_before);
            }
            for (std::size_t g = 0; g < group_count_; ++g) {
                direction[g] = here.downhill[g] + direction[g] * keep;
            }
            double promise = dot(here.slope, direction);
            if (promise <= 0.0) {
                direction = here.downhill;
                promise = product;
            }
            if (promise * length < least_gain) {
                break;
            }
            bool lower = false;
            for (int i = 0; i < halvings && !lower; ++i) {
                length *= i > 0 ? 0.5 : 1.0;
                const std::vector<glm::vec2> tried = placed(moved, direction, length);
                const std::optional<double> after = evaluate(tried);
                lower = after && *after <= value - kept_gain * length * promise && tried != top;
                if (lower) {
                    value = *after;
                    top = tried;
                }
            }
            if (!lower && product_before > 0.0) {  // once more without the last direction
                evaluate(top);
                product_before = 0.0;
                length = 1.0;
                continue;
            }
            if (!lower) {
                break;
            }
            gained = true;
            for (std::size_t g = 0; g < group_count_; ++g) {
                moved[g] += direction[g] * length;
            }
            length = std::min(1.0, 2.0 * length);
            slope_before = here.slope;
            product_before = product;
        }
        return gained ? top : std::vector<glm::vec2>();
    }

private:
    // One a group: against the rise of the logarithm of the total squared, and the step to where that would end.
    struct Slopes {
        std::vector<glm::dvec2> slope;
        std::vector<glm::dvec2> downhill;
    };

    // Entries that move alike share a number.
    std::vector<std::uint32_t> group_entries()
    {
        Groups together(uvs_.size());
        for (const SharedEdge& edge : shared_edges(*shell_.topology)) {
            if (pattern_continues(shell_, edge)) {
                for (int k = 0; k < 2; ++k) {
                    together.join(shell_.topology->uv_triangles[edge.prism][edge.ends[k]],
                                  shell_.topology->uv_triangles[edge.other][edge.other_ends[k]]);
                }
            }
        }
        std::vector<std::uint32_t> numbers(uvs_.size());
        for (std::uint32_t i = 0; i < numbers.size(); ++i) {
            const std::uint32_t least = together.find(i);
            numbers[i] = least == i ? static_cast<std::uint32_t>(group_count_++) : numbers[least];
        }
        return numbers;
    }

    template <typename Work>
    void for_all(std::size_t count, const Work& work) const
    {
        parallel_for(job_, static_cast<int>((count + items_per_task - 1) / items_per_task), [&](int task) {
            const std::size_t first = static_cast<std::size_t>(task) * items_per_task;
            work(static_cast<std::size_t>(task), first, std::min(count, first + items_per_task));
        }, 0.0f);
    }

    double dot(const std::vector<glm::dvec2>& a, const std::vector<glm::dvec2>& b) const
    {
        double sum = 0.0;
        for (std::size_t g = 0; g < group_count_; ++g) {
            sum += glm::dot(a[g], b[g]);
        }
        return sum;
    }

    std::vector<glm::vec2> placed(const std::vector<glm::dvec2>& moved, const std::vector<glm::dvec2>& direction,
                                  double length) const
    {
        std::vector<glm::vec2> top(uvs_.size());
        for (std::size_t i = 0; i < top.size(); ++i) {
            top[i] = glm::vec2(glm::dvec2(uvs_[i]) + moved[groups_[i]] + direction[groups_[i]] * length);
        }
        return top;
    }

    // The logarithm of the total squared, but for a constant; nothing where UVs turn over. Leaves the prisms with this top.
    // The total's proportions are its best ones, so that to first order the total changes as if they stayed.
    std::optional<double> evaluate(const std::vector<glm::vec2>& top)
    {
        const std::size_t tasks = (prisms_.size() + items_per_task - 1) / items_per_task;
        std::vector<StretchIntegrals> parts(tasks);
        std::vector<std::uint8_t> turned(tasks, 0);
        for_all(prisms_.size(), [&](std::size_t task, std::size_t first, std::size_t last) {
            for (std::size_t p = first; p < last && turned[task] == 0; ++p) {
                if (!active_[p]) {
                    continue;
                }
                const glm::uvec3& t = shell_.topology->uv_triangles[p];
                prisms_[p].set_top({top[t.x], top[t.y], top[t.z]});
                if (prisms_[p].keeps_winding()) {
                    parts[task] += prisms_[p].integrals();
                } else {
                    turned[task] = 1;
                }
            }
        });
        if (std::find(turned.begin(), turned.end(), 1) != turned.end()) {
            return {};
        }
        sums_ = {};
        for (const StretchIntegrals& part : parts) {
            sums_ += part;
        }
        inverse_aspect_2_ = sums_.u / sums_.v;
        inverse_height_2_ = sums_.u / sums_.w;
        const double volume_2 = 2.0 * std::log(sums_.tiles) - std::log(inverse_aspect_2_ * inverse_height_2_);
        const double value = std::log(sum()) + volume_2 / 3.0;
        return std::isfinite(value) ? std::optional(value) : std::nullopt;
    }

    double sum() const { return sums_.u + sums_.v * inverse_aspect_2_ + sums_.w * inverse_height_2_; }

    // Of the top that was evaluated last.
    Slopes slopes() const
    {
        std::vector<StretchSlope> by_prism(prisms_.size());
        for_all(prisms_.size(), [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t p = first; p < last; ++p) {
                if (active_[p]) {
                    by_prism[p] = prisms_[p].slope(inverse_aspect_2_, inverse_height_2_);
                }
            }
        });
        Slopes slopes{std::vector<glm::dvec2>(group_count_), std::vector<glm::dvec2>(group_count_)};
        std::vector<glm::dmat2> unbend(group_count_, glm::dmat2(0.0));
        for_all(group_count_, [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t g = first; g < last; ++g) {
                glm::dvec2 rise(0.0);
                glm::dmat2 bend(0.0);
                for (const std::uint32_t corner : corners_->of(g)) {
                    const StretchSlope& prism = by_prism[corner / 3];
                    rise += prism.sum[corner % 3] / sum() + prism.tiles[corner % 3] * (2.0 / 3.0 / sums_.tiles);
                    bend += glm::dmat2(prism.bend[corner % 3]);
                }
                const double determinant = glm::determinant(bend);
                if (!held_[g] && determinant > 0.0 && std::isfinite(determinant)) {
                    slopes.slope[g] = -rise;
                    unbend[g] = glm::inverse(bend);
                }
            }
        });
        solve(by_prism, unbend, slopes);
        return slopes;
    }

    // downhill = slope / bend, by conjugate gradients to a twentieth: more is lost on a model of the total.
    void solve(const std::vector<StretchSlope>& by_prism, const std::vector<glm::dmat2>& unbend, Slopes& slopes) const
    {
        std::vector<glm::dvec2> rest(group_count_);
        std::vector<glm::dvec2> ready(group_count_);
        std::vector<glm::dvec2> bent(group_count_);
        std::vector<std::array<glm::dvec2, 3>> by_corner(prisms_.size(), std::array<glm::dvec2, 3>{});
        for (std::size_t g = 0; g < group_count_; ++g) {
            rest[g] = slopes.slope[g] * sum();
            ready[g] = unbend[g] * rest[g];
        }
        std::vector<glm::dvec2> way = ready;
        double left = dot(rest, ready);
        const double enough = 0.0025 * left;
        for (int i = 0; i < most_inner_steps && left > enough; ++i) {
            for_all(prisms_.size(), [&](std::size_t, std::size_t first, std::size_t last) {
                for (std::size_t p = first; p < last; ++p) {
                    const StretchSlope& prism = by_prism[p];
                    const std::uint32_t* groups = &corner_groups_[3 * p];
                    for (int k = 0; k < 3; ++k) {
                        const int next = (k + 1) % 3;
                        const int before = (k + 2) % 3;
                        by_corner[p][k] = glm::dmat2(prism.bend[k]) * way[groups[k]] +
                                          glm::dmat2(prism.bend_next[k]) * way[groups[next]] +
                                          glm::dmat2(prism.bend_next[before]) * way[groups[before]];
                    }
                }
            });
            for_all(group_count_, [&](std::size_t, std::size_t first, std::size_t last) {
                for (std::size_t g = first; g < last; ++g) {
                    bent[g] = glm::dvec2(0.0);
                    for (const std::uint32_t corner : corners_->of(g)) {
                        bent[g] += by_corner[corner / 3][corner % 3];
                    }
                }
            });
            const double length = left / dot(way, bent);
            for (std::size_t g = 0; g < group_count_; ++g) {
                slopes.downhill[g] += way[g] * length;
                rest[g] -= bent[g] * length;
                ready[g] = unbend[g] * rest[g];  // 0 where held
            }
            const double now = dot(rest, ready);
            for (std::size_t g = 0; g < group_count_; ++g) {
                way[g] = ready[g] + way[g] * (now / left);
            }
            left = now;
        }
    }

    const Shell& shell_;
    Job& job_;
    const std::vector<glm::vec2>& uvs_;
    std::size_t group_count_ = 0;
    std::vector<std::uint32_t> groups_;         // one an entry of uvs
    std::vector<std::uint32_t> corner_groups_;  // three a prism
    std::unique_ptr<Incidence> corners_;        // of each group
    std::vector<PrismStretch> prisms_;
    std::vector<bool> active_;
    std::vector<bool> held_;
    double inverse_aspect_2_ = 1.0;
    double inverse_height_2_ = 1.0;
    StretchIntegrals sums_;
};

}  // namespace

void relax_top_uvs(Shell& shell, int steps, Job& job)
{
    if (steps == 0) {
        return;
    }
    shell.top_uvs = Relaxation(shell, job).run(steps);
}

}  // namespace mesoshell
