#include "fold_search.h"

#include <algorithm>
#include <array>
#include <limits>

#include "fold_parts.h"
#include "parallel.h"
#include "predicates.h"

namespace mesoshell {
namespace {

constexpr std::size_t prisms_per_task = 1024;

int task_count(std::size_t count)
{
    return static_cast<int>((count + prisms_per_task - 1) / prisms_per_task);
}

template <typename Work>
void for_task(std::size_t count, int task, const Work& work)
{
    const std::size_t first = static_cast<std::size_t>(task) * prisms_per_task;
    for (std::size_t i = first; i < std::min(count, first + prisms_per_task); ++i) {
        work(static_cast<std::uint32_t>(i));
    }
}

Box box_of(std::span<const glm::vec3> points)
{
    Box box{points[0], points[0]};
    for (const glm::vec3& point : points.subspan(1)) {
        box.extend(point);
    }
    return box;
}

glm::dvec3 middle_of(const PrismCorners& prism)
{
    return (glm::dvec3(prism.base[0]) + glm::dvec3(prism.base[1]) + glm::dvec3(prism.base[2])) / 3.0;
}

// Whether a plane along a face of one keeps the corners, and so all, of two prisms apart by more than rounding can hide.
// Spares most pairs the dozens of exact tests.
bool separated(const PrismCorners& a, const PrismCorners& b)
{
    double farthest = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (const glm::vec3& corner : {a.base[i], a.top[i], b.base[i], b.top[i]}) {
            farthest = std::max(farthest, glm::length(glm::dvec3(corner)));
        }
    }
    const auto apart_along = [&](const glm::dvec3& axis) {
        double least_a = std::numeric_limits<double>::max(), most_a = -least_a, least_b = least_a, most_b = -least_a;
        const auto reach = [&](const PrismCorners& prism, double& least, double& most) {
            for (std::size_t i = 0; i < 6; ++i) {
                const double at = glm::dot(axis, glm::dvec3(i < 3 ? prism.base[i] : prism.top[i - 3]));
                least = std::min(least, at);
                most = std::max(most, at);
            }
        };
        reach(a, least_a, most_a);
        reach(b, least_b, most_b);
        // Sums of three products are off by less than 4 2^-53 times the lengths of what is multiplied.
        const double size = glm::length(axis) * farthest;
        return std::max(least_a - most_b, least_b - most_a) > 1e-14 * size;
    };
    for (const PrismCorners* prism : {&a, &b}) {
        const auto point = [&](std::size_t i, bool top) { return glm::dvec3(top ? prism->top[i] : prism->base[i]); };
        for (const bool top : {false, true}) {
            if (apart_along(glm::cross(point(1, top) - point(0, top), point(2, top) - point(0, top)))) {
                return true;
            }
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t next = (i + 1) % 3;
            if (apart_along(glm::cross(point(next, true) - point(i, false), point(i, true) - point(next, false)))) {
                return true;
            }
        }
    }
    return false;
}

constexpr Box no_box{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest())};

Box whole_box(const PrismCorners& prism)
{
    Box box = box_of(prism.base);
    for (const glm::vec3& point : prism.top) {
        box.extend(point);
    }
    return box;
}

Patch fin_of(const PrismCorners& prism, std::uint32_t side)
{
    const std::uint32_t next = (side + 1) % 3;
    return {prism.base[side], prism.base[next], prism.top[next], prism.top[side]};
}

}  // namespace

FoldSearch::FoldSearch(const Shell& shell, Job& job)
    : shell_(shell), triangles_(shell.topology->triangles), borders_(find_borders(*shell.topology, job))
{
    cross_surfaces(job);
}

PrismCorners FoldSearch::corners(std::uint32_t prism, float scale) const
{
    PrismCorners result;
    const glm::uvec3& triangle = triangles_[prism];
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t vertex = triangle[static_cast<glm::length_t>(i)];
        const float thickness = shell_.thickness[vertex] * scale;
        result.base[i] = shell_.positions[vertex] + shell_.directors[vertex] * (shell_.shift * thickness);
        result.top[i] = shell_.positions[vertex] + shell_.directors[vertex] * ((shell_.shift + 1.0f) * thickness);
    }
    return result;
}

bool FoldSearch::empty(std::uint32_t prism) const
{
    return corners(prism).empty();
}

