#include "facet_boxes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "parallel.h"

namespace mesoshell {
namespace {

constexpr int farthest = box_reaches.back();

// Numbers of full cells in boxes, of the tile and as much of its copies as a box reaches.
class Counts {
public:
    Counts(const std::vector<std::uint8_t>& full, const glm::ivec3& cells)
        : size_(cells.x + 2 * farthest + 1, cells.y + 2 * farthest + 1, cells.z + 1),
          sums_(static_cast<std::size_t>(size_.x) * size_.y * size_.z, 0)
    {
        const auto wrapped = [](int i, int count) { return (i % count + count) % count; };
        for (int z = 1; z < size_.z; ++z) {
            for (int y = 1; y < size_.y; ++y) {
                int row = 0;
                const std::size_t line =
                    (static_cast<std::size_t>(z - 1) * cells.y + wrapped(y - 1 - farthest, cells.y)) * cells.x;
                for (int x = 1; x < size_.x; ++x) {
                    row += full[line + wrapped(x - 1 - farthest, cells.x)];
                    sums_[index(x, y, z)] = row + at(x, y - 1, z) + at(x, y, z - 1) - at(x, y - 1, z - 1);
                }
            }
        }
    }

    // Of the cells first <= (x, y, z) < last.
    int within(const glm::ivec3& first, const glm::ivec3& last) const
    {
        const glm::ivec3 a(first.x + farthest, first.y + farthest, first.z);
        const glm::ivec3 b(last.x + farthest, last.y + farthest, last.z);
        return at(b.x, b.y, b.z) - at(a.x, b.y, b.z) - at(b.x, a.y, b.z) - at(b.x, b.y, a.z) + at(a.x, a.y, b.z) +
               at(a.x, b.y, a.z) + at(b.x, a.y, a.z) - at(a.x, a.y, a.z);
    }

private:
    std::size_t index(int x, int y, int z) const { return (static_cast<std::size_t>(z) * size_.y + y) * size_.x + x; }
    int at(int x, int y, int z) const { return sums_[index(x, y, z)]; }

    glm::ivec3 size_;
    std::vector<int> sums_;
};

// Directions of one octant, in cells: four azimuths at each of five elevations.
std::vector<glm::vec3> octant_directions()
{
    std::vector<glm::vec3> directions;
    for (const float azimuth : {10.0f, 32.0f, 58.0f, 80.0f}) {
        for (const float elevation : {10.0f, 20.0f, 30.0f, 45.0f, 65.0f}) {
            const float a = glm::radians(azimuth);
            const float e = glm::radians(elevation);
            directions.emplace_back(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
        }
    }
    return directions;
}

glm::u8vec3 best_box(const Counts& counts, const glm::ivec3& cell, const glm::ivec3& cells, int octant,
                     const std::vector<glm::vec3>& directions)
{
    const glm::ivec3 forward(octant & 1, octant >> 1 & 1, octant >> 2 & 1);
    const auto is_empty = [&](int x, int y, int z) {
        const glm::ivec3 reach(box_reaches[x], box_reaches[y], box_reaches[z]);
        glm::ivec3 first = cell - reach * (1 - forward);
        glm::ivec3 last = cell + 1 + reach * forward;
        first.z = std::max(first.z, 0);
        last.z = std::min(last.z, cells.z);
        return counts.within(first, last) == 0;
    };
    constexpr int codes = static_cast<int>(box_reaches.size());
    glm::u8vec3 best(0);
    float longest = -1.0f;
    for (int z = 0; z < codes && is_empty(0, 0, z); ++z) {
        const bool leaves = forward.z == 1 ? cell.z + box_reaches[z] >= cells.z - 1 : box_reaches[z] >= cell.z;
        const float depth = leaves ? 99.0f : static_cast<float>(box_reaches[z]) + 0.5f;
        // The longer along u, the shorter along v.
        int y = codes - 1;
        for (int x = 0; x < codes; ++x) {
            while (y >= 0 && !is_empty(x, y, z)) {
                --y;
            }
            if (y < 0) {
                break;
            }
            const glm::vec2 width(static_cast<float>(box_reaches[x]) + 0.5f, static_cast<float>(box_reaches[y]) + 0.5f);
            float length = 0.0f;
            for (const glm::vec3& dir : directions) {
                length += std::min(std::min(width.x / dir.x, width.y / dir.y), depth / dir.z);
            }
            if (length > longest) {
                longest = length;
                best = glm::u8vec3(x, y, z);
            }
        }
    }
    return best;
}

}  // namespace

std::vector<EmptyBoxes> empty_boxes(const std::vector<std::uint8_t>& full, const glm::ivec3& cells, Job& job)
{
    const Counts counts(full, cells);
    const std::vector<glm::vec3> directions = octant_directions();
    std::vector<EmptyBoxes> boxes(full.size());
    parallel_for(job, cells.z * cells.y, [&](int row) {
        for (int x = 0; x < cells.x; ++x) {
            const std::size_t index = static_cast<std::size_t>(row) * cells.x + x;
            for (int octant = 0; octant < 8 && full[index] == 0; ++octant) {
                boxes[index][octant] = best_box(counts, {x, row % cells.y, row / cells.y}, cells, octant, directions);
            }
        }
    });
    return boxes;
}

}  // namespace mesoshell
