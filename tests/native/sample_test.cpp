// What a tile may be, and that a refusal names what is wrong with it.
#include <cmath>
#include <limits>

#include "check.h"
#include "mesoshell/error.h"
#include "mesoshell/sample.h"
#include "meshes.h"

namespace mesoshell {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

const Mesh ball = sphere({0.5f, 0.5f, 0.3f}, 0.2f, 6, 8);

void expect_vertex_refused(float bad)
{
    for (int axis = 0; axis < 3; ++axis) {
        Mesh mesh = ball;
        mesh.positions[5][axis] = bad;
        expect_refusal<InvalidArgument>([&] { mesh.sample(0.6f); }, {"vertex 5", "not finite"});
    }
}

TEST(Sample, VertexThatIsNaN)
{
    expect_vertex_refused(nan);
}

TEST(Sample, VertexThatIsInfinite)
{
    expect_vertex_refused(infinity);
    expect_vertex_refused(-infinity);
}

TEST(Sample, IndexOutOfRange)
{
    Mesh mesh = ball;
    mesh.triangles[3].y = static_cast<std::uint32_t>(mesh.positions.size());
    expect_refusal<InvalidArgument>([&] { mesh.sample(0.6f); },
                                    {"triangle 3", std::to_string(mesh.positions.size()).c_str()});
    mesh.triangles[3].y = ~0u;
    expect_refusal<InvalidArgument>([&] { mesh.sample(0.6f); }, {"triangle 3", "4294967295"});
}

TEST(Sample, EmptyMesh)
{
    expect_refusal<InvalidArgument>([] { Mesh{}.sample(0.6f); }, {"empty"});
    expect_refusal<InvalidArgument>([] { Mesh{ball.positions, {}}.sample(0.6f); }, {"empty"});
    expect_refusal<InvalidArgument>([] { Mesh{{}, ball.triangles}.sample(0.6f); }, {"empty"});
}

TEST(Sample, HeightThatIsNotPositive)
{
    for (const float height : {0.0f, -0.0f, -0.5f, nan, infinity, -infinity}) {
        expect_refusal<InvalidArgument>([&] { ball.sample(height); }, {"height", "positive"});
    }
}

TEST(Sample, AspectThatIsNotPositive)
{
    for (const float aspect : {0.0f, -2.0f, nan, infinity}) {
        expect_refusal<InvalidArgument>([&] { ball.sample(0.6f, aspect); }, {"aspect", "positive"});
    }
}

TEST(Sample, MissingWallOfSheetsIsMissed)
{
    // Every corner of a sheet of one quad is the same point modulo the period; the wall that is missing is a hole all the same.
    for (const int quads : {1, 3}) {
        Mesh mesh = sawtooth(0.1f, 0.2f, 0.4f, 0.0f, 1.0f, quads, quads);
        EXPECT_TRUE(mesh.sample(0.6f).notices().empty());
        mesh.triangles.resize(mesh.triangles.size() - 2 * static_cast<std::size_t>(quads));
        const Sample sample = mesh.sample(0.6f);
        ASSERT_EQ(sample.notices().size(), 1u);
        EXPECT_NE(sample.notices()[0].find("where a wall was added."), std::string::npos) << sample.notices()[0];
        EXPECT_EQ(sample.triangles().size(), mesh.triangles.size() + 2 * static_cast<std::size_t>(quads));
        EXPECT_TRUE(sample.winds_outward());
    }
}

TEST(Sample, NothingInTheSlab)
{
    for (const float z : {-0.3f, 0.9f}) {
        const Mesh mesh = sphere({0.5f, 0.5f, z}, 0.2f, 6, 8);
        expect_refusal<InvalidArgument>([&] { mesh.sample(0.6f); }, {"no geometry", "height"});
    }
}

TEST(Sample, MeshCutAtTheBorderIsClosedModuloThePeriods)
{
    // Every triangle of a ball that crosses two borders, moved by periods of its own: no two share a vertex any more.
    const Mesh whole = snapped(sphere({0.0f, 0.0f, 0.3f}, 0.25f, 6, 8));
    Random random(1);
    Mesh mesh;
    for (const glm::uvec3& t : whole.triangles) {
        const glm::vec3 copy(random.below(3) - 1, 0.5f * static_cast<float>(random.below(3) - 1), 0.0f);
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (int i = 0; i < 3; ++i) {
            mesh.positions.push_back(whole.positions[t[i]] + copy);
        }
        mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
    const Sample sample = mesh.sample(0.6f, 0.5f);
    EXPECT_TRUE(sample.winds_outward());
    // Not with another period, for which the pieces do not fit.
    EXPECT_FALSE(mesh.sample(0.6f, 0.7f).notices().empty());
}

TEST(Sample, SheetsWithoutSideWallsAreClosedModuloThePeriods)
{
    EXPECT_TRUE(slab(0.1f, 0.4f, 0.75f).sample(0.6f, 0.75f).winds_outward());
    EXPECT_TRUE(slab(0.1f, 0.4f, 0.75f, 1, 1).sample(0.6f, 0.75f).winds_outward());
    EXPECT_FALSE(slab(0.1f, 0.4f, 0.75f).sample(0.6f, 0.8f).notices().empty());
}

TEST(Sample, ZeroAreaTrianglesDoNotOpenAMesh)
{
    Mesh mesh = ball;
    mesh.triangles.emplace_back(2u, 2u, 3u);
    mesh.triangles.emplace_back(4u, 4u, 4u);
    EXPECT_TRUE(mesh.sample(0.6f).winds_outward());
}

TEST(Sample, FacesAreTurnedUntilTheyAgree)
{
    EXPECT_TRUE(ball.sample(0.6f).winds_outward());
    EXPECT_TRUE(flipped(ball).sample(0.6f).winds_outward());
    Mesh mesh = ball;
    std::swap(mesh.triangles[9].x, mesh.triangles[9].y);
    EXPECT_TRUE(mesh.sample(0.6f).winds_outward());
}

TEST(Sample, NothingClippedInsideTheSlab)
{
    const Sample sample = ball.sample(0.6f);
    EXPECT_EQ(sample.clipped_triangles(), 0u);
    EXPECT_EQ(sample.slab_positions(), ball.positions);
    EXPECT_EQ(sample.slab_triangles(), ball.triangles);
}

TEST(Sample, ClippedTriangles)
{
    // Of a slab between -0.1 and 0.4 the lower sheet, 2 * 3 * 3 triangles, is dropped.
    const Sample sample = slab(-0.1f, 0.4f).sample(0.6f);
    EXPECT_EQ(sample.clipped_triangles(), 18u);
    EXPECT_EQ(sample.slab_triangles().size(), 18u);
    for (const glm::uvec3& t : sample.slab_triangles()) {
        EXPECT_EQ(sample.slab_positions()[t.x].z, 0.4f);
    }
}

TEST(Sample, ClippedAreaIsTheAreaOfTheZone)
{
    // Archimedes: the area of a sphere between two planes is 2 pi r times their distance. With steps of s, a band of
    // the inscribed mesh has cos(s/2)^2 sin(s/2)/(s/2) = 1 - 0.3 s^2 of its zone's area or somewhat more, and never all
    // of it; in the two bands that the planes cut, the part may differ from its share by an eighth of the relative
    // change of radius, 0.1 s^2 of the whole.
    const float r = 0.4f;
    const Sample sample = sphere({0.5f, 0.5f, 0.25f}, r, 64, 128).sample(0.5f);
    double area = 0.0;
    for (const glm::uvec3& t : sample.slab_triangles()) {
        const std::vector<glm::vec3>& p = sample.slab_positions();
        area += 0.5 * glm::length(glm::dvec3(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x])));
        for (int i = 0; i < 3; ++i) {
            EXPECT_GE(p[t[i]].z, 0.0f);
            EXPECT_LE(p[t[i]].z, 0.5f);
        }
    }
    const double exact = 2.0 * 3.14159265358979 * r * 0.5;
    const double step = 3.14159265358979 / 64;
    EXPECT_LT(area, exact);
    EXPECT_GT(area, exact * (1.0 - 0.5 * step * step));
}

}  // namespace
}  // namespace mesoshell
