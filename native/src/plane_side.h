// Sides of lines in the plane of tile coordinates, exact and never undecided.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace mesoshell {

__extension__ using Wide = __int128;

// Tile coordinates are whole multiples of 2^-24 tiles: finer than single precision between 0.5 and 1, and of as many whole
// tiles as a surface has.
constexpr int tile_bits = 24;
constexpr std::int64_t one_tile = std::int64_t(1) << tile_bits;

// Twice the area of the triangle a, b, c.
inline Wide area_of(const glm::i64vec2& a, const glm::i64vec2& b, const glm::i64vec2& c)
{
    const glm::i64vec2 ab = b - a;
    const glm::i64vec2 ac = c - a;
    return static_cast<Wide>(ab.x) * ac.y - static_cast<Wide>(ab.y) * ac.x;
}

// What decides where a point of the tile lies on a line of the shell: the tile stands moved by (e, e^2) for an e smaller
// than anything (Edelsbrunner and Mücke 1990, "Simulation of simplicity"), so that every question has one answer and all
// answers are those of one arrangement.
inline bool moved_left(const glm::i64vec2& along)
{
    return along.y != 0 ? along.y < 0 : along.x > 0;
}

// Whether a tile's point lies to the left of the shell's line a, b.
inline bool tile_left_of(const glm::i64vec2& a, const glm::i64vec2& b, const glm::i64vec2& tile)
{
    const Wide area = area_of(a, b, tile);
    return area != 0 ? area > 0 : moved_left(b - a);
}

// Whether a shell's point lies to the left of the tile's line a, b.
inline bool shell_left_of(const glm::i64vec2& a, const glm::i64vec2& b, const glm::i64vec2& shell)
{
    const Wide area = area_of(a, b, shell);
    return area != 0 ? area > 0 : !moved_left(b - a);
}

}  // namespace mesoshell
