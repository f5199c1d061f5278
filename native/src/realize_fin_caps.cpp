// Caps where a solid was cut along a prism's open fins (realize_prism.h).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "flat_fill.h"
#include "realize_prism.h"

namespace mesoshell {

void PrismClip::cap_open_fins()
{
    for (int fin = 0; fin < 3; ++fin) {
        std::vector<Cut>& cuts = cuts_[fin];
        std::stable_sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.group < b.group; });
        for (std::size_t begin = 0, end = 0; begin < cuts.size(); begin = end) {
            for (end = begin + 1; end < cuts.size() && cuts[end].group == cuts[begin].group; ++end) {
            }
            cap_fin(fin, std::span<const Cut>(cuts).subspan(begin, end - begin));
        }
    }
}

// Seen from outside the prism, the fin is a square of the share along it and the height.
void PrismClip::cap_fin(int fin, std::span<const Cut> cuts)
{
    constexpr double square = 0x1p30;
    const int end = (fin + 1) % 3;
    std::map<std::pair<std::int64_t, std::int64_t>, std::uint32_t> index;
    std::vector<glm::i64vec2> points;
    std::vector<PrismPoint> places;
    const auto find_or_add = [&](const PrismPoint& p) {
        const glm::i64vec2 at(std::llround(p.weight[end] * square), std::llround(p.w * square));
        const auto [found, added] = index.try_emplace({at.x, at.y}, static_cast<std::uint32_t>(points.size()));
        if (added) {
            points.push_back(at);
            places.push_back(p);
        }
        return found->second;
    };
    const std::array<std::uint32_t, 4> corners{find_or_add(on_column(fin, 0.0)), find_or_add(on_column(end, 0.0)),
                                               find_or_add(on_column(end, 1.0)), find_or_add(on_column(fin, 1.0))};
    std::vector<glm::uvec2> segments;
    for (const Cut& cut : cuts) {
        const std::uint32_t from = find_or_add(cut.from);
        const std::uint32_t to = find_or_add(cut.to);
        if (from != to) {
            segments.emplace_back(to, from);
        }
    }
    if (!close_along_border(points, corners, false, segments)) {
        return;
    }
    // The cap shows what the tile has beside it.
    const Cut& beside = cuts.front();
    for (const glm::uvec3& t : fill_region(points, segments)) {
        triangles_.push_back({{places[t.x], places[t.y], places[t.z]}, beside.tile_triangle, beside.copy, true});
    }
}

}  // namespace mesoshell
