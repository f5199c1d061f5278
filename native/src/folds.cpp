#include "mesoshell/folds.h"

#include <algorithm>

#include "fold_overlaps.h"
#include "fold_search.h"
#include "parallel.h"
#include "visible_normals.h"

namespace mesoshell {
namespace {

constexpr std::size_t prisms_per_task = 1024;

// Those that are inverted because of a director that lies behind them, at a vertex where none can lie in front of all faces.
std::vector<std::uint8_t> hopeless_of(const Shell& shell, const FoldSearch& search, const std::vector<std::uint8_t>& inverted)
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
    parallel_for(job, static_cast<int>((count + prisms_per_task - 1) / prisms_per_task), [&](int task) {
        const std::size_t first = static_cast<std::size_t>(task) * prisms_per_task;
        for (std::size_t p = first; p < std::min(count, first + prisms_per_task); ++p) {
            folds.inverted[p] = inverted(search.corners(static_cast<std::uint32_t>(p))) ? 1 : 0;
        }
    });
    const bool any = std::find(folds.inverted.begin(), folds.inverted.end(), 1) != folds.inverted.end();
    folds.base.assign(count, 0);
    if (any) {
        folds.base = hopeless_of(shell, search, folds.inverted);
        search.set_hopeless(folds.base);
    }
    job.stage(0.2f, 1.0f);
    OverlapFinder finder(search, any, job);
    finder.find();
    folds.intersecting.resize(count);
    for (std::uint32_t p = 0; p < count; ++p) {
        folds.intersecting[p] = finder.marked(p) ? 1 : 0;
    }
    folds.pairs = finder.pairs();
    folds.pairs.resize(std::min(folds.pairs.size(), most_fold_pairs));
    for (const glm::uvec2& pair : folds.pairs) {
        if (search.of_base(pair.x, pair.y)) {
            folds.base[pair.x] = folds.base[pair.y] = 1;
        }
    }
    return folds;
}

}  // namespace mesoshell
