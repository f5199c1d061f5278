// Surfaces that modelers make by accident: each gets a shell of finite numbers, or a sentence that names what is wrong.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "check.h"
#include "surface_builders.h"

namespace mesoshell {
namespace {

std::vector<Refinement> refinements()
{
    Refinement rounded = to_level(2);
    rounded.boundary = Boundary::edges;
    rounded.uv_rule = UvRule::smooth;
    return {to_level(0), to_level(1), rounded, to_level(2, Scheme::bilinear), to_level(1, Scheme::loop), to_length(0.3f),
        to_length(0.05f, 2)};
}

void expect_finite(const Shell& shell)
{
    ASSERT_GT(shell.prisms.size(), 0u);
    for (const PrismTexels& prism : shell.prisms) {
        for (const glm::vec4& texel : prism) {
            ASSERT_TRUE(std::isfinite(texel.x) && std::isfinite(texel.y) && std::isfinite(texel.z) &&
                        std::isfinite(texel.w));
        }
    }
    for (const glm::uvec3& triangle : shell.topology->triangles) {
        for (int i = 0; i < 3; ++i) {
            ASSERT_LT(triangle[i], shell.positions.size());
            ASSERT_NEAR(glm::length(shell.directors[triangle[i]]), 1.0f, 1e-5f);
        }
    }
}

// How many of the refinements were accepted; the others were refused with a sentence.
int accepted(const CreasedMesh& mesh)
{
    int count = 0;
    for (const Refinement& refinement : refinements()) {
        try {
            const Shell shell = shell_of(mesh.surface(), refinement);
            expect_finite(shell);
            expect_finite(update_shell(shell, {mesh.positions, mesh.normals, {}}));
            ++count;
        } catch (const std::exception& refusal) {
            const bool is_sentence = dynamic_cast<const Error*>(&refusal) != nullptr ||
                dynamic_cast<const InvalidArgument*>(&refusal) != nullptr;
            EXPECT_TRUE(is_sentence) << refusal.what();
        }
    }
    return count;
}

SurfaceMesh with_uvs(SurfaceMesh mesh)
{
    mesh.uvs.clear();
    for (const std::int32_t corner : mesh.corners) {
        mesh.uvs.emplace_back(mesh.positions[static_cast<std::size_t>(corner)]);
    }
    return mesh;
}

void add_face(SurfaceMesh& mesh, std::initializer_list<std::int32_t> corners)
{
    mesh.face_sizes.push_back(static_cast<std::int32_t>(corners.size()));
    mesh.corners.insert(mesh.corners.end(), corners);
}

TEST(NastySurface, ThreeFacesOnAnEdge)
{
    SurfaceMesh mesh = flat_grid(2, 1, 2.0f, 1.0f);  // vertices 1 and 4 are the edge in the middle
    mesh.positions.insert(mesh.positions.end(), {{1, 0, 1}, {1, 1, 1}});
    add_face(mesh, {1, 6, 7, 4});
    EXPECT_EQ(accepted(with_uvs(mesh)), 6);  // Loop needs triangles
}

TEST(NastySurface, TwoFansAtOneVertex)
{
    SurfaceMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 0, 0}, {-1, -1, 0.5f}, {0, -1, 0.5f}};
    add_face(mesh, {0, 1, 2, 3});
    add_face(mesh, {0, 4, 5, 6});
    EXPECT_EQ(accepted(with_uvs(mesh)), 6);
}

TEST(NastySurface, IsolatedVertices)
{
    SurfaceMesh mesh = cube();
    mesh.positions.insert(mesh.positions.begin(), glm::vec3(9.0f));
    mesh.positions.emplace_back(-9.0f);
    for (std::int32_t& corner : mesh.corners) {
        ++corner;
    }
    EXPECT_EQ(accepted(with_uvs(mesh)), 6);
    for (const Refinement& refinement : {to_level(0), to_level(2), to_length(0.3f)}) {
        const Shell shell = shell_of(with_uvs(mesh).surface(), refinement);
        EXPECT_LE(glm::length(shell.upper), 2.0f);  // they are no part of it
    }
}

TEST(NastySurface, FacesOfZeroArea)
{
    // A cube with an edge collapsed, and a triangle that is a line.
    SurfaceMesh mesh = cube();
    mesh.positions[7] = mesh.positions[6];
    // Bilinear refinement of level 2 has a vertex whose faces are all lines.
    EXPECT_EQ(accepted(mesh), 5);
    mesh.positions[3] = mesh.positions[1];
    add_face(mesh, {0, 1, 3});
    mesh = with_uvs(mesh);
    EXPECT_GE(accepted(mesh), 1);
}

TEST(NastySurface, FaceThatUsesAVertexTwice)
{
    SurfaceMesh mesh = cube();
    add_face(mesh, {0, 1, 0, 3});
    accepted(with_uvs(mesh));
    mesh = cube();
    add_face(mesh, {5, 5, 6});
    accepted(with_uvs(mesh));
}

TEST(NastySurface, TheSameFaceTwice)
{
    SurfaceMesh mesh = cube();
    add_face(mesh, {0, 2, 3, 1});
    EXPECT_GE(accepted(with_uvs(mesh)), 1);
    // And turned over: folded onto itself, without a normal at level 0.
    mesh = cube();
    add_face(mesh, {1, 3, 2, 0});
    accepted(with_uvs(mesh));
}

