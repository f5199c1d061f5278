#include "thickness.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace mesoshell {
namespace {

// Along one axis: two pixels and the share of the second.
struct Between {
    std::size_t first;
    std::size_t second;
    double share;
};

Between between(double coordinate, int count)
{
    const double pixels = (coordinate - std::floor(coordinate)) * count - 0.5;
    const double low = std::floor(pixels);
    const int first = (static_cast<int>(low) + count) % count;
    return {static_cast<std::size_t>(first), static_cast<std::size_t>((first + 1) % count), pixels - low};
}

double sampled(const FactorImage& image, const glm::vec2& uv)
{
    const Between x = between(uv.x, image.size.x);
    const Between y = between(uv.y, image.size.y);
    const auto row = [&](std::size_t j) {
        const float* values = image.values.data() + j * static_cast<std::size_t>(image.size.x);
        const double low = values[x.first];
        return low + (values[x.second] - low) * x.share;  // exact where both are one value
    };
    const double low = row(y.first);
    return low + (row(y.second) - low) * y.share;
}

}  // namespace

std::vector<float> image_thickness(float thickness, const FactorImage& image, std::size_t vertices,
                                   std::span<const std::int32_t> corners, std::span<const std::int32_t> uv_corners,
                                   std::span<const glm::vec2> uvs)
{
    if (image.values.empty()) {
        return std::vector<float>(vertices, thickness);
    }
    std::vector<double> sums(vertices, 0.0);
    std::vector<int> counts(vertices, 0);
    std::vector<bool> seen(uvs.size(), false);  // an entry of uvs belongs to one vertex
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const std::size_t entry = static_cast<std::size_t>(uv_corners[i]);
        if (!seen[entry]) {
            seen[entry] = true;
            sums[static_cast<std::size_t>(corners[i])] += sampled(image, uvs[entry]);
            counts[static_cast<std::size_t>(corners[i])] += 1;
        }
    }
    std::vector<float> result(vertices, 0.0f);
    for (std::size_t v = 0; v < vertices; ++v) {
        if (counts[v] == 0) {
            continue;  // no face has it
        }
        result[v] = thickness * static_cast<float>(sums[v] / counts[v]);
        if (!std::isfinite(result[v])) {
            throw Error("the thickness image takes the thickness of vertex " + std::to_string(v) +
                        " beyond all numbers; use a smaller thickness or darker pixels");
        }
    }
    return result;
}

void scale_thickness(std::vector<float>& thickness, std::span<const float> factors)
{
    for (std::size_t v = 0; v < thickness.size(); ++v) {
        thickness[v] *= std::clamp(factors[v], 0.0f, 1.0f);
    }
}

}  // namespace mesoshell
