// Where the samples of a pixel lie: low-discrepancy numbers and the film's filter.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

// Point `index` of a two-dimensional sequence in [0, 1)^2, well spread for every count and best for powers of two.
// Sequences of different seeds have nothing to do with one another.
glm::dvec2 spread_point(std::uint32_t index, std::uint32_t seed);

// One number from several, each of whose bits depends on all of theirs.
std::uint32_t mixed(std::uint32_t a, std::uint32_t b);

// Offsets from a pixel's center that are distributed as a filter's weights.
class FilmFilter {
public:
    // Of a Blackman-Harris window that ends `width` pixels from the center; 0: a box of one pixel.
    explicit FilmFilter(float width);

    // From numbers in [0, 1), pixels.
    glm::dvec2 offset(const glm::dvec2& place) const;

private:
    double along(double share) const;

    double width_;
    std::vector<double> sums_;  // shares of the window's area up to even places; empty: the box
};

}  // namespace mesoshell
