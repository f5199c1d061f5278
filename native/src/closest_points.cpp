#include <algorithm>
#include <cmath>
#include <string>

#include "closest_point.h"
#include "embree_scene.h"
#include "mesoshell/attributes.h"
#include "parallel.h"
#include "slab_clip.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

// Triangles with an area, each a piece of one of a mesh.
struct Pieces {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    std::vector<std::uint32_t> source;

    glm::dvec3 area_vector(const glm::uvec3& t) const
    {
        const glm::dvec3 a(positions[t.x]);
        return glm::cross(glm::dvec3(positions[t.y]) - a, glm::dvec3(positions[t.z]) - a);
    }
    void add(const glm::uvec3& t, std::size_t of)
    {
        if (area_vector(t) != glm::dvec3(0.0)) {
            triangles.push_back(t);
            source.push_back(static_cast<std::uint32_t>(of));
        }
    }
};

Pieces whole(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& triangles)
{
    Pieces pieces;
    pieces.positions = positions;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        pieces.add(triangles[i], i);
    }
    return pieces;
}

// The mesh as it was given, without what lies out of the slab: what nobody sees gives no color to what is seen. All of it
// where a sheet's thickness alone reaches into the slab.
Pieces input_within_slab(const Sample& sample)
{
    Pieces pieces;
    pieces.positions = sample.input_positions();
    for (std::size_t i = 0; i < sample.input_triangles().size(); ++i) {
        const glm::uvec3& t = sample.input_triangles()[i];
        const glm::vec3 heights(pieces.positions[t.x].z, pieces.positions[t.y].z, pieces.positions[t.z].z);
        if (glm::all(glm::greaterThanEqual(heights, glm::vec3(0.0f))) &&
            glm::all(glm::lessThanEqual(heights, glm::vec3(sample.height())))) {
            pieces.add(t, i);
            continue;
        }
        const std::vector<glm::vec3> polygon =
            part_in_slab({pieces.positions[t.x], pieces.positions[t.y], pieces.positions[t.z]}, sample.height());
        const auto first = static_cast<std::uint32_t>(pieces.positions.size());
        pieces.positions.insert(pieces.positions.end(), polygon.begin(), polygon.end());
        for (std::uint32_t corner = 2; corner < polygon.size(); ++corner) {
            pieces.add({first, first + corner - 1, first + corner}, i);
        }
    }
    return pieces.triangles.empty() ? whole(sample.input_positions(), sample.input_triangles()) : pieces;
}

// No point of the slab is farther away from a mesh that has something in every period.
float farthest_of(const Pieces& pieces, const Sample& sample)
{
    float height = sample.height();
    for (const glm::vec3& p : pieces.positions) {
        height = std::max(height, std::abs(p.z) + sample.height());
    }
    return 1.01f * std::sqrt(1.0f + sample.aspect() * sample.aspect() + height * height);
}

// A mesh and its copies, asked for what is nearest.
class Surface {
public:
    Surface(Pieces pieces, const Sample& sample)
        : pieces_(std::move(pieces)), farthest_(farthest_of(pieces_, sample)),
          scene_(pieces_.positions, pieces_.triangles, lattice_within(pieces_.positions, sample.aspect(), farthest_))
    {
    }

    NearestPoint nearest(const glm::vec3& point) const { return scene_.nearest(point, farthest_); }
    const Pieces& pieces() const { return pieces_; }

private:
    Pieces pieces_;
    float farthest_;
    TriangleScene scene_;
};

// Of the triangle that a piece is part of.
glm::vec2 weights_in_source(const Sample& sample, const Pieces& pieces, const NearestPoint& nearest)
{
    const glm::uvec3& piece = pieces.triangles[nearest.triangle];
    const glm::uvec3& source = sample.input_triangles()[pieces.source[nearest.triangle]];
    if (piece == source) {
        return nearest.weights;
    }
    const std::vector<glm::vec3>& p = pieces.positions;
    const glm::vec3 point = p[piece.x] + nearest.weights.x * (p[piece.y] - p[piece.x]) +
                            nearest.weights.y * (p[piece.z] - p[piece.x]);
    return closest_point(point, p[source.x], p[source.y], p[source.z]).weights;
}

}  // namespace

SurfacePoints closest_points(const Sample& sample, const glm::ivec3& nodes, Job& job)
{
    for (int axis = 0; axis < 3; ++axis) {
        if (nodes[axis] < 2 || nodes[axis] > 4096) {
            throw InvalidArgument("a resolution of the attributes is " + std::to_string(nodes[axis]) +
                                  "; give 2 to 4096 nodes");
        }
    }
    check_memory("the attributes", 64.0 * nodes.x * nodes.y * nodes.z, "lower their resolution");
    job.throw_if_cancelled();
    const Surface given(input_within_slab(sample), sample);
    job.throw_if_cancelled();
    const Surface repaired(whole(sample.slab_positions(), sample.slab_triangles()), sample);

    SurfacePoints points;
    points.nodes = nodes;
    const std::size_t count = static_cast<std::size_t>(nodes.x) * nodes.y * nodes.z;
    points.triangles.resize(count);
    points.weights.resize(count);
    points.outward.resize(count);
    job.stage(0.0f, 1.0f);
    parallel_for(job, nodes.z * nodes.y, [&](int row) {
        const float z = sample.height() * static_cast<float>(row / nodes.y) / (nodes.z - 1);
        const float y = sample.aspect() * static_cast<float>(row % nodes.y) / nodes.y;
        for (int x = 0; x < nodes.x; ++x) {
            const std::size_t i = static_cast<std::size_t>(row) * nodes.x + x;
            const glm::vec3 node(static_cast<float>(x) / nodes.x, y, z);
            const NearestPoint nearest = given.nearest(node);
            points.triangles[i] = given.pieces().source[nearest.triangle];
            points.weights[i] = weights_in_source(sample, given.pieces(), nearest);
            const Pieces& outside = repaired.pieces();
            points.outward[i] =
                glm::vec3(glm::normalize(outside.area_vector(outside.triangles[repaired.nearest(node).triangle])));
        }
    });
    return points;
}

}  // namespace mesoshell
