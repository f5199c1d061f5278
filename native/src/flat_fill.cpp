#include "flat_fill.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "plane_side.h"

namespace mesoshell {
namespace {

using Ring = std::vector<std::uint32_t>;

class Filler {
public:
    explicit Filler(std::span<const glm::i64vec2> points) : points_(points) {}

    std::vector<glm::uvec3> fill(std::span<const glm::uvec2> segments)
    {
        std::vector<Ring> outer;
        std::vector<Ring> holes;
        for (Ring& ring : rings_of(segments)) {
            (area(ring) >= 0 ? outer : holes).push_back(std::move(ring));
        }
        // From the right to the left, so that the nearest ring to the right is that of a hole's own region.
        std::sort(holes.begin(), holes.end(),
                  [&](const Ring& a, const Ring& b) { return before(rightmost(b), b, rightmost(a), a); });
        for (const Ring& hole : holes) {
            join(hole, outer);
        }
        for (const Ring& ring : outer) {
            cut_ears(ring);
        }
        return std::move(triangles_);
    }

private:
    const glm::i64vec2& at(std::uint32_t i) const { return points_[i]; }

    bool before(std::size_t i, const Ring& a, std::size_t k, const Ring& b) const
    {
        const glm::i64vec2& p = at(a[i]);
        const glm::i64vec2& q = at(b[k]);
        return std::pair(p.x, p.y) < std::pair(q.x, q.y);
    }

    std::size_t rightmost(const Ring& ring) const
    {
        std::size_t best = 0;
        for (std::size_t i = 1; i < ring.size(); ++i) {
            if (before(best, ring, i, ring)) {
                best = i;
            }
        }
        return best;
    }

    Wide area(const Ring& ring) const
    {
        Wide sum = 0;
        for (std::size_t i = 2; i < ring.size(); ++i) {
            sum += area_of(at(ring[0]), at(ring[i - 1]), at(ring[i]));
        }
        return sum;
    }

    // Whether direction c is met before d when turning clockwise from direction `back`.
    static bool sooner(const glm::i64vec2& back, const glm::i64vec2& c, const glm::i64vec2& d)
    {
        const glm::i64vec2 origin(0);
        const auto half = [&](const glm::i64vec2& v) {  // 0: within half a turn clockwise, 1: beyond
            const Wide side = area_of(origin, back, v);
            return side < 0 ? 0 : (side > 0 ? 2 : (v.x * back.x >= 0 && v.y * back.y >= 0 ? 3 : 1));
        };
        const int first = half(c);
        const int second = half(d);
        return first != second ? first < second : area_of(origin, c, d) < 0;
    }

    // Where several segments go on from a point, the one that keeps the region to the left in one piece.
    std::vector<Ring> rings_of(std::span<const glm::uvec2> segments)
    {
        std::vector<std::vector<std::uint32_t>> from(points_.size());
        for (const glm::uvec2& s : segments) {
            from[s.x].push_back(s.y);
        }
        std::vector<Ring> rings;
        for (std::uint32_t start = 0; start < points_.size(); ++start) {
            while (!from[start].empty()) {
                Ring ring{start};
                std::uint32_t here = std::exchange(from[start].back(), 0);
                from[start].pop_back();
                while (here != start && !from[here].empty()) {
                    std::vector<std::uint32_t>& choices = from[here];
                    std::size_t best = 0;
                    const glm::i64vec2 back = at(ring.back()) - at(here);
                    for (std::size_t i = 1; i < choices.size(); ++i) {
                        if (sooner(back, at(choices[i]) - at(here), at(choices[best]) - at(here))) {
                            best = i;
                        }
                    }
                    ring.push_back(here);
                    const std::uint32_t next = choices[best];
                    choices[best] = choices.back();
                    choices.pop_back();
                    here = next;
                }
                if (ring.size() > 2) {
                    rings.push_back(std::move(ring));
                }
            }
        }
        return rings;
    }

