#include "director_smoothing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "incidence.h"
#include "parallel.h"

namespace mesoshell {
namespace {

constexpr int vertices_per_task = 2048;
constexpr int halvings = 8;

// The least dot of a director with the unit normal of a triangle at its vertex: the cosine of 75 degrees.
constexpr double least_dot = 0.25881904510252074;

// One covered face as one of its corners sees it: its other vertices and how much they weigh.
struct Side {
    std::array<std::uint32_t, 3> others{0, 0, 0};
    std::array<float, 3> weights{0.0f, 0.0f, 0.0f};
};

// At `apex` between two sides; 0 for an obtuse angle, or for no angle at all.
double cotangent(const glm::dvec3& apex, const glm::dvec3& a, const glm::dvec3& b)
{
    const double across = glm::length(glm::cross(a - apex, b - apex));
    const double along = glm::dot(a - apex, b - apex);
    return along > 0.0 && across > 0.0 ? along / across : 0.0;
}

class Smoothing {
public:
    Smoothing(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, const FaceLists& faces)
        : positions_(positions), sides_(weigh(faces)), at_vertex_(std::span<const std::uint32_t>(owners_), positions.size()),
          triangles_at_(std::span<const std::uint32_t>(&triangles.data()->x, 3 * triangles.size()), positions.size())
    {
        normals_.reserve(triangles.size());
        for (const glm::uvec3& t : triangles) {
            const glm::dvec3 a(positions[t.x]);
            normals_.push_back(glm::normalize(glm::cross(glm::dvec3(positions[t.y]) - a, glm::dvec3(positions[t.z]) - a)));
        }
    }

    glm::vec3 step(std::size_t vertex, const std::vector<glm::vec3>& directors) const
    {
        glm::dvec3 sum(0.0);
        double weight = 0.0;
        for (const std::uint32_t i : at_vertex_.of(vertex)) {
            for (int k = 0; k < 3; ++k) {
                sum += glm::dvec3(directors[sides_[i].others[k]]) * double(sides_[i].weights[k]);
                weight += sides_[i].weights[k];
            }
        }
        const glm::dvec3 before(directors[vertex]);
        if (!(weight > 0.0) || triangles_at_.of(vertex).empty()) {
            return directors[vertex];
        }
        glm::dvec3 move = 0.5 * (sum / weight - before);
        for (int i = 0; i < halvings; ++i, move *= 0.5) {
            const glm::dvec3 after = before + move;
            const double size = glm::length(after);
            if (size > 0.0 && stays_before(vertex, before, after / size)) {
                return glm::vec3(after / size);
            }
        }
        return directors[vertex];
    }

private:
    std::vector<Side> weigh(const FaceLists& faces)
    {
        std::vector<Side> sides;
        std::size_t first = 0;
        for (std::size_t face = 0; face < faces.face_sizes.size(); ++face) {
            const std::size_t size = static_cast<std::size_t>(faces.face_sizes[face]);
            const auto corners = std::span(faces.corners).subspan(first, size);
            size == 3 ? weigh_triangle(corners, sides) : weigh_quad(corners, sides);
            first += size;
        }
        return sides;
    }

    void add(std::span<const std::int32_t> corners, const double (&weights)[4][4], std::vector<Side>& sides)
    {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            Side side;
            for (std::size_t k = 1; k < corners.size(); ++k) {
                const std::size_t j = (i + k) % corners.size();
                side.others[k - 1] = static_cast<std::uint32_t>(corners[j]);
                side.weights[k - 1] = static_cast<float>(weights[i][j]);
            }
            sides.push_back(side);
            owners_.push_back(static_cast<std::uint32_t>(corners[i]));
        }
    }

    // Adds a triangle's cotangents to the weights of its edges.
    void weigh_corners(std::span<const std::int32_t> corners, const std::array<std::size_t, 3>& t, double share,
                       double (&weights)[4][4]) const
    {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t a = t[(i + 1) % 3];
            const std::size_t b = t[(i + 2) % 3];
            const double value = share * cotangent(at(corners[t[i]]), at(corners[a]), at(corners[b]));
            weights[a][b] += value;
            weights[b][a] += value;
        }
    }

    void weigh_triangle(std::span<const std::int32_t> corners, std::vector<Side>& sides)
    {
        double weights[4][4] = {};
        weigh_corners(corners, {0, 1, 2}, 1.0, weights);
        add(corners, weights, sides);
    }

    void weigh_quad(std::span<const std::int32_t> corners, std::vector<Side>& sides)
    {
        double weights[4][4] = {};
        for (std::size_t i = 0; i < 4; ++i) {
            weigh_corners(corners, {i, (i + 1) % 4, (i + 2) % 4}, 0.5, weights);
        }
        add(corners, weights, sides);
    }

    glm::dvec3 at(std::int32_t vertex) const { return glm::dvec3(positions_[static_cast<std::size_t>(vertex)]); }

    bool stays_before(std::size_t vertex, const glm::dvec3& before, const glm::dvec3& after) const
    {
        for (const std::uint32_t corner : triangles_at_.of(vertex)) {
            const glm::dvec3& normal = normals_[corner / 3];
            if (glm::dot(after, normal) < std::min(least_dot, glm::dot(before, normal))) {
                return false;
            }
        }
        return true;
    }

    std::span<const glm::vec3> positions_;
    std::vector<std::uint32_t> owners_;  // of each side: the vertex that sees it
    std::vector<Side> sides_;
    Incidence at_vertex_;
    Incidence triangles_at_;  // corners of prisms
    std::vector<glm::dvec3> normals_;
};

}  // namespace

FaceLists covered_faces(const RefinedTopology& surface, std::span<const std::uint8_t> covered)
{
    FaceLists faces;
    std::size_t first = 0;
    for (std::size_t face = 0; face < surface.face_sizes.size(); ++face) {
        const std::int32_t size = surface.face_sizes[face];
        if (covered.empty() || covered[static_cast<std::size_t>(surface.faces[face])] != 0) {
            faces.face_sizes.push_back(size);
            const auto corners = surface.corners.begin() + static_cast<std::ptrdiff_t>(first);
            faces.corners.insert(faces.corners.end(), corners, corners + size);
        }
        first += static_cast<std::size_t>(size);
    }
    return faces;
}

void smooth_directors(std::vector<glm::vec3>& directors, std::span<const glm::vec3> positions,
                      std::span<const glm::uvec3> triangles, const FaceLists& faces, int steps, Job& job)
{
    if (steps == 0) {
        return;
    }
    const Smoothing smoothing(positions, triangles, faces);
    const int count = static_cast<int>(directors.size());
    std::vector<glm::vec3> next(directors.size());
    for (int step = 0; step < steps; ++step) {
        parallel_for(job, (count + vertices_per_task - 1) / vertices_per_task, [&](int task) {
            for (int v = task * vertices_per_task; v < std::min(count, (task + 1) * vertices_per_task); ++v) {
                next[static_cast<std::size_t>(v)] = smoothing.step(static_cast<std::size_t>(v), directors);
            }
        }, 0.0f);
        directors.swap(next);
    }
}

}  // namespace mesoshell
