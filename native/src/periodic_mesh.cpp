#include "periodic_mesh.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace mesoshell {
namespace {

// Buckets much larger than the distance asked for, so that nearly every vertex looks into its own bucket alone.
constexpr double bucket_size = 64.0 * weld_distance;
constexpr std::uint32_t none = ~0u;

// Places by bucket, modulo the periods.
class Places {
public:
    Places(const std::vector<glm::vec3>& positions, double aspect, double distance)
        : positions_(positions), distance_(distance), period_(1.0, aspect),
          buckets_(std::max(1.0, std::floor(1.0 / bucket_size)), std::max(1.0, std::floor(aspect / bucket_size))),
          size_(period_ / glm::dvec2(buckets_)), next_(positions.size(), none)
    {
        first_.reserve(positions.size());
    }

    // The first vertex at the place of this one, which is a new place if there is none.
    std::uint32_t find_or_add(std::uint32_t vertex)
    {
        const glm::dvec3 p = wrapped(vertex);
        const glm::i64vec3 low = bucket(p - distance_);
        const glm::i64vec3 high = bucket(p + distance_);
        for (std::int64_t z = low.z; z <= high.z; ++z) {
            for (std::int64_t y = low.y; y <= high.y; ++y) {
                for (std::int64_t x = low.x; x <= high.x; ++x) {
                    const auto found = first_.find(key({x, y, z}));
                    for (std::uint32_t i = found == first_.end() ? none : found->second; i != none; i = next_[i]) {
                        if (squared_distance(wrapped(i), p) < distance_ * distance_) {
                            return i;
                        }
                    }
                }
            }
        }
        const auto [head, added] = first_.try_emplace(key(bucket(p)), vertex);
        if (!added) {
            next_[vertex] = std::exchange(head->second, vertex);
        }
        return vertex;
    }

private:
    glm::dvec3 wrapped(std::uint32_t vertex) const
    {
        const glm::dvec3 p(positions_[vertex]);
        return {p.x - std::floor(p.x), p.y - std::floor(p.y / period_.y) * period_.y, p.z};
    }

    double squared_distance(const glm::dvec3& a, const glm::dvec3& b) const
    {
        glm::dvec3 offset = glm::abs(a - b);
        offset.x = std::min(offset.x, period_.x - offset.x);
        offset.y = std::min(offset.y, std::abs(period_.y - offset.y));
        return glm::dot(offset, offset);
    }

    glm::i64vec3 bucket(const glm::dvec3& p) const
    {
        return glm::i64vec3(glm::floor(glm::dvec3(p.x / size_.x, p.y / size_.y, p.z / bucket_size)));
    }

    std::uint64_t key(const glm::i64vec3& bucket) const
    {
        const auto x = static_cast<std::uint64_t>((bucket.x % buckets_.x + buckets_.x) % buckets_.x);
        const auto y = static_cast<std::uint64_t>((bucket.y % buckets_.y + buckets_.y) % buckets_.y);
        return x * 0x9E3779B97F4A7C15u ^ y * 0xC2B2AE3D27D4EB4Fu ^ static_cast<std::uint64_t>(bucket.z) * 0x165667B19E3779F9u;
    }

    const std::vector<glm::vec3>& positions_;
    double distance_;
    glm::dvec2 period_;
    glm::i64vec2 buckets_;
    glm::dvec2 size_;
    std::unordered_map<std::uint64_t, std::uint32_t> first_;
    std::vector<std::uint32_t> next_;
};

PeriodicMesh weld_within(double distance, std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles, float aspect)
{
    PeriodicMesh mesh;
    mesh.aspect = aspect;
    mesh.triangles = std::move(triangles);
    mesh.place.resize(positions.size());
    mesh.shift.resize(positions.size());
    Places places(positions, aspect, distance);
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        mesh.place[i] = places.find_or_add(i);
        const glm::dvec2 offset = glm::dvec2(positions[i]) - glm::dvec2(positions[mesh.place[i]]);
        mesh.shift[i] = glm::ivec2(std::lround(offset.x), std::lround(offset.y / aspect));
    }
    mesh.positions = std::move(positions);
    for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) {
        const glm::dvec3 there(mesh.positions[mesh.place[i]]);
        mesh.positions[i] = glm::vec3(there + glm::dvec3(mesh.shift[i].x, mesh.shift[i].y * static_cast<double>(aspect), 0.0));
    }
    return mesh;
}

}  // namespace

PeriodicMesh weld(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles, float aspect)
{
    return weld_within(weld_distance, std::move(positions), std::move(triangles), aspect);
}

std::size_t close_cracks(PeriodicMesh& mesh)
{
    std::vector<std::uint32_t> rim;  // places
    std::vector<std::uint32_t> index(mesh.positions.size(), none);
    double length = 0.0;
    double edges = 0.0;
    for_each_edge(sorted_sides(mesh), [&](std::span<const Side> sides) {
        if (balance(sides) == 0) {
            return;
        }
        for (const std::uint32_t place : {sides[0].low, sides[0].high}) {
            if (index[place] == none) {
                index[place] = static_cast<std::uint32_t>(rim.size());
                rim.push_back(place);
            }
        }
        const glm::uvec3& t = mesh.triangles[sides[0].triangle];
        length += glm::distance(mesh.positions[t[sides[0].corner]], mesh.positions[t[(sides[0].corner + 1) % 3]]);
        edges += 1.0;
    });
    if (rim.empty()) {
        return 0;
    }
    std::vector<glm::vec3> positions;
    for (const std::uint32_t place : rim) {
        positions.push_back(mesh.positions[place]);
    }
    const PeriodicMesh welded = weld_within(std::min(widest_crack, 0.25 * length / edges), std::move(positions), {}, mesh.aspect);
    std::size_t gone = 0;
    for (std::uint32_t i = 0; i < rim.size(); ++i) {
        gone += welded.place[i] != i ? 1 : 0;
    }
    for (std::uint32_t v = 0; gone > 0 && v < mesh.positions.size(); ++v) {
        if (const std::uint32_t i = index[mesh.place[v]]; i != none && welded.place[i] != i) {
            mesh.place[v] = rim[welded.place[i]];
            mesh.shift[v] += welded.shift[i];
            mesh.positions[v] = mesh.positions[mesh.place[v]] + mesh.period(mesh.shift[v]);
        }
    }
    return gone;
}

std::vector<Side> sorted_sides(const PeriodicMesh& mesh)
{
    std::vector<Side> sides;
    sides.reserve(mesh.triangles.size() * 3);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::uint8_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t from = mesh.triangles[t][corner];
            const std::uint32_t to = mesh.triangles[t][(corner + 1) % 3];
            const glm::ivec2 across = mesh.shift[to] - mesh.shift[from];
            Side there{mesh.place[from], mesh.place[to], across.x, across.y, t, corner, true};
            const Side back{mesh.place[to], mesh.place[from], -across.x, -across.y, t, corner, false};
            const auto ends = [](const Side& s) { return std::tie(s.low, s.high, s.across_x, s.across_y); };
            if (ends(there) != ends(back)) {  // else it has no length
                sides.push_back(ends(there) < ends(back) ? there : back);
            }
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.low, a.high, a.across_x, a.across_y, a.triangle, a.corner) <
               std::tie(b.low, b.high, b.across_x, b.across_y, b.triangle, b.corner);
    });
    return sides;
}

std::size_t count_open_edges(const PeriodicMesh& mesh)
{
    std::size_t open = 0;
    for_each_edge(sorted_sides(mesh), [&](std::span<const Side> sides) { open += balance(sides) != 0 ? 1 : 0; });
    return open;
}

}  // namespace mesoshell
