#include "scene_film.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mesoshell {
namespace {

constexpr int quantile_count = 1024;
constexpr int window_steps = 16384;

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
    const std::uint32_t shuffled = reversed_bits(owen_scrambled(reversed_bits(index), mixed(seed, 0)));
    const std::uint32_t x = owen_scrambled(reversed_bits(shuffled), mixed(seed, 1));
    const std::uint32_t y = owen_scrambled(sobol_second(shuffled), mixed(seed, 2));
    return {x * 0x1p-32, y * 0x1p-32};
}

FilmFilter::FilmFilter(float width) : width_(width)
{
    if (width <= 0.0f) {
        return;
    }
    std::vector<double> sums(window_steps + 1, 0.0);
    for (int i = 0; i < window_steps; ++i) {
        sums[i + 1] = sums[i] + blackman_harris((i + 0.5) / window_steps - 0.5);
    }
    quantiles_.reserve(quantile_count + 1);
    for (int i = 0; i <= quantile_count; ++i) {
        const double share = sums.back() * i / quantile_count;
        const auto above = std::clamp<std::ptrdiff_t>(std::lower_bound(sums.begin(), sums.end(), share) - sums.begin(), 1, window_steps);
        const double within = (share - sums[above - 1]) / (sums[above] - sums[above - 1]);
        quantiles_.push_back((above - 1 + within) / window_steps - 0.5);
    }
}

double FilmFilter::along(double share) const
{
    if (quantiles_.empty()) {
        return share - 0.5;
    }
    const double place = share * quantile_count;
    const int low = std::min(static_cast<int>(place), quantile_count - 1);
    return width_ * glm::mix(quantiles_[low], quantiles_[low + 1], place - low);
}

glm::dvec2 FilmFilter::offset(const glm::dvec2& place) const
{
    return {along(place.x), along(place.y)};
}

}  // namespace mesoshell
