#include "mesoshell/folds.h"

#include <algorithm>

#include "fold_overlaps.h"
#include "fold_search.h"
#include "parallel.h"
#include "visible_normals.h"

namespace mesoshell {
namespace {

constexpr std::size_t per_task = 1024;

template <typename Work>
void for_each(Job& job, std::size_t count, const Work& work)
{
    parallel_for(job, static_cast<int>((count + per_task - 1) / per_task), [&](int task) {
        const std::size_t first = static_cast<std::size_t>(task) * per_task;
        for (std::size_t i = first; i < std::min(count, first + per_task); ++i) {
            work(i);
        }
    }, 0.0f);
}

// Those that are inverted because of a director that lies behind them, at a vertex where none can lie in front of all faces.
std::vector<std::uint8_t> hopeless_of(const Shell& shell, const FoldSearch& search,
                                      const std::vector<std::uint8_t>& inverted)
{
    const VertexPrisms around(shell.positions.size(), shell.topology->triangles);
    std::vector<std::uint8_t> hopeless(inverted.size(), 0);
    for (std::uint32_t p = 0; p < inverted.size(); ++p) {
        const std::uint32_t hidden = inverted[p] != 0 ? search.hidden_directors(p) : 0;
        for (std::uint32_t i = 0; i < 3; ++i) {
            if ((hidden >> i & 1) != 0 &&
                most_visible_normal(shell, around, search.vertices(p)[static_cast<glm::length_t>(i)]) == glm::vec3(0.0f)) {
                hopeless[p] = 1;
            }
        }
    }
    return hopeless;
}

}  // namespace

Folds find_folds(const Shell& shell, Job& job)
{
    job.stage(0.0f, 0.2f);
    FoldSearch search(shell, job);
    const std::size_t count = search.prisms();
    Folds folds;
    folds.inverted.assign(count, 0);
    for_each(job, count, [&](std::size_t p) {
        folds.inverted[p] = inverted(search.corners(static_cast<std::uint32_t>(p))) ? 1 : 0;
    });
    folds.base.assign(count, 0);
    if (std::find(folds.inverted.begin(), folds.inverted.end(), 1) != folds.inverted.end()) {
        folds.base = hopeless_of(shell, search, folds.inverted);
    }
    job.stage(0.2f, 1.0f);
    OverlapFinder finder(search, folds.inverted, job);
    finder.find();
    folds.intersecting.resize(count);
    for (std::uint32_t p = 0; p < count; ++p) {
        folds.intersecting[p] = finder.marked(p) ? 1 : 0;
    }
    folds.pairs = finder.pairs();
    folds.pairs.resize(std::min(folds.pairs.size(), most_fold_pairs));
    std::vector<std::uint8_t> lasting(folds.pairs.size());
    for_each(job, folds.pairs.size(), [&](std::size_t i) {
        lasting[i] = search.of_base(folds.pairs[i].x, folds.pairs[i].y) ? 1 : 0;
    });
    for (std::size_t i = 0; i < lasting.size(); ++i) {
        if (lasting[i] != 0) {
            folds.base[folds.pairs[i].x] = folds.base[folds.pairs[i].y] = 1;
        }
    }
    return folds;
}

}  // namespace mesoshell