TEST(NastySurface, NeighborsThatWindOppositely)
{
    SurfaceMesh mesh = flat_grid(2, 1, 2.0f, 1.0f);
    std::swap(mesh.corners[5], mesh.corners[7]);
    accepted(with_uvs(mesh));
    mesh.positions[0].z = 0.5f;
    accepted(with_uvs(mesh));
}

TEST(NastySurface, UvsThatCollapse)
{
    SurfaceMesh mesh = torus(1.0f, 0.4f, 6, 5, 1.0f, 1.0f);
    mesh.uvs.assign(mesh.uvs.size(), glm::vec2(0.25f, 0.5f));
    EXPECT_EQ(accepted(mesh), 6);
    mesh = cube();
    for (glm::vec2& uv : mesh.uvs) {
        uv.y = 0.0f;
    }
    EXPECT_EQ(accepted(mesh), 6);
}

TEST(NastySurface, PolesOfManyFaces)
{
    for (const int sides : {3, 4, 40, 100}) {
        // Level 0 takes no n-gon beyond quads, Loop only triangles.
        EXPECT_EQ(accepted(cone(sides)), sides <= 3 ? 7 : sides == 4 ? 6 : 5) << sides;
    }
    expect_refusal<Error>([] { shell_of(cone(257).surface(), to_length(0.3f)); }, {"257", "256", "refine to a level"});
    expect_finite(shell_of(cone(3000).surface(), to_level(2)));
}

SurfaceMesh disk(int corners)
{
    SurfaceMesh mesh;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / corners;
        mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
        mesh.corners.push_back(i);
    }
    mesh.face_sizes = {corners};
    return with_uvs(mesh);
}

TEST(NastySurface, FacesOf65ThousandCorners)
{
    expect_refusal<Error>([] { shell_of(disk(65'000).surface(), to_level(0)); }, {"face 0", "65000 corners", "levels = 1"});
    const Shell shell = shell_of(disk(65'000).surface(), to_level(1));
    EXPECT_GT(shell.prisms.size(), 100'000u);  // some of 130,000 are so thin that they have no area in single precision
    expect_finite(shell);
    expect_refusal<Error>([] { shell_of(disk(70'000).surface(), to_level(1)); }, {"face 0", "70000 corners", "65534"});
    expect_refusal<Error>([] { shell_of(disk(65'000).surface(), to_length(0.1f)); }, {"face 0", "65000 corners", "256"});
    // Many triangles around a vertex.
    expect_finite(shell_of(cone(20'000).surface(), to_level(1)));
}

// Pages of two quads that are all bound at one edge, the z axis from 0 to 1.
SurfaceMesh book_of(int pages)
{
    SurfaceMesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 0, 1}};
    for (int page = 0; page < pages; ++page) {
        const double angle = 0.75 * std::numbers::pi * page / pages;
        const auto first = static_cast<std::int32_t>(mesh.positions.size());
        for (const double radius : {1.0, 2.0}) {
            mesh.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
            mesh.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 1.0);
        }
        add_face(mesh, {0, first, first + 1, 1});
        add_face(mesh, {first, first + 2, first + 3, first + 1});
    }
    return with_uvs(mesh);
}

TEST(NastySurface, BooksOfManyPages)
{
    for (const int pages : {3, 4, 5, 12, 60}) {
        const SurfaceMesh mesh = book_of(pages);
        for (const int levels : {1, 2, 3}) {
            for (const Scheme scheme : {Scheme::catmark, Scheme::bilinear}) {
                Refinement refinement = to_level(levels);
                refinement.scheme = scheme;
                const Shell shell = shell_of(mesh.surface(), refinement);
                expect_finite(shell);
                ASSERT_EQ(shell.prisms.size(), 4u * pages << (2 * levels));
                for (std::size_t p = 0; p < shell.prisms.size(); ++p) {
                    // A page stays in its plane, whatever the others do.
                    const double angle = 0.75 * std::numbers::pi * (shell.topology->faces[p] / 2) / pages;
                    for (int i = 0; i < 3; ++i) {
                        const glm::vec3 base(shell.prisms[p][i]);
                        ASSERT_NEAR(base.y * std::cos(angle) - base.x * std::sin(angle), 0.0, 1e-5) << pages;
                        ASSERT_GT(base.x * std::cos(angle) + base.y * std::sin(angle), -1e-5) << pages;
                    }
                }
            }
        }
    }
}

TEST(NastySurface, CreasesAndCornersOnAllOfThem)
{
    for (const float sharpness : {0.3f, 2.5f, 7.0f, 10.0f}) {
        SurfaceMesh book = flat_grid(2, 1, 2.0f, 1.0f);
        book.positions.insert(book.positions.end(), {{1, 0, 1}, {1, 1, 1}});
        add_face(book, {1, 6, 7, 4});
        for (CreasedMesh mesh : {CreasedMesh(cube()), CreasedMesh(with_uvs(book)), CreasedMesh(cone(40)),
            CreasedMesh(octahedron())}) {
            const int plain = accepted(mesh);
            const bool quads = std::all_of(mesh.face_sizes.begin(), mesh.face_sizes.end(), [](int size) { return size == 4;
                });
            mesh.crease_all(sharpness);
            mesh.corner(0, sharpness);
            // Around triangles so many creases are refused where refinement is adaptive.
            EXPECT_EQ(accepted(mesh), quads ? plain : plain - 2);
        }
    }
}

}  // namespace
}  // namespace mesoshell
