// Which solid a mesh bakes to when its faces are flipped, doubled, missing or in each other.
#include <algorithm>
#include <cmath>
#include <limits>

#include "check.h"
#include "mesoshell/bake.h"
#include "meshes.h"
#include "periodic_mesh.h"
#include "tile_space.h"
#include "winding_oracle.h"

namespace mesoshell {
namespace {

constexpr double rounding = 16 * 0x1p-23;

const Mesh ball = sphere({0.52f, 0.47f, 0.3f}, 0.2f, 12, 16);

std::vector<std::uint8_t> inside_of(const Sample& sample, const glm::ivec3& nodes)
{
    Job job;
    return classify_inside(sample, nodes, job);
}

glm::dvec3 node_place(const Sample& sample, const glm::ivec3& nodes, std::size_t i)
{
    const std::size_t x = i % nodes.x;
    const std::size_t y = i / nodes.x % nodes.y;
    const std::size_t z = i / nodes.x / nodes.y;
    return {double(x) / nodes.x, sample.aspect() * double(y) / nodes.y, sample.height() * double(z) / (nodes.z - 1)};
}

// Every node whose insideness is clear agrees with the oracle, and both answers occur.
void expect_oracle(const Sample& sample, const glm::ivec3& nodes, int copies, double unclear)
{
    const std::vector<std::uint8_t> inside = inside_of(sample, nodes);
    const PeriodicMesh& mesh = sample.winding_mesh();
    int in = 0;
    int out = 0;
    for (std::size_t i = 0; i < inside.size(); ++i) {
        const glm::dvec3 p = node_place(sample, nodes, i);
        const double winding = std::abs(brute_force_winding(mesh.positions, mesh.triangles, mesh.aspect, p, copies));
        if (std::abs(winding - 0.5) > unclear) {
            ASSERT_EQ(inside[i] != 0, winding >= 0.5) << p.x << " " << p.y << " " << p.z << " winding " << winding;
            (winding >= 0.5 ? in : out) += 1;
        }
    }
    EXPECT_GT(in, 0);
    EXPECT_GT(out, 0);
}

Mesh with_flips(Mesh mesh, int every, int phase)
{
    for (std::size_t i = static_cast<std::size_t>(phase); i < mesh.triangles.size(); i += static_cast<std::size_t>(every)) {
        std::swap(mesh.triangles[i].y, mesh.triangles[i].z);
    }
    return mesh;
}

Mesh box(const glm::vec3& low, const glm::vec3& high)
{
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.positions.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

void expect_same_inside(const Sample& a, const Sample& b)
{
    const glm::ivec3 nodes(13, 11, 9);
    EXPECT_EQ(inside_of(a, nodes), inside_of(b, nodes));
}

TEST(Solid, MatchesTheOracle)
{
    expect_oracle(ball.sample(0.6f), {13, 11, 9}, 3, 0.1);
    expect_oracle(merged(ball, sphere({0.1f, 0.2f, 0.1f}, 0.3f, 7, 9)).sample(0.6f, 0.8f), {13, 11, 9}, 3, 0.1);
    expect_oracle(sawtooth(0.1031f, 0.2217f, 0.5409f, 0.3f, 1.3f).sample(0.7f, 1.3f), {13, 11, 9}, 8, 0.1);
}

TEST(Solid, FlippedFacesAreTurnedBack)
{
    const Sample whole = ball.sample(0.6f);
    EXPECT_TRUE(whole.notices().empty());
    const Sample some = with_flips(ball, 3, 1).sample(0.6f);
    EXPECT_EQ(some.triangles(), whole.triangles());
    EXPECT_EQ(some.positions(), whole.positions());
    ASSERT_EQ(some.notices().size(), 1u);
    EXPECT_NE(some.notices()[0].find("faces were turned over"), std::string::npos);
    const Sample all = flipped(ball).sample(0.6f);
    EXPECT_TRUE(all.winds_outward());
    expect_same_inside(all, whole);
}

TEST(Solid, DuplicatesAreDropped)
{
    const Sample whole = ball.sample(0.6f);
    for (const bool turned : {false, true}) {
        Mesh doubled = merged(ball, turned ? flipped(ball) : ball);
        const Sample all = doubled.sample(0.6f);
        EXPECT_EQ(all.triangles(), whole.triangles());
        doubled.triangles.resize(ball.triangles.size() + 20);
        const Sample some = doubled.sample(0.6f);
        EXPECT_EQ(some.triangles(), whole.triangles());
        ASSERT_EQ(some.notices().size(), 1u);
        EXPECT_NE(some.notices()[0].find("20 duplicate faces"), std::string::npos) << some.notices()[0];
    }
    // A copy a period away is a duplicate too.
    EXPECT_EQ(merged(snapped(ball), moved(snapped(ball), {1.0f, 0.0f, 0.0f})).sample(0.6f).triangles().size(), ball.triangles.size());
}

TEST(Solid, WallBetweenTwoBoxesIsNoSurface)
{
    // Both have the wall, with opposite sides; the solid is one box.
    const Mesh left = box({0.1f, 0.2f, 0.1f}, {0.4f, 0.7f, 0.5f});
    const Mesh right = box({0.4f, 0.2f, 0.1f}, {0.8f, 0.7f, 0.5f});
    for (const Mesh& pair : {merged(left, right), merged(left, flipped(right))}) {
        const Sample sample = pair.sample(0.6f);
        EXPECT_EQ(sample.triangles().size(), 20u);
        EXPECT_TRUE(sample.winds_outward());
        expect_same_inside(sample, box({0.1f, 0.2f, 0.1f}, {0.8f, 0.7f, 0.5f}).sample(0.6f));
    }
}

TEST(Solid, HollowBall)
{
    const Mesh inner = sphere({0.52f, 0.47f, 0.3f}, 0.11f, 9, 12);
    const Mesh hollow = merged(ball, flipped(inner));
    const Sample sample = hollow.sample(0.6f);
    EXPECT_TRUE(sample.winds_outward());
    EXPECT_TRUE(sample.notices().empty());
    expect_oracle(sample, {17, 19, 13}, 3, 0.1);
    expect_same_inside(flipped(hollow).sample(0.6f), sample);
    expect_same_inside(with_flips(hollow, 3, 0).sample(0.6f), sample);
    // And what floats in the hollow is solid, even if inside out.
    const Mesh core = sphere({0.52f, 0.47f, 0.3f}, 0.06f, 9, 12);
    expect_same_inside(merged(hollow, flipped(core)).sample(0.6f), merged(hollow, core).sample(0.6f));
    const glm::ivec3 nodes(50, 100, 7);  // (26, 47, 3) is the center
    EXPECT_EQ(inside_of(merged(hollow, flipped(core)).sample(0.6f), nodes)[(3u * 100 + 47) * 50 + 26], 1);
    EXPECT_EQ(inside_of(sample, nodes)[(3u * 100 + 47) * 50 + 26], 0);
}

TEST(Solid, OverlappingBallsAreOneSolid)
{
    const Mesh other = sphere({0.65f, 0.5f, 0.35f}, 0.18f, 11, 13);
    const Sample sample = merged(ball, other).sample(0.6f);
    EXPECT_TRUE(sample.winds_outward());
    EXPECT_TRUE(sample.overlaps());
    EXPECT_FALSE(ball.sample(0.6f).overlaps());
    const glm::ivec3 nodes(23, 21, 13);
    const std::vector<std::uint8_t> both = inside_of(sample, nodes);
    const std::vector<std::uint8_t> first = inside_of(ball.sample(0.6f), nodes);
    const std::vector<std::uint8_t> second = inside_of(other.sample(0.6f), nodes);
    for (std::size_t i = 0; i < both.size(); ++i) {
        ASSERT_EQ(both[i], first[i] | second[i]);
    }
}

TEST(Solid, TerrainIsSolidBelow)
{
    // One sheet, flat at 0.3 and covering the tile: solid down to the bottom of the tile box, whatever its side.
    Mesh sheet = slab(0.3f, 0.9f, 0.7f);
    sheet.triangles.resize(18);
    for (const Mesh& mesh : {sheet, flipped(sheet)}) {
        const Sample sample = mesh.sample(0.6f, 0.7f);
        EXPECT_TRUE(sample.winds_outward());
        const glm::ivec3 nodes(4, 5, 8);
        const std::vector<std::uint8_t> inside = inside_of(sample, nodes);
        for (std::size_t i = 0; i < inside.size(); ++i) {
            ASSERT_EQ(inside[i] != 0, node_place(sample, nodes, i).z <= 0.3);
        }
    }
}

TEST(Solid, NodesOnTheSurfaceAreInside)
{
    // A slab from the bottom of the tile box to its top: nodes at 0 and at the height lie on its faces.
    const std::vector<std::uint8_t> inside = inside_of(slab(0.0f, 0.6f).sample(0.6f), {4, 4, 5});
    EXPECT_EQ(std::count(inside.begin(), inside.end(), 1), 4 * 4 * 5);
}

TEST(Solid, NodesOnSharedEdgesAndVertices)
{
    // Every column of nodes runs through vertices or along edges of the mesh: none may count a surface twice or not at all.
    const Sample sample = sawtooth(0.1f, 0.2f, 0.5f, 0.0f, 1.0f, 8, 8).sample(0.6f);
    const glm::ivec3 nodes(8, 8, 13);
    const std::vector<std::uint8_t> inside = inside_of(sample, nodes);
    for (std::size_t i = 0; i < inside.size(); ++i) {
        const glm::dvec3 p = node_place(sample, nodes, i);
        // At x = 0 the wall stands, and either side of it will do.
        if (p.x > 0.0 && std::abs(p.z - 0.1) > 1e-6 && std::abs(p.z - 0.2 - 0.3 * p.x) > 1e-6) {
            ASSERT_EQ(inside[i] != 0, p.z > 0.1 && p.z < 0.2 + 0.3 * p.x) << p.x << " " << p.y << " " << p.z;
        }
    }
}

Sample thick(const Mesh& mesh, float thickness, float height, float aspect = 1.0f)
{
    SampleOptions options;
    options.thickness = thickness;
    return Sample(mesh.positions, mesh.triangles, height, aspect, options);
}

TEST(Solid, SheetOfAThicknessIsASlab)
{
    Mesh sheet = slab(0.3f, 0.9f, 0.7f);
    sheet.triangles.resize(18);
    for (const Mesh& mesh : {sheet, with_flips(sheet, 3, 1)}) {
        const Sample sample = thick(mesh, 0.1f, 0.6f, 0.7f);
        EXPECT_TRUE(sample.winds_outward());
        Job job;
        const Sdf sdf = bake_sdf(sample, {5, 4, 15}, job);
        for (std::size_t i = 0; i < sdf.values.size(); ++i) {
            ASSERT_NEAR(sdf.values[i], std::abs(node_place(sample, sdf.nodes, i).z - 0.3f) - 0.05f, rounding);
        }
    }
}

TEST(Solid, OpenSheetOfAThicknessIsABox)
{
    // A square that ends within the tile, of thickness 0.08.
    Mesh mesh;
    mesh.positions = {{0.2f, 0.3f, 0.3f}, {0.7f, 0.3f, 0.3f}, {0.7f, 0.6f, 0.3f}, {0.2f, 0.6f, 0.3f}};
    mesh.triangles = {{0, 1, 2}, {0, 3, 2}};  // not of one side, either
    const Sample sample = thick(mesh, 0.08f, 0.6f);
    EXPECT_TRUE(sample.winds_outward());
    EXPECT_EQ(sample.triangles().size(), 12u);
    expect_same_inside(sample, box({0.2f, 0.3f, 0.26f}, {0.7f, 0.6f, 0.34f}).sample(0.6f));
    // A closed mesh does not mind.
    EXPECT_EQ(thick(ball, 0.1f, 0.6f).triangles(), ball.triangles);
}

TEST(Solid, ThreeSheetsThatMeetAtAnEdge)
{
    // Three half planes about the line x = 0.5, z = 0.3 at 120 degrees: an edge of three faces.
    Mesh mesh;
    mesh.positions = {{0.5f, 0.2f, 0.3f}, {0.5f, 0.8f, 0.3f}};
    for (std::uint32_t i = 0; i < 3; ++i) {
        const double angle = 2.0943951 * i + 0.3;
        const glm::vec3 out(0.2 * std::cos(angle), 0.0, 0.2 * std::sin(angle));
        mesh.positions.push_back(mesh.positions[0] + out);
        mesh.positions.push_back(mesh.positions[1] + out);
        mesh.triangles.insert(mesh.triangles.end(), {{0, 1, 2 * i + 3}, {0, 2 * i + 3, 2 * i + 2}});
    }
    const Sample sample = thick(mesh, 0.05f, 0.6f);
    EXPECT_TRUE(sample.winds_outward());
    const glm::ivec3 nodes(40, 10, 31);
    const std::vector<std::uint8_t> inside = inside_of(sample, nodes);
    int in = 0;
    for (std::size_t i = 0; i < inside.size(); ++i) {
        const glm::dvec3 p = node_place(sample, nodes, i);
        const double away = brute_force_distance(mesh.positions, mesh.triangles, 1.0f, p, 1);
        if (p.y > 0.25 && p.y < 0.75 && std::abs(away - 0.025) > 1e-4 && glm::length(glm::dvec2(p.x - 0.5, p.z - 0.3)) < 0.19) {
            // At the common edge each slab ends bluntly.
            if (glm::length(glm::dvec2(p.x - 0.5, p.z - 0.3)) > 0.03) {
                ASSERT_EQ(inside[i] != 0, away < 0.025) << p.x << " " << p.y << " " << p.z;
            }
            in += inside[i];
        }
    }
    EXPECT_GT(in, 50);
}

TEST(Solid, MoebiusStripOfAThickness)
{
    // A band with half a twist has one side only; cut somewhere, its slab closes all the same.
    constexpr std::uint32_t steps = 48;
    const auto strip = [](double half_width) {
        Mesh mesh;
        for (std::uint32_t i = 0; i < steps; ++i) {
            const double turn = 6.283185307179586 * i / steps;
            const glm::dvec3 out(std::cos(turn), std::sin(turn), 0.0);
            const glm::dvec3 across = out * std::cos(turn / 2) + glm::dvec3(0.0, 0.0, std::sin(turn / 2));
            for (const double side : {-half_width, half_width}) {
                mesh.positions.push_back(glm::vec3(glm::dvec3(0.5, 0.5, 0.3) + 0.28 * out + side * across));
            }
            const std::uint32_t a = 2 * i;
            const bool last = i + 1 == steps;
            const std::uint32_t c = last ? 1 : a + 2;
            const std::uint32_t d = last ? 0 : a + 3;
            mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, d}, {a, d, c}});
        }
        return mesh;
    };
    const Mesh mesh = strip(0.1);
    const Mesh within = strip(0.06);  // around this the slab does not end
    const Sample sample = thick(mesh, 0.06f, 0.6f);
    const glm::ivec3 nodes(20, 21, 13);
    const std::vector<std::uint8_t> inside = inside_of(sample, nodes);
    int in = 0;
    for (std::size_t i = 0; i < inside.size(); ++i) {
        const glm::dvec3 p = node_place(sample, nodes, i);
        if (brute_force_distance(within.positions, within.triangles, 1.0f, p, 0) < 0.025) {
            ASSERT_EQ(inside[i], 1) << p.x << " " << p.y << " " << p.z;
            in += 1;
        } else if (inside[i] != 0) {
            ASSERT_LT(brute_force_distance(mesh.positions, mesh.triangles, 1.0f, p, 0), 0.06) << p.x << " " << p.y << " " << p.z;
        }
    }
    EXPECT_GT(in, 50);
}

TEST(Solid, ThicknessThatCannotBe)
{
    for (const float thickness : {-0.1f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        expect_refusal<InvalidArgument>([&] { thick(ball, thickness, 0.6f); }, {"thickness", "zero or more"});
    }
}

TEST(Solid, TooFarAway)
{
    for (int axis = 0; axis < 3; ++axis) {
        for (const float far : {2e4f, -2e4f, 1e20f, -3e38f}) {
            Mesh mesh = ball;
            mesh.positions[3][axis] = far;
            expect_refusal<InvalidArgument>([&] { mesh.sample(0.6f); }, {"vertex 3", "periods away", "move the mesh"});
        }
    }
}

TEST(Solid, NoArea)
{
    Mesh mesh;
    mesh.positions = {{0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.2f}, {0.3f, 0.3f, 0.3f}};
    mesh.triangles = {{0, 0, 1}, {2, 2, 2}};
    expect_refusal<InvalidArgument>([&] { mesh.sample(0.6f); }, {"no area"});
}

}  // namespace
}  // namespace mesoshell
