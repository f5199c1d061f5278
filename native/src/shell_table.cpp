#include "shell_table.h"

#include <algorithm>
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
            const std::array<std::uint32_t, 6> fin = (rising >> i & 1) != 0 ? std::array<std::uint32_t, 6>{i, j, j + 3, i, j + 3, i + 3}
                                                                            : std::array<std::uint32_t, 6>{i, j, i + 3, j, j + 3, i + 3};
            for (std::uint32_t k = 0; k < 6; ++k) {
                hull[6 + 6 * i + k] = fin[k];
            }
        }
    }
    return all;
}();

PrismIndices hull_indices(const PrismTexels& texels, std::uint32_t prism)
{
    const auto corner = [&](int i) { return glm::vec3(texels[i]); };
    std::uint32_t rising = 0;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const glm::vec3 outward = glm::cross(corner(j) - corner(i), corner(j + 3) - corner(i));
        rising |= (glm::dot(outward, corner(i + 3) - corner(i)) <= 0.0f ? 1u : 0u) << i;
    }
    PrismIndices hull = hulls[rising];
    for (std::uint32_t& index : hull) {
        index += 6 * prism;
    }
    return hull;
}

PrismTexels texels_of(const Shell& shell, std::size_t prism)
{
    const glm::uvec3& vertices = shell.topology->triangles[prism];
    const glm::uvec3& uvs = shell.topology->uv_triangles[prism];
    const std::vector<glm::vec2>& uvs_base = shell.topology->uvs;
    const std::vector<glm::vec2>& uvs_top = shell.top_uvs.empty() ? uvs_base : shell.top_uvs;
    PrismTexels texels{};
    for (int i = 0; i < 3; ++i) {
        const glm::vec2 low = uvs_base[uvs[i]];
        const glm::vec2 high = uvs_top[uvs[i]];
        texels[i] = glm::vec4(shell.base(vertices[i]), low.x);
        texels[i + 3] = glm::vec4(shell.top(vertices[i]), high.x);
        texels[6 + i / 4][i % 4] = low.y;
        texels[6 + (i + 3) / 4][(i + 3) % 4] = high.y;
    }
    return texels;
}

// Rows that this thread has stored are seen by others before what it does next.
void order_stores()
{
#ifdef __SSE2__
    _mm_sfence();
#endif
}

// Writes a row of a table that is larger than any cache and is not read again here: without first reading what was there, where the
// processor can. Rows and tables begin at multiples of 16 bytes.
template <typename Row>
void store(Row& place, const Row& row)
{
    static_assert(sizeof(Row) % 16 == 0);
#ifdef __SSE2__
    const auto* from = reinterpret_cast<const char*>(&row);
    auto* to = reinterpret_cast<char*>(&place);
    for (std::size_t i = 0; i < sizeof(Row); i += 16) {
        _mm_stream_si128(reinterpret_cast<__m128i*>(to + i), _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + i)));
    }
#else
    place = row;
#endif
}

}  // namespace

void make_table(Shell& shell, Job& job)
{
    const std::size_t count = shell.topology->triangles.size();
    const int tasks = static_cast<int>((count + prisms_per_task - 1) / prisms_per_task);
    shell.prisms = RecycledVector<PrismTexels>(count, RecycledAllocator<PrismTexels>(shell.rig ? shell.rig->pool : nullptr));
    shell.indices = RecycledVector<PrismIndices>(count, RecycledAllocator<PrismIndices>(shell.rig ? shell.rig->pool : nullptr));
    struct Bounds {
        glm::vec3 lower{std::numeric_limits<float>::max()};
        glm::vec3 upper{std::numeric_limits<float>::lowest()};
    };
    std::vector<Bounds> bounds(static_cast<std::size_t>(tasks));
    parallel_for(job, tasks, [&](int task) {
        Bounds& box = bounds[static_cast<std::size_t>(task)];
        const std::size_t first = static_cast<std::size_t>(task) * prisms_per_task;
        for (std::size_t p = first; p < std::min(count, first + prisms_per_task); ++p) {
            const PrismTexels texels = texels_of(shell, p);
            for (int corner = 0; corner < 6; ++corner) {
                box.lower = glm::min(box.lower, glm::vec3(texels[corner]));
                box.upper = glm::max(box.upper, glm::vec3(texels[corner]));
            }
            store(shell.prisms[p], texels);
            store(shell.indices[p], hull_indices(texels, static_cast<std::uint32_t>(p)));
        }
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
