#include "loop_triangulation.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace mesoshell {
namespace {

constexpr std::size_t longest_loop = 128;  // that is triangulated at once
constexpr std::size_t chords_tried = 256;  // from so many corners
// Of the squared sides of a triangle beside its area: among equal areas, that of the plane, compact triangles win.
constexpr double slenderness = 1e-3;

using Triangle = std::array<std::uint32_t, 3>;

class Triangulator {
public:
    explicit Triangulator(std::span<const glm::dvec3> corners) : corners_(corners) {}

    void add(const std::vector<std::uint32_t>& loop)
    {
        if (loop.size() < 3) {
            return;
        }
        if (loop.size() > longest_loop) {
            const auto [first, last] = best_chord(loop);
            std::vector<std::uint32_t> within(loop.begin() + static_cast<std::ptrdiff_t>(first),
                                              loop.begin() + static_cast<std::ptrdiff_t>(last) + 1);
            std::vector<std::uint32_t> beyond(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(first) + 1);
            beyond.insert(beyond.end(), loop.begin() + static_cast<std::ptrdiff_t>(last), loop.end());
            add(within);
            add(beyond);
            return;
        }
        add_of_least_area(loop);
    }

    std::vector<Triangle> triangles;

private:
    // Cuts off at least a quarter of the loop.
    std::pair<std::size_t, std::size_t> best_chord(const std::vector<std::uint32_t>& loop) const
    {
        const std::size_t n = loop.size();
        std::vector<double> along(n + 1, 0.0);
        for (std::size_t i = 0; i < n; ++i) {
            along[i + 1] = along[i] + glm::length(corners_[loop[(i + 1) % n]] - corners_[loop[i]]);
        }
        std::pair<std::size_t, std::size_t> best{0, n / 2};
        double least = std::numeric_limits<double>::max();
        for (std::size_t i = 0; i < n; i += std::max<std::size_t>(1, n / chords_tried)) {
            for (std::size_t j = i + n / 4; j < n && j <= i + n - n / 4; ++j) {
                const double arc = along[j] - along[i];
                const double ratio =
                    glm::length(corners_[loop[j]] - corners_[loop[i]]) / std::max(std::min(arc, along[n] - arc), 1e-300);
                if (ratio < least) {
                    least = ratio;
                    best = {i, j};
                }
            }
        }
        return best;
    }

    double cost(std::uint32_t a, std::uint32_t b, std::uint32_t c) const
    {
        const glm::dvec3 ab = corners_[b] - corners_[a];
        const glm::dvec3 ac = corners_[c] - corners_[a];
        const glm::dvec3 bc = ac - ab;
        const double squares = glm::dot(ab, ab) + glm::dot(ac, ac) + glm::dot(bc, bc);
        return 0.5 * glm::length(glm::cross(ab, ac)) + slenderness * squares;
    }

    void add_of_least_area(const std::vector<std::uint32_t>& loop)
    {
        const std::size_t n = loop.size();
        std::vector<double> least(n * n, 0.0);  // of the part between corners i and j
        std::vector<std::uint32_t> apex(n * n, 0);
        for (std::size_t length = 2; length < n; ++length) {
            for (std::size_t i = 0; i + length < n; ++i) {
                const std::size_t j = i + length;
                double best = std::numeric_limits<double>::max();
                for (std::size_t k = i + 1; k < j; ++k) {
                    const double sum = least[i * n + k] + least[k * n + j] + cost(loop[i], loop[k], loop[j]);
                    if (sum < best) {
                        best = sum;
                        apex[i * n + j] = static_cast<std::uint32_t>(k);
                    }
                }
                least[i * n + j] = best;
            }
        }
        std::vector<std::pair<std::size_t, std::size_t>> parts{{0, n - 1}};
        while (!parts.empty()) {
            const auto [i, j] = parts.back();
            parts.pop_back();
            if (j - i < 2) {
                continue;
            }
            const std::size_t k = apex[i * n + j];
            triangles.push_back({loop[i], loop[k], loop[j]});
            parts.emplace_back(i, k);
            parts.emplace_back(k, j);
        }
    }

    std::span<const glm::dvec3> corners_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate_loop(std::span<const glm::dvec3> corners)
{
    std::vector<std::uint32_t> loop(corners.size());
    std::iota(loop.begin(), loop.end(), 0u);
    Triangulator triangulator(corners);
    triangulator.add(loop);
    return std::move(triangulator.triangles);
}

}  // namespace mesoshell
