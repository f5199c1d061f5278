// The realized mesh as one closed solid: every edge once each way, genus and volume as they must be, and what each corner
// says about where it comes from.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "check.h"
#include "mesoshell/realize.h"
#include "meshes.h"
#include "prism_truth.h"

namespace mesoshell {
namespace {

double volume_of(const RealizedMesh& mesh)
{
    double volume = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]);
        volume += glm::dot(a, glm::cross(glm::dvec3(mesh.positions[t.y]), glm::dvec3(mesh.positions[t.z]))) / 6.0;
    }
    return volume;
}

struct Edges {
    std::size_t count = 0;
    std::size_t open = 0;       // out of balance
    std::size_t irregular = 0;  // not once each way
};

Edges edges_of(const RealizedMesh& mesh)
{
    std::map<std::pair<std::uint32_t, std::uint32_t>, glm::ivec2> ways;
    for (const glm::uvec3& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t a = t[i];
            const std::uint32_t b = t[(i + 1) % 3];
            ways[{std::min(a, b), std::max(a, b)}][a < b ? 0 : 1] += 1;
        }
    }
    Edges edges;
    for (const auto& [edge, way] : ways) {
        edges.count += 1;
        edges.open += way.x != way.y ? 1 : 0;
        edges.irregular += way != glm::ivec2(1, 1) ? 1 : 0;
    }
    return edges;
}

int euler_characteristic(const RealizedMesh& mesh)
{
    return static_cast<int>(mesh.positions.size() + mesh.triangles.size()) - static_cast<int>(edges_of(mesh).count);
}

void expect_distinct(const std::vector<glm::vec3>& positions)
{
    std::vector<std::tuple<float, float, float>> sorted;
    for (const glm::vec3& p : positions) {
        sorted.emplace_back(p.x, p.y, p.z);
    }
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end());
}

// A ring that lies aslant in the tile and reaches over its borders.
Mesh ring(const glm::vec3& center, float major, float minor)
{
    const SurfaceMesh surface = torus(major, minor, 24, 12, 1.0f, 1.0f);
    Mesh mesh;
    for (const glm::vec3& p : surface.positions) {
        mesh.positions.emplace_back(center + glm::vec3(p.x, 0.8f * p.y - 0.6f * p.z, 0.6f * p.y + 0.8f * p.z));
    }
    for (std::size_t i = 0; i < surface.corners.size(); i += 4) {
        const glm::uvec4 q(surface.corners[i], surface.corners[i + 1], surface.corners[i + 2], surface.corners[i + 3]);
        mesh.triangles.emplace_back(q.x, q.y, q.z);
        mesh.triangles.emplace_back(q.x, q.z, q.w);
    }
    return mesh;
}

// Chain mail of one ring a tile: too large for its tile, each passes through its neighbors' holes.
Sample chain_sample()
{
    return ring({0.5f, 0.45f, 0.35f}, 0.42f, 0.05f).sample(0.7f);
}

const SurfaceMesh& donut()
{
    static const SurfaceMesh mesh = torus(1.0f, 0.4f, 24, 16, 6.0f, 3.0f);
    return mesh;
}

RealizedMesh realized(const Shell& shell, const Sample& sample, bool caps = true, float error = 1e-3f)
{
    RealizeOptions options;
    options.caps = caps;
    options.error = error;
    Job job;
    return realize(shell, sample, options, job);
}

// Between two heights: at one height all of a prism's sections are parallel, so that the volume is the integral of a
// quadratic, for which Simpson's rule is exact.
double volume_between(const Shell& shell, double low, double high)
{
    double sum = 0.0;
    for (const PrismTexels& texels : shell.prisms) {
        const PrismTruth prism(texels);
        glm::dvec3 rise(0.0);
        for (std::size_t i = 0; i < 3; ++i) {
            rise += (prism.column(i, 1.0) - prism.column(i, 0.0)) / 3.0;
        }
        const auto section = [&](double w) {
            const glm::dvec3 a = prism.column(0, w);
            return 0.5 * glm::dot(glm::cross(prism.column(1, w) - a, prism.column(2, w) - a), rise);
        };
        sum += (section(low) + 4.0 * section(0.5 * (low + high)) + section(high)) * (high - low) / 6.0;
    }
    return sum;
}

