// Surfaces with creases and rules, for tests of refinement.
#pragma once

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "limit_surface.h"
#include "meshes.h"

namespace mesoshell {

// A surface with what sharpens it.
struct CreasedMesh : SurfaceMesh {
    std::vector<glm::ivec2> crease_edges;
    std::vector<float> crease_sharpness;
    std::vector<std::int32_t> corner_vertices;
    std::vector<float> corner_sharpness;

    CreasedMesh(const SurfaceMesh& mesh) : SurfaceMesh(mesh) {}

    void crease(std::int32_t a, std::int32_t b, float sharpness)
    {
        crease_edges.emplace_back(a, b);
        crease_sharpness.push_back(sharpness);
    }
    void corner(std::int32_t vertex, float sharpness)
    {
        corner_vertices.push_back(vertex);
        corner_sharpness.push_back(sharpness);
    }
    // Every edge of every face.
    void crease_all(float sharpness)
    {
        std::size_t first = 0;
        for (const std::int32_t size : face_sizes) {
            for (std::int32_t i = 0; i < size; ++i) {
                crease(corners[first + i], corners[first + (i + 1) % size], sharpness);
            }
            first += static_cast<std::size_t>(size);
        }
    }
    Surface surface() const
    {
        Surface all = SurfaceMesh::surface();
        all.crease_edges = crease_edges;
        all.crease_sharpness = crease_sharpness;
        all.corner_vertices = corner_vertices;
        all.corner_sharpness = corner_sharpness;
        return all;
    }
};

inline Refinement to_level(int levels, Scheme scheme = Scheme::catmark)
{
    Refinement refinement;
    refinement.levels = levels;
    refinement.scheme = scheme;
    return refinement;
}

inline Refinement to_length(float length, int levels = 0, Scheme scheme = Scheme::catmark)
{
    Refinement refinement = to_level(levels, scheme);
    refinement.edge_length = length;
    return refinement;
}

inline RefinedSurface refined(const Surface& surface, const Refinement& refinement, int threads = 0)
{
    Job job(threads);
    LimitSurface limit(surface, refinement, job);
    return {limit.take_topology(), limit.evaluate(surface.positions, surface.normals, job)};
}

inline Shell shell_of(const Surface& surface, const Refinement& refinement, int threads = 0)
{
    ShellOptions options;
    options.thickness = 0.1f;
    options.refinement = refinement;
    Job job(threads);
    return build_shell(surface, options, job);
}

// A cone of `sides` triangles from a tip to a ring, closed by one face of as many corners.
inline SurfaceMesh cone(int sides)
{
    SurfaceMesh mesh;
    for (int i = 0; i < sides; ++i) {
        const double angle = 2.0 * 3.14159265358979323846 * i / sides;
        mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
        mesh.corners.push_back(sides - 1 - i);
    }
    mesh.face_sizes.push_back(sides);
    mesh.positions.emplace_back(0.0f, 0.0f, 1.0f);
    for (int i = 0; i < sides; ++i) {
        mesh.face_sizes.push_back(3);
        mesh.corners.insert(mesh.corners.end(), {i, (i + 1) % sides, sides});
    }
    for (const std::int32_t corner : mesh.corners) {
        mesh.uvs.emplace_back(mesh.positions[static_cast<std::size_t>(corner)]);
    }
    return mesh;
}

// How often each directed edge is used by the faces of a refined surface.
inline std::map<std::pair<std::int32_t, std::int32_t>, int> directed_edges(const RefinedTopology& topology)
{
    std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
    std::size_t first = 0;
    for (const std::int32_t size : topology.face_sizes) {
        for (std::int32_t i = 0; i < size; ++i) {
            ++edges[{topology.corners[first + i], topology.corners[first + (i + 1) % size]}];
        }
        first += static_cast<std::size_t>(size);
    }
    return edges;
}

}  // namespace mesoshell
