#include "box_tree.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include <oneapi/tbb/parallel_sort.h>

#include "parallel.h"

namespace mesoshell {
namespace {

constexpr std::size_t boxes_per_task = 16384;

constexpr Box nothing{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest())};

Box merged(const Box& a, const Box& b)
{
    return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)};
}

int task_count(std::size_t count)
{
    return static_cast<int>((count + boxes_per_task - 1) / boxes_per_task);
}

// Two zeros before each of 21 bits.
std::uint64_t spread(std::uint64_t bits)
{
    bits = (bits | bits << 32) & 0x001f00000000ffffull;
    bits = (bits | bits << 16) & 0x001f0000ff0000ffull;
    bits = (bits | bits << 8) & 0x100f00f00f00f00full;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3ull;
    return (bits | bits << 2) & 0x1249249249249249ull;
}

}  // namespace

BoxTree::BoxTree(std::span<const Box> boxes, Job& job) : order_(boxes.size())
{
    const int tasks = task_count(boxes.size());
    std::vector<Box> bounds(static_cast<std::size_t>(tasks), nothing);
    const auto in_task = [&](int task, const auto& work) {
        const std::size_t first = static_cast<std::size_t>(task) * boxes_per_task;
        for (std::size_t i = first; i < std::min(boxes.size(), first + boxes_per_task); ++i) {
            work(i);
        }
    };
    parallel_for(
        job, tasks,
        [&](int task) {
            in_task(task, [&](std::size_t i) {
                bounds[static_cast<std::size_t>(task)] = merged(bounds[static_cast<std::size_t>(task)], boxes[i]);
            });
        },
        0.0f);
    Box all = nothing;
    for (const Box& box : bounds) {
        all = merged(all, box);
    }
    const glm::dvec3 origin(all.lower);
    const double size = glm::max(glm::max(all.upper.x - origin.x, all.upper.y - origin.y), all.upper.z - origin.z);
    const double scale = size > 0.0 ? 2097151.0 / size : 0.0;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> codes(boxes.size());
    parallel_for(
        job, tasks,
        [&](int task) {
            in_task(task, [&](std::size_t i) {
                const glm::dvec3 place = glm::clamp(
                    (0.5 * (glm::dvec3(boxes[i].lower) + glm::dvec3(boxes[i].upper)) - origin) * scale, 0.0, 2097151.0);
                codes[i] = {spread(static_cast<std::uint64_t>(place.x)) | spread(static_cast<std::uint64_t>(place.y)) << 1 |
                                spread(static_cast<std::uint64_t>(place.z)) << 2,
                            static_cast<std::uint32_t>(i)};
            });
        },
        0.0f);
    oneapi::tbb::task_arena arena(job.threads() > 0 ? job.threads() : oneapi::tbb::task_arena::automatic);
    arena.execute([&] { oneapi::tbb::parallel_sort(codes.begin(), codes.end()); });
    for (std::size_t i = 0; i < codes.size(); ++i) {
        order_[i] = codes[i].second;
    }
    const std::size_t full = (boxes.size() + leaf_size - 1) / leaf_size;
    leaves_ = full == 0 ? 0 : static_cast<std::uint32_t>(std::bit_ceil(full));
    sorted_.resize(boxes.size());
    nodes_.assign(2 * static_cast<std::size_t>(leaves_), nothing);
    refit(boxes, job);
}

void BoxTree::refit(std::span<const Box> boxes, Job& job)
{
    parallel_for(job, task_count(boxes.size()), [&](int task) {
        const std::size_t first = static_cast<std::size_t>(task) * boxes_per_task;
        const std::size_t last = std::min(boxes.size(), first + boxes_per_task);
        for (std::size_t leaf = first; leaf < last; leaf += leaf_size) {
            Box box = nothing;
            for (std::size_t i = leaf; i < std::min(last, leaf + leaf_size); ++i) {
                sorted_[i] = boxes[order_[i]];
                box = merged(box, sorted_[i]);
            }
            nodes_[leaves_ + leaf / leaf_size] = box;
        }
    }, 0.0f);
    for (std::size_t node = leaves_; node-- > 1;) {
        nodes_[node] = merged(nodes_[2 * node], nodes_[2 * node + 1]);
    }
}

}  // namespace mesoshell