std::uint32_t FoldSearch::hidden_directors(std::uint32_t prism) const
{
    const Triangle t = surface(prism);
    std::uint32_t hidden = 0;
    for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t vertex = triangles_[prism][static_cast<glm::length_t>(i)];
        if (shell_.thickness[vertex] > 0.0f &&
            determinant_sign({t[0], t[1]}, {t[0], t[2]}, {glm::vec3(0.0f), shell_.directors[vertex]}) <= 0) {
            hidden |= 1u << i;
        }
    }
    return hidden;
}

Triangle FoldSearch::surface(std::uint32_t prism) const
{
    const glm::uvec3& t = triangles_[prism];
    return {shell_.positions[t.x], shell_.positions[t.y], shell_.positions[t.z]};
}

void FoldSearch::cross_surfaces(Job& job)
{
    std::vector<Box> boxes(prisms());
    const int tasks = task_count(prisms());
    parallel_for(job, tasks, [&](int task) {
        for_task(prisms(), task, [&](std::uint32_t p) { boxes[p] = box_of(surface(p)); });
    }, 0.0f);
    const BoxTree tree(boxes, job);
    std::vector<std::vector<glm::uvec2>> found(static_cast<std::size_t>(tasks));
    parallel_for(job, tasks, [&](int task) {
        for_task(prisms(), task, [&](std::uint32_t p) {
            const Triangle own = surface(p);
            tree.overlapping(boxes[p], [&](std::uint32_t q) {
                if (q > p && crossing(own, Inside::front, surface(q), Inside::front)) {
                    found[static_cast<std::size_t>(task)].emplace_back(p, q);
                }
                return true;
            });
        });
    }, 0.0f);
    for (const std::vector<glm::uvec2>& pairs : found) {
        crossing_surfaces_.insert(crossing_surfaces_.end(), pairs.begin(), pairs.end());
    }
    std::sort(crossing_surfaces_.begin(), crossing_surfaces_.end(), ascending);
}

void FoldSearch::make_pieces(const std::vector<std::uint8_t>& inverted)
{
    const auto is_inverted = [&](std::uint32_t prism) { return !inverted.empty() && inverted[prism] != 0; };
    fins_.clear();
    for (std::uint32_t prism = 0; prism < prisms(); ++prism) {
        for (std::uint32_t side = 0; side < 3; ++side) {
            if (is_border({prism, side}) || is_inverted(prism) || is_inverted(neighbor(prism, side))) {
                fins_.push_back({prism, side});
            }
        }
    }
}

std::uint32_t FoldSearch::prism_of(std::uint32_t piece) const
{
    const std::uint32_t count = static_cast<std::uint32_t>(prisms());
    return piece < count ? piece : piece < 2 * count ? piece - count : fins_[piece - 2 * count].prism;
}

void FoldSearch::piece_boxes(std::vector<Box>& boxes, Job& job) const
{
    boxes.resize(pieces());
    parallel_for(job, task_count(prisms()), [&](int task) {
        for_task(prisms(), task, [&](std::uint32_t p) {
            const PrismCorners prism = corners(p);
            const bool nothing = prism.empty();
            boxes[p] = nothing ? no_box : box_of(prism.base);
            boxes[prisms() + p] = nothing ? no_box : box_of(prism.top);
        });
    }, 0.0f);
    parallel_for(job, task_count(fins_.size()), [&](int task) {
        for_task(fins_.size(), task, [&](std::uint32_t i) {
            const PrismCorners prism = corners(fins_[i].prism);
            boxes[2 * prisms() + i] = prism.empty() ? no_box : box_of(fin_of(prism, fins_[i].side));
        });
    }, 0.0f);
}

bool FoldSearch::share_vertex(std::uint32_t a, std::uint32_t b) const
{
    const glm::uvec3& t = triangles_[a];
    const glm::uvec3& s = triangles_[b];
    const auto has = [&](std::uint32_t vertex) { return s.x == vertex || s.y == vertex || s.z == vertex; };
    return has(t.x) || has(t.y) || has(t.z);
}