TEST(RealizeClosed, ChainOnATorusIsOneManifoldOfEighteenRings)
{
    const RealizedMesh mesh = realized(donut().shell(0.25f), chain_sample());
    EXPECT_EQ(edges_of(mesh).irregular, 0u);
    EXPECT_EQ(mesh.open_edges, 0u);
    expect_distinct(mesh.positions);
    EXPECT_EQ(euler_characteristic(mesh), 0);
    // Balls, two sides each.
    const RealizedMesh balls = realized(donut().shell(0.25f), sphere({0.97f, 0.02f, 0.3f}, 0.25f, 12, 16).sample(0.6f));
    EXPECT_EQ(edges_of(balls).irregular, 0u);
    EXPECT_EQ(euler_characteristic(balls), 2 * 18);
}

TEST(RealizeClosed, VolumeOfASheetIsTheIntegralOverThePrisms)
{
    const Shell shell = donut().shell(0.25f);
    const double exact = volume_between(shell, 0.25, 0.75);
    EXPECT_NEAR(volume_of(realized(shell, slab(0.1f, 0.3f).sample(0.4f))), exact, 1e-5 * exact);
    // Solid from below the slab to its middle, and from its middle on.
    const double lower = volume_between(shell, 0.0, 0.5);
    EXPECT_NEAR(volume_of(realized(shell, slab(-0.1f, 0.2f).sample(0.4f))), lower, 1e-5 * lower);
    const double upper = volume_between(shell, 0.5, 1.0);
    EXPECT_NEAR(volume_of(realized(shell, slab(0.2f, 0.5f).sample(0.4f))), upper, 1e-5 * upper);
}

TEST(RealizeClosed, VolumeConvergesWithTheSquareOfEdges)
{
    // Halving all edges of a ball of a few large faces quarters what they cut off. Its own facets are not part of that.
    const Shell shell = donut().shell(0.25f);
    const Sample sample = sphere({0.5f, 0.5f, 0.3f}, 0.28f, 4, 6).sample(0.6f);
    const double best = volume_of(realized(shell, sample, true, 3e-5f));
    const double coarse = std::abs(volume_of(realized(shell, sample, true, 1.6e-2f)) - best);
    const double fine = std::abs(volume_of(realized(shell, sample, true, 1e-3f)) - best);
    EXPECT_LT(fine, 0.25 * coarse);
    EXPECT_LT(fine, 1e-3 * best);
}

TEST(RealizeClosed, BallCutByTheSlabIsCapped)
{
    // Over a plane the cap at z = 0 adds nothing to the integral of z over the surface seen from above, which is the volume.
    const Sample sample = sphere({0.9f, 0.5f, 0.1f}, 0.3f, 12, 16).sample(0.5f);
    double volume = 0.0;
    for (const glm::uvec3& t : sample.slab_triangles()) {
        const glm::dvec3 a(sample.slab_positions()[t.x]);
        const glm::dvec3 b(sample.slab_positions()[t.y]);
        const glm::dvec3 c(sample.slab_positions()[t.z]);
        volume += 0.5 * glm::cross(b - a, c - a).z * (a.z + b.z + c.z) / 3.0;
    }
    const RealizedMesh mesh = realized(flat_grid(3, 2, 2.0f, 1.0f).shell(0.5f), sample);
    EXPECT_EQ(mesh.open_edges, 0u);
    EXPECT_NEAR(volume_of(mesh), 2.0 * volume, 1e-5);
    // On a torus, cut below and above, in the tile and across its borders.
    for (const glm::vec3& center : {glm::vec3(0.5f, 0.5f, 0.0f), glm::vec3(0.95f, 0.02f, 0.1f), glm::vec3(0.38f, 0.28f, 0.45f)}) {
        const Sample cut = merged(sphere(center, 0.2f, 8, 12), ring({0.5f, 0.5f, 0.2f}, 0.42f, 0.03f)).sample(0.4f);
        const RealizedMesh capped = realized(donut().shell(0.25f), cut);
        EXPECT_EQ(edges_of(capped).open, 0u);
        EXPECT_EQ(capped.open_edges, 0u);
        EXPECT_GT(realized(donut().shell(0.25f), cut, false).open_edges, 100u);
    }
}

TEST(RealizeClosed, SolidGroundIsCappedAcrossTheWholeTile)
{
    // Ground with a pit that reaches through the bottom, and a hollow ring of another part in it that goes through as well.
    const Mesh ground = slab(-0.2f, 0.25f);
    const Mesh pit = flipped(sphere({0.4f, 0.3f, 0.0f}, 0.15f, 8, 12));
    const Shell shell = donut().shell(0.25f);
    const RealizedMesh mesh = realized(shell, merged(ground, pit).sample(0.4f));
    EXPECT_EQ(mesh.open_edges, 0u);
    EXPECT_EQ(edges_of(mesh).open, 0u);
    const double whole = volume_between(shell, 0.0, 0.25 / 0.4);
    EXPECT_LT(volume_of(mesh), whole);
    EXPECT_GT(volume_of(mesh), 0.8 * whole);
}

