#include "map_terms.h"

#include <algorithm>
#include <cmath>

#include "half.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

constexpr float largest_byte = 127.0f;

// Makes a term of `bytes` whole numbers and puts their scale into the same term of `others`.
void to_bytes(float* bytes, std::size_t count, float* others, std::size_t other_count)
{
    float largest = 0.0f;
    for (std::size_t i = 0; i < count; ++i) {
        largest = std::max(largest, std::abs(bytes[i]));
    }
    if (largest == 0.0f) {
        return;
    }
    const float scale = largest_byte / largest;
    for (std::size_t i = 0; i < count; ++i) {
        bytes[i] = std::rint(bytes[i] * scale);
    }
    for (std::size_t i = 0; i < other_count; ++i) {
        others[i] /= scale;
    }
}

}  // namespace

void round_eigenmaps(Map& map)
{
    if (map.precision == Precision::half) {
        round_to_half(map.eigenmaps);
    }
}

void round_terms(Map& map)
{
    if (map.precision == Precision::byte) {
        const std::size_t terms = static_cast<std::size_t>(map.terms);
        const std::size_t weights = map.weights.size() / terms;
        const std::size_t eigenmaps = map.eigenmaps.size() / terms;
        for (std::size_t term = 0; term < terms; ++term) {
            float* const weight = map.weights.data() + term * weights;
            float* const eigenmap = map.eigenmaps.data() + term * eigenmaps;
            if (weights >= eigenmaps) {
                to_bytes(weight, weights, eigenmap, eigenmaps);
            } else {
                to_bytes(eigenmap, eigenmaps, weight, weights);
            }
        }
    }
    if (map.precision != Precision::single) {
        round_to_half(map.weights);
        round_to_half(map.eigenmaps);
    }
}

std::vector<float> exit_distances(const GdmResolution& resolution, float height)
{
    const int nz = resolution.nodes.z;
    std::vector<float> distances;
    for (int theta = 0; theta < resolution.ntheta; ++theta) {
        const auto vertical = static_cast<float>(gdm_direction(resolution, theta, 0).z);
        for (int z = 0; z < nz; ++z) {
            distances.push_back(slab_exit(height * static_cast<float>(z) / static_cast<float>(nz - 1), vertical, height));
        }
    }
    return distances;
}

std::vector<float> distance_basis(const Map& map, int eigen_azimuth)
{
    const std::size_t columns = static_cast<std::size_t>(map.resolution.ntheta) * map.resolution.nodes.z;
    std::vector<float> basis(columns * map.terms);
    const std::vector<float> exits =
        map.layout == Layout::share ? exit_distances(map.resolution, map.height) : std::vector<float>(columns, 1.0f);
    for (int term = 0; term < map.terms; ++term) {
        const float* from = map.eigenmaps.data() + (static_cast<std::size_t>(term) * map.eigen_azimuths() + eigen_azimuth) * columns;
        for (std::size_t column = 0; column < columns; ++column) {
            basis[term * columns + column] = from[column] * exits[column];
        }
    }
    return basis;
}

int default_terms(const GdmResolution& r, Layout layout, Precision precision)
{
    constexpr int paper_terms = 16;
    constexpr int most_layers = 2048;  // of a 3D texture, four terms a layer and one azimuth repeated
    const int columns = r.ntheta * r.nodes.z;
    if (layout != Layout::nodes) {
        return std::min(paper_terms, columns);
    }
    const auto bytes = [&](Layout of, int terms) { return term_bytes(r, {terms, 0.0f, precision, of}); };
    const double affordable = bytes(Layout::paper, paper_terms) / bytes(Layout::nodes, 1);
    const double drawable = 4.0 * (most_layers / (r.nphi + 1));
    const double most = std::min(static_cast<double>(r.nodes.x) * r.nodes.y, static_cast<double>(columns) * r.nphi);
    return static_cast<int>(std::max(1.0, std::min({affordable, drawable, most})));
}

double term_bytes(const GdmResolution& r, const CompressOptions& options)
{
    const double nodes = static_cast<double>(r.nodes.x) * r.nodes.y;
    const double columns = static_cast<double>(r.ntheta) * r.nodes.z;
    const bool by_nodes = options.layout == Layout::nodes;
    const double weights = by_nodes ? nodes : nodes * r.nphi;
    const double eigenmaps = by_nodes ? columns * r.nphi : columns;
    switch (options.precision) {
    case Precision::byte:
        return options.terms * (weights >= eigenmaps ? weights + 2.0 * eigenmaps : 2.0 * weights + eigenmaps);
    case Precision::half:
        return options.terms * 2.0 * (weights + eigenmaps);
    default:
        return options.terms * 4.0 * (weights + eigenmaps);
    }
}

}  // namespace mesoshell
