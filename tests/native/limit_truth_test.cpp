// Refined surfaces against OpenSubdiv's patch tables, another path to the same limit: every quad has the whole tile and UVs
// are linear, so that a corner's UV is its place on its face.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "check.h"
#include "limit_oracle.h"
#include "surface_builders.h"

namespace mesoshell {
namespace {

// Sums of some hundred products of coordinates of about 1.
constexpr float rounding = 64 * 0x1p-23f;

// Quads around a vertex, in the plane but for their random heights.
SurfaceMesh star(int quads)
{
    SurfaceMesh mesh;
    Random random(static_cast<std::uint32_t>(quads));
    const auto height = [&] { return random.uniform(-0.3, 0.3); };
    mesh.positions.emplace_back(0.0f, 0.0f, height());
    for (int i = 0; i < 2 * quads; ++i) {
        const double angle = std::numbers::pi * i / quads;
        const double radius = i % 2 == 0 ? 1.0 : 1.4;
        mesh.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height());
    }
    for (int i = 0; i < quads; ++i) {
        mesh.face_sizes.push_back(4);
        mesh.corners.insert(mesh.corners.end(), {0, 1 + 2 * i, 2 + 2 * i, 1 + (2 * i + 2) % (2 * quads)});
    }
    return mesh;
}

SurfaceMesh with_whole_tiles(SurfaceMesh mesh)
{
    mesh.normals.clear();
    mesh.uvs.clear();
    for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
        mesh.uvs.insert(mesh.uvs.end(), {{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, 1.0f}, {0.0f, 1.0f}});
    }
    return mesh;
}

std::vector<CreasedMesh> cages()
{
    std::vector<CreasedMesh> all;
    for (const SurfaceMesh& mesh : {cube(), star(3), star(5), star(7), flat_grid(3, 2, 1.0f, 1.0f),
        torus(1.0f, 0.4f, 5, 4, 1.0f, 1.0f)}) {
        all.emplace_back(with_whole_tiles(mesh));
        // The same with an infinitely sharp edge, and with a sharp corner.
        all.push_back(all.back());
        all.back().crease(all.back().corners[0], all.back().corners[1], 10.0f);
        all.push_back(all[all.size() - 2]);
        all.back().corner(all.back().corners[2], 10.0f);
    }
    return all;
}

bool ends_crease(const CreasedMesh& mesh, int face, const glm::vec2& place)
{
    const glm::vec2 corners[] = {{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, 1.0f}, {0.0f, 1.0f}};
    const std::int32_t* vertices = mesh.corners.data() + 4 * face;
    for (int i = 0; i < 4; ++i) {
        for (const glm::ivec2& edge : mesh.crease_edges) {
            if (place == corners[i] && (edge.x == vertices[i] || edge.y == vertices[i])) {
                return true;
            }
        }
    }
    return false;
}

// Refined corners agree with the oracle in position and, where the surface has one tangent plane, in normal.
void expect_limit(const CreasedMesh& mesh, Refinement refinement, float tolerance, float angle)
{
    refinement.uv_rule = UvRule::linear;
    const RefinedSurface surface = refined(mesh.surface(), refinement);
    const LimitOracle oracle(mesh.surface(), refinement);
    std::size_t first = 0;
    for (std::size_t face = 0; face < surface.face_sizes.size(); ++face) {
        for (std::int32_t i = 0; i < surface.face_sizes[face]; ++i, ++first) {
            const std::int32_t vertex = surface.corners[first];
            const glm::vec2 place = surface.uvs[surface.uv_corners[first]];
            const LimitOracle::Frame truth = oracle.at(surface.faces[face], place.x, place.y);
            // Where a crease ends, both the oracle's patches and this code's are fitted.
            const float near = ends_crease(mesh, surface.faces[face], place) ? std::max(tolerance, 2e-3f) : tolerance;
            ASSERT_LT(glm::length(surface.positions[vertex] - truth.position), near)
                << "face " << surface.faces[face] << " at " << place.x << ", " << place.y;
            ASSERT_NEAR(glm::length(surface.normals[vertex]), 1.0f, rounding);
            for (int axis = 0; axis < 2; ++axis) {
                const glm::vec3 tangent = surface.tangents[vertex][axis];
                ASSERT_LT(std::abs(glm::dot(tangent, surface.normals[vertex])), rounding * glm::length(tangent));
            }
            // A sharp vertex has a normal for each side; the one between is checked by closed forms.
            const glm::vec3 normal = glm::normalize(glm::cross(truth.along_u, truth.along_v));
            // Along a rounded corner's two edges the patch has one tangent, the boundary's.
            const float sides = glm::length(truth.along_u) * glm::length(truth.along_v);
            const bool has_normal = glm::length(glm::cross(truth.along_u, truth.along_v)) > 0.02f * sides;
            if (has_normal && mesh.crease_edges.empty() && mesh.corner_vertices.empty()) {
                ASSERT_LT(glm::length(surface.normals[vertex] - normal), angle)
                    << "level " << refinement.levels << ", boundary " << static_cast<int>(refinement.boundary)
                        << ", face " << surface.faces[face] << " at " << place.x << ", " << place.y;
            }
        }
    }
}

TEST(LimitTruth, UniformLevelsLieOnTheLimit)
{
    for (const CreasedMesh& mesh : cages()) {
        for (const int levels : {1, 2, 3}) {
            for (const Boundary boundary : {Boundary::edges_and_corners, Boundary::edges}) {
                Refinement refinement = to_level(levels);
                refinement.boundary = boundary;
                expect_limit(mesh, refinement, rounding, 1e-3f);
            }
        }
    }
}

TEST(LimitTruth, AdaptivePointsLieOnTheLimit)
{
    for (const CreasedMesh& mesh : cages()) {
        // Bfr fits patches around extraordinary points too, two levels deep by its own choice.
        expect_limit(mesh, to_length(0.2f), 2e-3f, 2e-2f);
    }
    expect_limit(with_whole_tiles(torus(1.0f, 0.4f, 5, 4, 1.0f, 1.0f)), to_length(0.2f), rounding, 1e-4f);
}

TEST(LimitTruth, SemiSharpCreasesLieOnTheLimit)
{
    for (const float sharpness : {0.5f, 1.0f, 2.5f, 4.0f}) {
        for (CreasedMesh mesh : {CreasedMesh(with_whole_tiles(cube())), CreasedMesh(with_whole_tiles(star(5)))}) {
            mesh.crease(mesh.corners[0], mesh.corners[1], sharpness);
            mesh.corner(mesh.corners[2], sharpness);
            for (const int levels : {1, 2, 3}) {
                expect_limit(mesh, to_level(levels), rounding, 1e-3f);
            }
            expect_limit(mesh, to_length(0.2f), 2e-3f, 2e-2f);
        }
    }
}

}  // namespace
}  // namespace mesoshell