bool FoldSearch::fins_cross(const Fin& fin, const PrismCorners& prism_a, const Fin& other, const PrismCorners& prism_b) const
{
    const glm::uvec3& t = triangles_[fin.prism];
    const glm::uvec3& s = triangles_[other.prism];
    const auto edge = [](const glm::uvec3& triangle, std::uint32_t side) {
        const std::uint32_t a = triangle[static_cast<glm::length_t>(side)];
        const std::uint32_t b = triangle[static_cast<glm::length_t>((side + 1) % 3)];
        return std::pair(std::min(a, b), std::max(a, b));
    };
    if (edge(t, fin.side) == edge(s, other.side)) {
        return false;
    }
    const bool shared = share_vertex(fin.prism, other.prism);
    // Fins between prisms meet those beside them by right.
    if (shared && !(is_border(fin) && is_border(other))) {
        return false;
    }
    return crossing(fin_of(prism_a, fin.side), fin_of(prism_b, other.side), !shared);
}

bool FoldSearch::pieces_cross(std::uint32_t a, std::uint32_t b) const
{
    const std::uint32_t count = static_cast<std::uint32_t>(prisms());
    if (a > b) {
        std::swap(a, b);
    }
    const std::uint32_t p = prism_of(a);
    const std::uint32_t q = prism_of(b);
    // The layer that is the surface crosses itself whatever the thickness: crossing_surfaces has those.
    if ((shell_.shift == 0.0f && b < count) || (shell_.shift == -1.0f && a >= count && b < 2 * count)) {
        return false;
    }
    const PrismCorners prism_a = corners(p);
    const PrismCorners prism_b = corners(q);
    if (b < 2 * count) {
        return crossing(a < count ? prism_a.base : prism_a.top, a < count ? Inside::front : Inside::back,
                        b < count ? prism_b.base : prism_b.top, b < count ? Inside::front : Inside::back);
    }
    const Fin& fin = fins_[b - 2 * count];
    if (a < 2 * count) {
        const bool shared = share_vertex(p, q);
        return crossing(fin_of(prism_b, fin.side), a < count ? prism_a.base : prism_a.top,
                        a < count ? Inside::front : Inside::back, !shared);
    }
    return p != q && fins_cross(fins_[a - 2 * count], prism_a, fin, prism_b);
}

bool FoldSearch::prisms_overlap(std::uint32_t a, std::uint32_t b, float scale) const
{
    const PrismCorners prism_a = corners(a, scale);
    const PrismCorners prism_b = corners(b, scale);
    if (prism_a.empty() || prism_b.empty() || !whole_box(prism_a).overlaps(whole_box(prism_b)) ||
        separated(prism_a, prism_b)) {
        return false;
    }
    const bool base_is_surface = shell_.shift == 0.0f;
    const bool top_is_surface = shell_.shift == -1.0f;
    if ((!base_is_surface && crossing(prism_a.base, Inside::front, prism_b.base, Inside::front)) ||
        (!top_is_surface && crossing(prism_a.top, Inside::back, prism_b.top, Inside::back)) ||
        crossing(prism_a.base, Inside::front, prism_b.top, Inside::back) ||
        crossing(prism_a.top, Inside::back, prism_b.base, Inside::front)) {
        return true;
    }
    const bool shared = share_vertex(a, b);
    const auto fin_meets = [&](const Fin& fin, const PrismCorners& own, const PrismCorners& other) {
        const Patch patch = fin_of(own, fin.side);
        return !(shared && !is_border(fin)) && (crossing(patch, other.base, Inside::front, !shared) ||
                                                crossing(patch, other.top, Inside::back, !shared));
    };
    for (std::uint32_t side = 0; side < 3; ++side) {
        if (fin_meets({a, side}, prism_a, prism_b) || fin_meets({b, side}, prism_b, prism_a)) {
            return true;
        }
        for (std::uint32_t other = 0; other < 3; ++other) {
            if (fins_cross({a, side}, prism_a, {b, other}, prism_b)) {
                return true;
            }
        }
    }
    // Without a crossing, one may lie inside the other.
    return !shared && (holds(prism_a, middle_of(prism_b)) || holds(prism_b, middle_of(prism_a)));
}

bool FoldSearch::of_base(std::uint32_t a, std::uint32_t b) const
{
    const glm::uvec2 pair(std::min(a, b), std::max(a, b));
    const auto listed = [&](const std::vector<glm::uvec2>& pairs) {
        return std::binary_search(pairs.begin(), pairs.end(), pair, ascending);
    };
    if (listed(crossing_surfaces_) || listed(borders_.same_side)) {
        return true;
    }
    return share_vertex(a, b) && prisms_overlap(a, b, 1.0f / 128.0f);
}

}  // namespace mesoshell
