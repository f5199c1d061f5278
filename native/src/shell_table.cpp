#include "shell_table.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "parallel.h"
#include "shell_rig.h"

namespace mesoshell {
namespace {

constexpr int prisms_per_task = 4096;

// The hulls of prism 0 by which of its fins rise along their first diagonal, bit i for the fin from corner i.
constexpr std::array<PrismIndices, 8> hulls = [] {
    std::array<PrismIndices, 8> all{};
    for (std::uint32_t rising = 0; rising < 8; ++rising) {
        PrismIndices& hull = all[rising];
        hull = {0, 2, 1, 3, 4, 5};
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t j = (i + 1) % 3;
            using Fin = std::array<std::uint32_t, 6>;
            const Fin fin = (rising >> i & 1) != 0 ? Fin{i, j, j + 3, i, j + 3, i + 3} : Fin{i, j, i + 3, j, j + 3, i + 3};
            for (std::uint32_t k = 0; k < 6; ++k) {
                hull[6 + 6 * i + k] = fin[k];
            }
        }
    }
    return all;
}();

using Lanes __attribute__((vector_size(16))) = float;

// The ends of each vertex's director, which some six prisms share. A last lane takes a prism's u.
struct Ends {
    Lanes base;
    Lanes top;
};

Lanes lanes(const glm::vec3& p)
{
    return Lanes{p.x, p.y, p.z, 0.0f};
}

glm::vec3 vector(const Lanes& lanes)
{
    return {lanes[0], lanes[1], lanes[2]};
}

std::uint32_t rising_fins(const std::array<Lanes, 6>& corners)
{
    std::uint32_t rising = 0;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const glm::vec3 outward = glm::cross(vector(corners[j] - corners[i]), vector(corners[j + 3] - corners[i]));
        rising |= (glm::dot(outward, vector(corners[i + 3] - corners[i])) <= 0.0f ? 1u : 0u) << i;
    }
    return rising;
}

// Rows that this thread has stored are seen by others before what it does next.
void order_stores()
{
#ifdef __SSE2__
    _mm_sfence();
#endif
}

// Writes 16 bytes of a table that is larger than any cache and is not read again here: without first reading what was there,
// where the processor can. Tables and their rows begin at multiples of 16 bytes.
template <typename Quad>
void store(void* place, const Quad& quad)
{
    static_assert(sizeof(Quad) == 16);
#ifdef __SSE2__
    _mm_stream_si128(static_cast<__m128i*>(place), std::bit_cast<__m128i>(quad));
#else
    std::memcpy(place, &quad, sizeof(Quad));
#endif
}

}  // namespace

void make_table(Shell& shell, Job& job)
{
    const std::size_t count = shell.topology->triangles.size();
    const int tasks = static_cast<int>((count + prisms_per_task - 1) / prisms_per_task);
    const std::shared_ptr<BlockPool> pool = shell.rig ? shell.rig->pool : nullptr;
    shell.prisms = RecycledVector<PrismTexels>(count, RecycledAllocator<PrismTexels>(pool));
    shell.indices = RecycledVector<PrismIndices>(count, RecycledAllocator<PrismIndices>(pool));
    struct Bounds {
        glm::vec3 lower{std::numeric_limits<float>::max()};
        glm::vec3 upper{std::numeric_limits<float>::lowest()};
    };
    std::vector<Bounds> bounds(static_cast<std::size_t>(tasks));
    const std::size_t vertices = shell.positions.size();
    RecycledVector<Ends> ends(vertices, RecycledAllocator<Ends>(pool));
    parallel_for(job, static_cast<int>((vertices + prisms_per_task - 1) / prisms_per_task), [&](int task) {
        const std::size_t first = static_cast<std::size_t>(task) * prisms_per_task;
        for (std::size_t v = first; v < std::min(vertices, first + prisms_per_task); ++v) {
            ends[v] = {lanes(shell.base(static_cast<std::uint32_t>(v))), lanes(shell.top(static_cast<std::uint32_t>(v)))};
        }
    }, 0.0f);
    const std::vector<glm::vec2>& uvs_base = shell.topology->uvs;
    const std::vector<glm::vec2>& uvs_top = shell.top_uvs.empty() ? uvs_base : shell.top_uvs;
    parallel_for(job, tasks, [&](int task) {
        using Indices __attribute__((vector_size(16))) = std::uint32_t;
        const float most = std::numeric_limits<float>::max();
        Lanes lower{most, most, most, most};
        Lanes upper = -lower;
        const std::size_t first = static_cast<std::size_t>(task) * prisms_per_task;
        for (std::size_t p = first; p < std::min(count, first + prisms_per_task); ++p) {
            const glm::uvec3& triangle = shell.topology->triangles[p];
            const glm::uvec3& uvs = shell.topology->uv_triangles[p];
            std::array<Lanes, 6> corners;
            std::array<glm::vec2, 6> corner_uvs;
            for (int i = 0; i < 3; ++i) {
                corners[i] = ends[triangle[i]].base;
                corners[i + 3] = ends[triangle[i]].top;
                corner_uvs[i] = uvs_base[uvs[i]];
                corner_uvs[i + 3] = uvs_top[uvs[i]];
            }
            const PrismIndices& hull = hulls[rising_fins(corners)];
            for (int i = 0; i < 6; ++i) {
                lower = corners[i] < lower ? corners[i] : lower;
                upper = corners[i] > upper ? corners[i] : upper;
                corners[i][3] = corner_uvs[i].x;
                store(&shell.prisms[p][i], corners[i]);
            }
            store(&shell.prisms[p][6], Lanes{corner_uvs[0].y, corner_uvs[1].y, corner_uvs[2].y, corner_uvs[3].y});
            store(&shell.prisms[p][7], Lanes{corner_uvs[4].y, corner_uvs[5].y, 0.0f, 0.0f});
            for (std::size_t k = 0; k < hull.size(); k += 4) {
                const auto from = static_cast<std::uint32_t>(6 * p);
                store(&shell.indices[p][k], Indices{hull[k], hull[k + 1], hull[k + 2], hull[k + 3]} + from);
            }
        }
        bounds[static_cast<std::size_t>(task)] = {vector(lower), vector(upper)};
        order_stores();
    }, 0.0f);
    Bounds all;
    for (const Bounds& box : bounds) {
        all.lower = glm::min(all.lower, box.lower);
        all.upper = glm::max(all.upper, box.upper);
    }
    shell.lower = all.lower;
    shell.upper = all.upper;
}

}  // namespace mesoshell