    // By a bridge from the hole's rightmost point to one that it sees on the ring to its right.
    void join(const Ring& hole, std::vector<Ring>& outer)
    {
        const std::size_t own = rightmost(hole);
        const glm::i64vec2 p = at(hole[own]);
        double nearest = std::numeric_limits<double>::infinity();
        Ring* ring = nullptr;
        std::size_t corner = 0;
        for (Ring& candidate : outer) {
            for (std::size_t i = 0; i < candidate.size(); ++i) {
                const glm::i64vec2& a = at(candidate[i]);
                const glm::i64vec2& b = at(candidate[(i + 1) % candidate.size()]);
                if (a.y > p.y || b.y < p.y || a.y == b.y) {  // only what rises has the region to its left
                    continue;
                }
                const double x = static_cast<double>(a.x - p.x) + static_cast<double>(b.x - a.x) *
                                 (static_cast<double>(p.y - a.y) / static_cast<double>(b.y - a.y));
                if (x >= 0.0 && x < nearest) {
                    nearest = x;
                    ring = &candidate;
                    corner = a.x > b.x ? i : (i + 1) % candidate.size();
                }
            }
        }
        if (ring == nullptr) {
            outer.push_back(hole);
            return;
        }
        // The edge's end may be hidden by corners within the triangle of the two points and the place that the ray meets:
        // then the one at the flattest angle is seen.
        const glm::i64vec2 meets(p.x + static_cast<std::int64_t>(nearest), p.y);
        const glm::i64vec2 end = at((*ring)[corner]);
        std::pair<double, std::int64_t> flattest(std::numeric_limits<double>::infinity(), 0);  // and nearest
        std::size_t seen = corner;
        for (std::size_t i = 0; i < ring->size(); ++i) {
            const glm::i64vec2& q = at((*ring)[i]);
            if (q.x < p.x || !within(end.y < p.y ? end : p, meets, end.y < p.y ? p : end, q)) {
                continue;
            }
            const double right = std::max(1e-300, static_cast<double>(q.x - p.x));
            const double slope = std::abs(static_cast<double>(q.y - p.y)) / right;
            const std::pair<double, std::int64_t> angle(slope, q.x - p.x);
            if (angle < flattest && opens_toward(*ring, i, p)) {
                flattest = angle;
                seen = i;
            }
        }
        Ring bridged;
        bridged.insert(bridged.end(), ring->begin(), ring->begin() + static_cast<std::ptrdiff_t>(seen) + 1);
        for (std::size_t i = 0; i <= hole.size(); ++i) {
            bridged.push_back(hole[(own + i) % hole.size()]);
        }
        bridged.insert(bridged.end(), ring->begin() + static_cast<std::ptrdiff_t>(seen), ring->end());
        ring->swap(bridged);
    }

    static bool within(const glm::i64vec2& a, const glm::i64vec2& b, const glm::i64vec2& c, const glm::i64vec2& q)
    {
        const Wide ab = area_of(a, b, q);
        const Wide bc = area_of(b, c, q);
        const Wide ca = area_of(c, a, q);
        return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
    }

    // Whether p lies in the region's angle at a corner of the ring, which passes through bridges' ends more than once.
    bool opens_toward(const Ring& ring, std::size_t i, const glm::i64vec2& p) const
    {
        const glm::i64vec2& here = at(ring[i]);
        const glm::i64vec2& last = at(ring[(i + ring.size() - 1) % ring.size()]);
        const glm::i64vec2& next = at(ring[(i + 1) % ring.size()]);
        const bool left_of_last = area_of(last, here, p) >= 0;
        const bool left_of_next = area_of(here, next, p) >= 0;
        return area_of(last, here, next) > 0 ? left_of_last && left_of_next : left_of_last || left_of_next;
    }

