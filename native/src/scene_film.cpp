#include "scene_film.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace mesoshell {
namespace {

constexpr int window_steps = 1024;

std::uint32_t reversed_bits(std::uint32_t x)
{
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

// A bijection whose every bit depends on the lower ones (Laine and Karras 2011, with the constants of Burley 2020).
std::uint32_t scrambled_upward(std::uint32_t x, std::uint32_t seed)
{
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

// Burley 2020, "Practical hash-based Owen scrambling": every bit is turned over depending on those above it.
std::uint32_t owen_scrambled(std::uint32_t x, std::uint32_t seed)
{
    return reversed_bits(scrambled_upward(reversed_bits(x), seed));
}

// The second dimension of Sobol's sequence; the first is reversed_bits.
std::uint32_t sobol_second(std::uint32_t index)
{
    std::uint32_t sum = 0;
    for (std::uint32_t direction = 0x80000000u; index != 0; index >>= 1, direction ^= direction >> 1) {
        if ((index & 1u) != 0) {
            sum ^= direction;
        }
    }
    return sum;
}

// The four-term window over [-1/2, 1/2] (Harris 1978).
double blackman_harris(double x)
{
    const double turn = 2.0 * std::numbers::pi * (x + 0.5);
    return 0.35875 - 0.48829 * std::cos(turn) + 0.14128 * std::cos(2.0 * turn) - 0.01168 * std::cos(3.0 * turn);
}

}  // namespace

std::uint32_t mixed(std::uint32_t a, std::uint32_t b)
{
    // The finalizer of MurmurHash3 (Appleby), over both numbers in turn.
    std::uint32_t x = b * 0x9e3779b9u + 0x7f4a7c15u;
    for (const std::uint32_t number : {a, 0u}) {
        x ^= number;
        x ^= x >> 16;
        x *= 0x85ebca6bu;
        x ^= x >> 13;
        x *= 0xc2b2ae35u;
        x ^= x >> 16;
    }
    return x;
}

glm::dvec2 spread_point(std::uint32_t index, std::uint32_t seed)
{
    // In an order of its own for every seed, so that pairs of dimensions are not the same pairs everywhere.
    const std::uint32_t shuffled = owen_scrambled(index, mixed(seed, 0));
    const std::uint32_t x = owen_scrambled(reversed_bits(shuffled), mixed(seed, 1));
    const std::uint32_t y = owen_scrambled(sobol_second(shuffled), mixed(seed, 2));
    return {x * 0x1p-32, y * 0x1p-32};
}

FilmFilter::FilmFilter(float width) : width_(2.0 * width)
{
    if (width <= 0.0f) {
        return;
    }
    sums_.assign(window_steps + 1, 0.0);
    for (int i = 0; i < window_steps; ++i) {
        sums_[i + 1] = sums_[i] + blackman_harris((i + 0.5) / window_steps - 0.5);
    }
    const double whole = sums_.back();
    for (double& sum : sums_) {
        sum /= whole;
    }
}

double FilmFilter::along(double share) const
{
    if (sums_.empty()) {
        return share - 0.5;
    }
    const auto above =
        std::clamp<std::ptrdiff_t>(std::upper_bound(sums_.begin(), sums_.end(), share) - sums_.begin(), 1, window_steps);
    const double within = (share - sums_[above - 1]) / (sums_[above] - sums_[above - 1]);
    return width_ * ((static_cast<double>(above - 1) + within) / window_steps - 0.5);
}

glm::dvec2 FilmFilter::offset(const glm::dvec2& place) const
{
    return {along(place.x), along(place.y)};
}

}  // namespace mesoshell
