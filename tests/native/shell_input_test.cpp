// What surfaces are refused, and that a refusal names what is wrong with them.
#include <cmath>
#include <limits>
#include <numbers>

#include "check.h"
#include "meshes.h"

namespace mesoshell {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

void expect_refused(const SurfaceMesh& mesh, std::initializer_list<const char*> words, int levels = 0)
{
    expect_refusal<InvalidArgument>([&] { mesh.shell(0.1f, levels); }, words);
}

TEST(ShellInput, NumbersThatAreNotFinite)
{
    for (const float bad : {nan, std::numeric_limits<float>::infinity()}) {
        SurfaceMesh mesh = flat_grid(2, 2, 1.0f, 1.0f);
        mesh.positions[4].y = bad;
        expect_refused(mesh, {"vertex 4", "not finite"});
        expect_refused(mesh, {"vertex 4", "not finite"}, 1);
        mesh = flat_grid(2, 2, 1.0f, 1.0f);
        mesh.uvs[7].x = bad;
        expect_refused(mesh, {"UV of corner 7", "not finite"});
        mesh = torus(1.0f, 0.4f, 4, 4, 1.0f, 1.0f);
        mesh.normals[2].z = bad;
        expect_refused(mesh, {"normal of vertex 2", "not finite"});
    }
}

TEST(ShellInput, IndexOutOfRange)
{
    for (const std::int32_t bad :
         {9, -1, std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()}) {
        SurfaceMesh mesh = flat_grid(2, 2, 1.0f, 1.0f);
        mesh.corners[5] = bad;
        expect_refused(mesh, {"corner 5", std::to_string(bad).c_str(), "9 vertices"});
    }
}

TEST(ShellInput, CountsThatDoNotFit)
{
    SurfaceMesh mesh = flat_grid(2, 2, 1.0f, 1.0f);
    mesh.face_sizes[1] = 3;
    expect_refused(mesh, {"15 corners", "16"});
    for (const std::int32_t bad : {2, 0, -4}) {
        mesh.face_sizes[1] = bad;
        expect_refused(mesh, {"face 1", "at least 3"});
    }
    mesh = torus(1.0f, 0.4f, 4, 4, 1.0f, 1.0f);
    mesh.normals.pop_back();
    expect_refused(mesh, {"15 normals", "16 vertices"});
}

TEST(ShellInput, NoFaces)
{
    SurfaceMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    expect_refused(mesh, {"no faces"});
    expect_refused(SurfaceMesh{}, {"no faces"}, 2);
}

TEST(ShellInput, NoUvs)
{
    SurfaceMesh mesh = flat_grid(2, 2, 1.0f, 1.0f);
    mesh.uvs.clear();
    expect_refused(mesh, {"0 UVs", "unwrap"});
    mesh.uvs.resize(15);
    expect_refused(mesh, {"15 UVs", "16 corners"});
}

TEST(ShellInput, ThicknessThatIsNotPositive)
{
    for (const float bad : {0.0f, -0.1f, nan, std::numeric_limits<float>::infinity()}) {
        expect_refusal<InvalidArgument>([&] { one_triangle().shell(bad); }, {"thickness", "positive"});
    }
}

TEST(ShellInput, LevelsOutOfRange)
{
    for (const int bad : {-1, 9, 1000}) {
        expect_refusal<InvalidArgument>([&] { cube().shell(0.1f, bad); }, {"levels", "0 to 8"});
    }
}

SurfaceMesh pentagon()
{
    SurfaceMesh mesh;
    for (int i = 0; i < 5; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 5;
        mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
        mesh.corners.push_back(i);
        mesh.uvs.emplace_back(mesh.positions.back());
    }
    mesh.face_sizes = {5};
    return mesh;
}

TEST(ShellInput, FaceOfFiveCorners)
{
    expect_refusal<Error>([] { pentagon().shell(0.1f); }, {"face 0", "5 corners", "levels"});
    EXPECT_EQ(pentagon().shell(0.1f, 1).prisms.size(), 10u);
}

TEST(ShellInput, LoopNeedsTriangles)
{
    expect_refusal<Error>([] { cube().shell(0.1f, 1, Scheme::loop); }, {"Loop", "triangles"});
    EXPECT_EQ(octahedron().shell(0.1f, 1, Scheme::loop).prisms.size(), 32u);
}

TEST(ShellInput, FacesOfZeroArea)
{
    SurfaceMesh mesh = one_triangle();
    mesh.normals.clear();
    mesh.face_sizes.push_back(3);
    mesh.corners.insert(mesh.corners.end(), {0, 0, 1});
    mesh.uvs.resize(6);
    EXPECT_EQ(mesh.shell(0.1f).prisms.size(), 1u);  // the other face is left
    mesh.positions[1] = mesh.positions[0];
    expect_refusal<Error>([&] { mesh.shell(0.1f); }, {"zero area"});
}

TEST(ShellInput, FoldedFacesHaveNoNormal)
{
    SurfaceMesh mesh = one_triangle();
    mesh.normals.clear();
    mesh.face_sizes.push_back(3);
    mesh.corners.insert(mesh.corners.end(), {2, 1, 0});
    mesh.uvs.resize(6);
    expect_refusal<Error>([&] { mesh.shell(0.1f); }, {"vertex", "no normal"});
}

TEST(ShellInput, GivenNormalOfZeroLength)
{
    SurfaceMesh mesh = one_triangle();
    mesh.normals[1] = glm::vec3(0.0f);
    expect_refusal<Error>([&] { mesh.shell(0.1f); }, {"vertex 1", "no normal"});
}

TEST(ShellInput, HugeCoordinatesGiveFinitePrismsOrAreRefused)
{
    SurfaceMesh mesh = flat_grid(2, 2, 1e25f, 1e25f);
    for (const int levels : {0, 1}) {
        try {
            for (const PrismTexels& prism : mesh.shell(0.1f, levels).prisms) {
                for (const glm::vec4& texel : prism) {
                    ASSERT_TRUE(std::isfinite(texel.x) && std::isfinite(texel.y) && std::isfinite(texel.z));
                }
            }
        } catch (const std::exception&) {
        }
    }
}

TEST(ShellInput, TooManyPrisms)
{
    const SurfaceMesh mesh = flat_grid(64, 64, 1.0f, 1.0f);
    // 2 * 64^2 prisms at level 0, four times as many a level: 2^23 at level 5, twice what is allowed.
    expect_refused(mesh, {"4194304 prisms", "fewer subdivision levels"}, 5);
    EXPECT_EQ(mesh.shell(0.1f, 2).prisms.size(), 2u * 64 * 64 * 16);
}

}  // namespace
}  // namespace mesoshell