TEST(RealizeClosed, BorderOfTheShellIsCapped)
{
    // A sheet over a rectangle is a box.
    const RealizedMesh box = realized(flat_grid(3, 2, 2.5f, 1.5f).shell(0.4f), slab(0.1f, 0.3f).sample(0.4f));
    EXPECT_EQ(edges_of(box).irregular, 0u);
    EXPECT_EQ(euler_characteristic(box), 2);
    EXPECT_NEAR(volume_of(box), 2.5 * 1.5 * 0.2, 1e-5);
    // The outline cuts balls through their middles, where they are alike on both sides.
    const Mesh ball = sphere({0.0f, 0.0f, 0.3f}, 0.25f, 12, 16);
    const RealizedMesh quarters = realized(flat_grid(2, 3, 1.0f, 1.0f).shell(0.6f), ball.sample(0.6f));
    EXPECT_EQ(quarters.open_edges, 0u);
    RealizedMesh whole;
    whole.positions = ball.positions;
    whole.triangles = ball.triangles;
    EXPECT_NEAR(volume_of(quarters), volume_of(whole), 1e-5);
    EXPECT_EQ(euler_characteristic(quarters), 2 * 4);
}

TEST(RealizeClosed, CutSeamsAreCappedOnBothSides)
{
    SurfaceMesh surface = donut();
    for (glm::vec2& uv : surface.uvs) {
        uv *= 0.93f;
    }
    const RealizedMesh mesh = realized(surface.shell(0.25f), chain_sample());
    EXPECT_EQ(mesh.open_edges, 0u);
    EXPECT_GT(realized(surface.shell(0.25f), chain_sample(), false).open_edges, 100u);
}

TEST(RealizeClosed, ShellThatThinsOutToNothingIsClosed)
{
    std::vector<float> factors;
    for (const glm::vec3& p : donut().positions) {
        factors.push_back(std::clamp(0.5f - p.y, 0.0f, 1.0f));
    }
    ShellOptions options;
    options.thickness = 0.25f;
    options.thickness_factors = factors;
    const Shell shell = build_shell(donut().surface(), options);
    const RealizedMesh mesh = realized(shell, chain_sample());
    EXPECT_EQ(mesh.open_edges, 0u);
    expect_distinct(mesh.positions);
    const double exact = volume_between(shell, 0.25, 0.75);
    EXPECT_NEAR(volume_of(realized(shell, slab(0.1f, 0.3f).sample(0.4f))), exact, 1e-5 * exact);
}

TEST(RealizeClosed, RelaxedTopIsClosedToo)
{
    ShellOptions options;
    options.thickness = 0.25f;
    options.relax_steps = 20;
    const Shell shell = build_shell(donut().surface(), options);
    ASSERT_FALSE(shell.top_uvs.empty());
    const RealizedMesh mesh = realized(shell, chain_sample());
    EXPECT_EQ(mesh.open_edges, 0u);
    EXPECT_EQ(euler_characteristic(mesh), 0);
    const double exact = volume_between(shell, 0.25, 0.75);
    EXPECT_NEAR(volume_of(realized(shell, slab(0.1f, 0.3f).sample(0.4f))), exact, 1e-5 * exact);
}

TEST(RealizeClosed, TileOnTheLatticeOfTheSurface)
{
    // Columns, fins and the sheet's vertices and edges lie in one another, everywhere.
    const RealizedMesh mesh = realized(torus(1.0f, 0.4f, 24, 12, 6.0f, 3.0f).shell(0.25f), slab(0.1f, 0.3f, 1.0f, 4, 4).sample(0.4f));
    EXPECT_EQ(edges_of(mesh).irregular, 0u);
    EXPECT_EQ(euler_characteristic(mesh), 0);
    expect_distinct(mesh.positions);
}