    void cut_ears(Ring ring)
    {
        std::size_t since_cut = 0;
        std::size_t i = 0;
        while (ring.size() > 3) {
            const std::size_t count = ring.size();
            i %= count;
            const std::uint32_t last = ring[(i + count - 1) % count];
            const std::uint32_t next = ring[(i + 1) % count];
            // After a round without an ear, rounding has made the ring cross itself: any corner will do then, flat ones
            // last.
            if (is_ear(ring, i) || since_cut > 2 * count ||
                (since_cut > count && area_of(at(last), at(ring[i]), at(next)) > 0)) {
                triangles_.emplace_back(last, ring[i], next);
                ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
                since_cut = 0;
                // Ears side by side would make a fan of slivers.
                i += 1;
            } else {
                since_cut += 1;
                i += 1;
            }
        }
        triangles_.emplace_back(ring[0], ring[1], ring[2]);
    }

    bool is_ear(const Ring& ring, std::size_t i) const
    {
        const std::size_t count = ring.size();
        const glm::i64vec2& a = at(ring[(i + count - 1) % count]);
        const glm::i64vec2& b = at(ring[i]);
        const glm::i64vec2& c = at(ring[(i + 1) % count]);
        if (area_of(a, b, c) <= 0) {
            return false;
        }
        for (std::size_t k = 0; k + 3 < count; ++k) {
            const glm::i64vec2& q = at(ring[(i + 2 + k) % count]);
            if (q != a && q != b && q != c && within(a, b, c, q)) {
                return false;
            }
        }
        return true;
    }

    std::span<const glm::i64vec2> points_;
    std::vector<glm::uvec3> triangles_;
};

}  // namespace

std::vector<glm::uvec3> fill_region(std::span<const glm::i64vec2> points, std::span<const glm::uvec2> segments)
{
    return Filler(points).fill(segments);
}

bool close_along_border(std::span<const glm::i64vec2> points, std::span<const std::uint32_t> corners, bool filled,
                        std::vector<glm::uvec2>& segments)
{
    const glm::i64vec2 lower = points[corners[0]];
    const glm::i64vec2 upper = points[corners[2]];
    // How far along the border, side by side.
    using Along = std::pair<int, std::int64_t>;
    const auto along = [&](const glm::i64vec2& p) -> Along {
        if (p.y == lower.y && p.x < upper.x) {
            return {0, p.x - lower.x};
        }
        if (p.x == upper.x && p.y < upper.y) {
            return {1, p.y - lower.y};
        }
        return p.y == upper.y && p.x > lower.x ? Along{2, upper.x - p.x} : Along{3, upper.y - p.y};
    };
    std::map<std::uint32_t, int> ends;
    for (const glm::uvec2& s : segments) {
        ends[s.x] -= 1;
        ends[s.y] += 1;
    }
    struct Stop {
        std::uint32_t point;
        int ends;
    };
    std::map<Along, Stop> stops;
    for (const std::uint32_t corner : corners) {
        stops[along(points[corner])] = {corner, 0};
    }
    int depth = 0;
    bool any = false;
    for (const auto& [point, count] : ends) {
        if (count == 0) {
            continue;
        }
        const glm::i64vec2& p = points[point];
        const bool on_border = p.x == lower.x || p.x == upper.x || p.y == lower.y || p.y == upper.y;
        if (!on_border || std::abs(count) != 1) {
            return false;
        }
        stops[along(p)] = {point, count};
        any = true;
    }
    if (any) {
        // Which state the walk begins in: what the first end or beginning says.
        for (const auto& [place, stop] : stops) {
            if (stop.ends != 0) {
                depth = stop.ends > 0 ? 0 : 1;
                break;
            }
        }
    } else {
        depth = filled ? 1 : 0;
    }
    for (auto here = stops.begin(); here != stops.end(); ++here) {
        depth += here->second.ends;
        if (depth < 0 || depth > 1) {
            return false;
        }
        if (depth == 1) {
            const auto next = std::next(here) == stops.end() ? stops.begin() : std::next(here);
            segments.emplace_back(here->second.point, next->second.point);
        }
    }
    return true;
}

}  // namespace mesoshell
