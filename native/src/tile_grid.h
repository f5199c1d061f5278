// Which triangles of the tile lie in a rectangle of texture space, in all copies of the tile.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "plane_side.h"
#include "realize_tile.h"

namespace mesoshell {

class TileGrid {
public:
    // About two triangles a cell, for a prism asks for all that its cells hold.
    explicit TileGrid(const Tile& tile)
        : cells_(static_cast<std::int64_t>(
              std::clamp(std::sqrt(static_cast<double>(tile.triangles.size()) / 2.0), 1.0, 512.0))),
          first_(static_cast<std::size_t>(cells_ * cells_) + 1, 0)
    {
        for (const auto& t : tile.triangles) {
            lower_.push_back(glm::min(t[0].uv, glm::min(t[1].uv, t[2].uv)));
            upper_.push_back(glm::max(t[0].uv, glm::max(t[1].uv, t[2].uv)));
        }
        for (std::uint32_t i = 0; i < lower_.size(); ++i) {
            for_each_cell(lower_[i], upper_[i], [&](std::size_t cell, const glm::i64vec2&) { first_[cell + 1] += 1; });
        }
        for (std::size_t i = 1; i < first_.size(); ++i) {
            first_[i] += first_[i - 1];
        }
        entries_.resize(first_.back());
        std::vector<std::uint32_t> filled(first_.begin(), first_.end() - 1);
        for (std::uint32_t i = 0; i < lower_.size(); ++i) {
            for_each_cell(lower_[i], upper_[i], [&](std::size_t cell, const glm::i64vec2& copy) {
                entries_[filled[cell]++] = {i, glm::ivec2(copy)};
            });
        }
    }

    // Calls visit(triangle, copy) once for every copy of a triangle whose bounds meet the rectangle.
    template <typename Visit>
    void visit_within(const glm::i64vec2& lower, const glm::i64vec2& upper, const Visit& visit) const
    {
        for_each_cell(lower, upper, [&](std::size_t cell, const glm::i64vec2& copy) {
            for (std::uint32_t e = first_[cell]; e < first_[cell + 1]; ++e) {
                const Entry& entry = entries_[e];
                // The entry's triangle reaches into this cell's copy of the tile from `entry.copy` tiles beside it.
                const glm::i64vec2 tiles = copy - glm::i64vec2(entry.copy);
                const glm::i64vec2 low = lower_[entry.triangle] + tiles * one_tile;
                const glm::i64vec2 high = upper_[entry.triangle] + tiles * one_tile;
                if (high.x < lower.x || low.x > upper.x || high.y < lower.y || low.y > upper.y) {
                    continue;
                }
                // Of the cells that both reach, the first one counts.
                if (cell_of(glm::max(low, lower)) == glm::i64vec2(cell % cells_, cell / cells_) + copy * cells_) {
                    visit(entry.triangle, glm::ivec2(tiles));
                }
            }
        });
    }

private:
    struct Entry {
        std::uint32_t triangle;
        glm::ivec2 copy;  // the copy of the tile that the cell lies in
    };

    glm::i64vec2 cell_of(const glm::i64vec2& p) const
    {
        const glm::i64vec2 tile = p >> glm::i64vec2(tile_bits);
        const glm::i64vec2 rest = p & (one_tile - 1);
        return tile * cells_ + ((rest * cells_) >> glm::i64vec2(tile_bits));
    }

    template <typename Visit>
    void for_each_cell(const glm::i64vec2& lower, const glm::i64vec2& upper, const Visit& visit) const
    {
        const glm::i64vec2 first = cell_of(lower);
        const glm::i64vec2 last = cell_of(upper);
        for (std::int64_t y = first.y; y <= last.y; ++y) {
            const std::int64_t copy_y = y >= 0 ? y / cells_ : -((-y + cells_ - 1) / cells_);
            for (std::int64_t x = first.x; x <= last.x; ++x) {
                const std::int64_t copy_x = x >= 0 ? x / cells_ : -((-x + cells_ - 1) / cells_);
                visit(static_cast<std::size_t>((y - copy_y * cells_) * cells_ + x - copy_x * cells_),
                      glm::i64vec2(copy_x, copy_y));
            }
        }
    }

    std::int64_t cells_;  // along each side of the tile
    std::vector<glm::i64vec2> lower_;
    std::vector<glm::i64vec2> upper_;
    std::vector<std::uint32_t> first_;  // of every cell: its first entry; and the end
    std::vector<Entry> entries_;
};

}  // namespace mesoshell