TEST(RealizeClosed, EveryCornerSaysWhereItComesFrom)
{
    const Sample sample = chain_sample();
    const Shell shell = donut().shell(0.25f);
    const RealizedMesh mesh = realized(shell, sample);
    ASSERT_EQ(mesh.texture.size(), 3 * mesh.triangles.size());
    ASSERT_EQ(mesh.weights.size(), 3 * mesh.triangles.size());
    ASSERT_EQ(mesh.source.size(), mesh.triangles.size());
    ASSERT_EQ(mesh.prism.size(), mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 7) {
        const PrismTexels& texels = shell.prisms[mesh.prism[i]];
        const glm::uvec3& source = sample.input_triangles()[mesh.source[i]];
        for (int k = 0; k < 3; ++k) {
            const std::size_t corner = 3 * i + static_cast<std::size_t>(k);
            const glm::dvec3 texture(mesh.texture[corner]);
            // The prism's map of the texture coordinates is the position: UVs solved for weights.
            const glm::dvec2 a = texture_at(texels, {0, 0, texture.z});
            const glm::dvec2 b = texture_at(texels, {1, 0, texture.z}) - a;
            const glm::dvec2 c = texture_at(texels, {0, 1, texture.z}) - a;
            const glm::dvec2 p = glm::dvec2(texture) - a;
            const double area = b.x * c.y - b.y * c.x;
            const glm::dvec3 q((p.x * c.y - p.y * c.x) / area, (b.x * p.y - b.y * p.x) / area, texture.z);
            ASSERT_LT(glm::length(PrismTruth(texels).position(q) - glm::dvec3(mesh.positions[mesh.triangles[i][k]])), 2e-6);
            // The point of the source triangle is that point of the tile.
            const glm::dvec2 weights(mesh.weights[corner]);
            const glm::dvec3 x(sample.input_positions()[source.x]);
            const glm::dvec3 y(sample.input_positions()[source.y]);
            const glm::dvec3 z(sample.input_positions()[source.z]);
            const glm::dvec3 point = x + (y - x) * weights.x + (z - x) * weights.y;
            const glm::dvec3 tile(texture.x, texture.y, texture.z * 0.7f);
            const glm::dvec3 apart = point - tile;
            // Splitting leaves the tile's triangles, in texture space, where they are.
            ASSERT_LT(glm::length(apart - glm::dvec3(std::round(apart.x), std::round(apart.y), 0.0)), 3e-6);
        }
    }
}

TEST(RealizeClosed, NormalsAreOneWhereTheTileIsSmooth)
{
    // On a torus of few prisms the map has a kink at every fin. Balls are smooth all over, and no cap is left of them.
    const glm::vec3 center(0.5f, 0.5f, 0.3f);
    const Mesh ball = sphere(center, 0.25f, 12, 16);
    std::vector<glm::vec3> normals;
    for (const glm::uvec3& t : ball.triangles) {
        for (int i = 0; i < 3; ++i) {
            normals.push_back(glm::normalize(ball.positions[t[i]] - center));
        }
    }
    RealizeOptions options;
    options.normals = normals;
    Job job;
    const RealizedMesh mesh = realize(donut().shell(0.25f), ball.sample(0.6f), options, job);
    std::vector<glm::vec3> at(mesh.positions.size(), glm::vec3(0.0f));
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        glm::vec3& one = at[mesh.triangles[i / 3][static_cast<int>(i % 3)]];
        if (one == glm::vec3(0.0f)) {
            one = mesh.normals[i];
        }
        ASSERT_GT(glm::dot(one, mesh.normals[i]), 1.0f - 1e-5f);
    }
    // Faces of 12 rings are up to 15 degrees across, and tiles are stretched by up to 2.
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::uvec3& t = mesh.triangles[i];
        const glm::dvec3 a(mesh.positions[t.x]);
        const glm::dvec3 face = glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a);
        if (glm::length(face) > 1e-7) {
            ASSERT_GT(glm::dot(glm::normalize(face), glm::dvec3(mesh.normals[3 * i])), std::cos(0.6));
        }
    }
}

TEST(RealizeClosed, ThreadsDoNotChangeAnything)
{
    const Shell shell = donut().shell(0.25f);
    const Sample sample = chain_sample();
    Job one(1);
    Job four(4);
    const RealizedMesh a = realize(shell, sample, one);
    const RealizedMesh b = realize(shell, sample, four);
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.weights, b.weights);
}

TEST(RealizeClosed, ErrorMustBePositive)
{
    for (const float error : {0.0f, -1.0f, std::nanf("")}) {
        expect_refusal<InvalidArgument>([&] { realized(donut().shell(0.25f), chain_sample(), true, error); }, {"error", "positive"});
    }
}

}  // namespace
}  // namespace mesoshell
