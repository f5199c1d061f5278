// The realized mesh: exact areas and volumes over flat surfaces, always inside the shell; and Embree's picture of a
// mesh.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "camera.h"
#include "check.h"
#include "mesoshell/realize.h"
#include "meshes.h"
#include "prism_truth.h"

namespace mesoshell {
namespace {

// Without caps, whose areas are not the tile's.
RealizeOptions open_options()
{
    RealizeOptions options;
    options.caps = false;
    return options;
}

RealizedMesh realize_on(const SurfaceMesh& surface, float thickness, const Sample& sample)
{
    Job job;
    return realize(surface.shell(thickness), sample, open_options(), job);
}

glm::dvec3 corner(const RealizedMesh& mesh, const glm::uvec3& t, int i)
{
    return glm::dvec3(mesh.positions[t[i]]);
}

double area_of(const RealizedMesh& mesh)
{
    double area = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a = corner(mesh, t, 0);
        area += 0.5 * glm::length(glm::cross(corner(mesh, t, 1) - a, corner(mesh, t, 2) - a));
    }
    return area;
}

// By the divergence theorem, of a closed mesh.
double volume_of(const RealizedMesh& mesh)
{
    double volume = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
        volume += glm::dot(corner(mesh, t, 0), glm::cross(corner(mesh, t, 1), corner(mesh, t, 2))) / 6.0;
    }
    return volume;
}

RealizedMesh as_realized(const Mesh& mesh)
{
    RealizedMesh realized;
    realized.positions = mesh.positions;
    realized.triangles = mesh.triangles;
    return realized;
}

// Sums of some thousand triangles with coordinates of about 1 in single precision, whose errors do not add up all one
// way.
constexpr double rounding = 1e-5;

TEST(Realize, SlabOnAFlatSurfaceHasTwiceItsArea)
{
    // Whatever the cuts by prisms and tiles: 3 x 2 quads of two triangles, 2.5 x 1.5 tiles.
    SurfaceMesh surface = flat_grid(3, 2, 2.5f, 1.5f);
    const RealizedMesh mesh = realize_on(surface, 0.4f, slab(0.1f, 0.3f).sample(0.4f));
    EXPECT_NEAR(area_of(mesh), 2.0 * 2.5 * 1.5, rounding);
    for (const glm::vec3& p : mesh.positions) {
        EXPECT_LT(std::min(std::abs(p.z - 0.1f), std::abs(p.z - 0.3f)), 4 * 0x1p-23f);
    }
}

TEST(Realize, BallsOnAFlatSurfaceKeepAreaAndVolume)
{
    // Two by three tiles, each half a unit wide: areas shrink by 4, volumes by 8. The ball crosses the tile's borders,
    // and prisms cut it; over whole periods nothing is lost.
    const Mesh ball = sphere({0.95f, 0.1f, 0.3f}, 0.25f, 12, 16);
    SurfaceMesh surface = flat_grid(3, 4, 1.0f, 1.5f);
    for (glm::vec2& uv : surface.uvs) {
        uv *= 2.0f;
    }
    const RealizedMesh mesh = realize_on(surface, 0.3f, ball.sample(0.6f));
    EXPECT_NEAR(area_of(mesh), 6 * area_of(as_realized(ball)) / 4, rounding);
    // Where the surface ends, those balls are cut open, and an open mesh has no volume: now balls that no outline cuts.
    const Mesh inner = sphere({0.5f, 0.5f, 0.3f}, 0.25f, 12, 16);
    const RealizedMesh whole = realize_on(surface, 0.3f, inner.sample(0.6f));
    EXPECT_NEAR(area_of(whole), 6 * area_of(as_realized(inner)) / 4, rounding);
    EXPECT_NEAR(volume_of(whole), 6 * volume_of(as_realized(inner)) / 8, rounding);
}

TEST(Realize, TileWithAnAspect)
{
    // The modeled rectangle 1 x 2 becomes the unit square of texture space; on a surface with tiles of 0.5 x 1 it has
    // its shape again at half its size.
    const Mesh ball = sphere({0.5f, 1.1f, 0.3f}, 0.25f, 12, 16);
    SurfaceMesh surface = flat_grid(2, 2, 1.0f, 2.0f);
    for (glm::vec2& uv : surface.uvs) {
        uv.x *= 2.0f;
    }
    const RealizedMesh mesh = realize_on(surface, 0.3f, ball.sample(0.6f, 2.0f));
    EXPECT_NEAR(area_of(mesh), 4 * area_of(as_realized(ball)) / 4, rounding);
    EXPECT_NEAR(volume_of(mesh), 4 * volume_of(as_realized(ball)) / 8, rounding);
}

TEST(Realize, ClippedSolidStaysInTheShell)
{
    const RealizedMesh mesh =
        realize_on(flat_grid(2, 2, 1.0f, 1.0f), 0.4f, sphere({0.5f, 0.5f, 0.1f}, 0.3f, 12, 16).sample(0.3f));
    ASSERT_FALSE(mesh.positions.empty());
    for (const glm::vec3& p : mesh.positions) {
        ASSERT_TRUE(p.x >= 0.0f && p.x <= 1.0f && p.y >= 0.0f && p.y <= 1.0f && p.z >= 0.0f && p.z <= 0.4f);
    }
}

TEST(Realize, EveryVertexLiesInAPrismOfTheShell)
{
    const Shell shell = torus(1.0f, 0.4f, 9, 7, 4.0f, 3.0f).shell(0.2f);
    std::vector<PrismTruth> prisms(shell.prisms.begin(), shell.prisms.end());
    Job job;
    const RealizedMesh mesh = realize(shell, sphere({0.2f, 0.8f, 0.2f}, 0.2f, 6, 8).sample(0.4f), job);
    ASSERT_GT(mesh.positions.size(), 1500u);
    for (std::size_t i = 0; i < mesh.positions.size(); i += 53) {
        const glm::dvec3 p(mesh.positions[i]);
        double deepest = -1.0;
        for (const PrismTruth& prism : prisms) {
            const glm::dvec3 middle = prism.position({1.0 / 3.0, 1.0 / 3.0, 0.5});
            if (glm::length(p - middle) < prism.reach(middle) + 1e-3) {
                deepest = std::max(deepest, prism.depth(p));
            }
        }
        // Positions of up to 1.6 are rounded to 2^-24; prisms are some tenths in size, with fins that meet at flat
        // angles.
        ASSERT_GE(deepest, -1e-5) << "vertex " << i;
    }
}

TEST(Realize, SlabInATorusHasTheAreaOfThePrismsThere)
{
    // At one height a prism is a triangle.
    const Shell shell = torus(1.0f, 0.4f, 9, 7, 4.0f, 3.0f).shell(0.2f);
    Job job;
    const RealizedMesh mesh = realize(shell, slab(0.1f, 0.3f).sample(0.4f), job);
    double exact = 0.0;
    for (const PrismTexels& texels : shell.prisms) {
        const PrismTruth prism(texels);
        for (const double w : {0.25, 0.75}) {
            const glm::dvec3 a = prism.column(0, w);
            exact += 0.5 * glm::length(glm::cross(prism.column(1, w) - a, prism.column(2, w) - a));
        }
    }
    EXPECT_NEAR(area_of(mesh), exact, rounding * exact);
}

TEST(Realize, BentTrianglesFollowTheBilinearMap)
{
    // A roof of one large quad a tile in one twisted prism, mapped back: it must still be flat in texture space. Edges are
    // off by the error asked for at most, which is in tile widths, 1 here, and a triangle's middle by no more than 4/3 of
    // that.
    SurfaceMesh surface = one_triangle();
    surface.normals = {{0.5f, 0.2f, 1.0f}, {-0.4f, 0.3f, 1.0f}, {-0.2f, -0.5f, 1.0f}};
    for (std::size_t i = 0; i < 3; ++i) {
        surface.uvs[i] = glm::vec2(surface.positions[static_cast<std::size_t>(surface.corners[i])]);
    }
    const float thickness = 0.4f;
    const Shell shell = surface.shell(thickness);
    const PrismTruth prism(shell.prisms[0]);
    const double low = 0.05f;
    const double slope = 0.25;
    RealizeOptions options = open_options();
    options.error = 2e-3f;
    Job job;
    const RealizedMesh mesh =
        realize(shell, sawtooth(0.02f, 0.05f, 0.3f, 0.0f, 1.0f, 1, 1).sample(thickness), options, job);
    double worst = 0.0;
    int on_roof = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a = corner(mesh, t, 0);
        const glm::dvec3 b = corner(mesh, t, 1);
        const glm::dvec3 c = corner(mesh, t, 2);
        const PrismTruth::Place place = prism.locate((a + b + c) / 3.0);
        ASSERT_GT(place.depth, -1e-3);
        const double u = place.q.x * surface.uvs[1].x + place.q.y * surface.uvs[2].x +
                         (1 - place.q.x - place.q.y) * surface.uvs[0].x;
        const double off_roof = std::abs(place.q.z * thickness - (low + slope * (u - std::floor(u))));
        const bool floor = std::abs(place.q.z * thickness - 0.02) < 1e-5;
        if (!floor && u > 0.02 && u < 0.98) {  // not the wall
            // The solid is about as steep, and as large in space, as in the tile: twice the bend in space is room
            // enough.
            ASSERT_LT(off_roof, 2.0 * 4.0 / 3.0 * options.error);
            worst = std::max(worst, off_roof);
            on_roof += 1;
        }
    }
    EXPECT_GT(on_roof, 50);
    EXPECT_GT(worst, 0.1 * options.error) << "split more than asked";
}

// A flat quad's shell whose top shows the pattern moved by `shift` tiles, in the prism table alone.
Shell slanted(const SurfaceMesh& surface, float thickness, const glm::vec2& shift)
{
    Shell shell = surface.shell(thickness);
    for (PrismTexels& prism : shell.prisms) {
        for (std::size_t i = 0; i < 3; ++i) {
            prism[i + 3].w += shift.x;
            prism[6 + (i + 3) / 4][static_cast<int>((i + 3) % 4)] += shift.y;
        }
    }
    return shell;
}

TEST(Realize, TopWithMovedUvsShearsTheSolid)
{
    // (u, v) = (x, y) + w * shift: the solid leans by -shift * w, its volume stays. Balls that no outline cuts, leaning or
    // not.
    const float thickness = 0.5f;
    const Sample sample = sphere({0.5f, 0.5f, 0.25f}, 0.2f, 12, 16).sample(thickness);
    const glm::vec2 shift(0.25f, -0.125f);
    const SurfaceMesh surface = flat_grid(2, 2, 2.0f, 2.0f);
    Job job;
    const RealizedMesh upright = realize(surface.shell(thickness), sample, job);
    const RealizedMesh leaning = realize(slanted(surface, thickness, shift), sample, job);
    EXPECT_NEAR(volume_of(leaning), volume_of(upright), rounding);
    for (const glm::vec3& p : leaning.positions) {
        // Back where it stood, every vertex lies on a ball: between the polyhedron's inner and outer radius.
        const glm::vec2 back = glm::vec2(p) + shift * (p.z / thickness);
        const glm::vec3 from(back.x - std::floor(back.x) - 0.5f, back.y - std::floor(back.y) - 0.5f, p.z - 0.25f);
        ASSERT_LT(glm::length(from), 0.2f + 1e-5f);
        ASSERT_GT(glm::length(from), 0.2f * std::cos(3.14159f / 12) * std::cos(3.14159f / 16) - 1e-5f);
    }
}

TEST(Realize, NormalsTurnAsPlanesDo)
{
    // Normals of a ball about its center, and a shell that stretches the tile by 2 in height and shears it: what is constant
    // along a plane of the tile has the gradient (f_u, f_v, f_w / 2 + the shear's share) in space.
    const glm::vec3 center(0.5f, 0.5f, 0.25f);
    const Mesh ball = sphere(center, 0.2f, 12, 16);
    std::vector<glm::vec3> normals;
    for (const glm::uvec3& t : ball.triangles) {
        for (int i = 0; i < 3; ++i) {
            normals.push_back(glm::normalize(ball.positions[t[i]] - center));
        }
    }
    RealizeOptions options;
    options.normals = normals;
    const glm::vec2 shift(0.25f, -0.125f);
    Job job;
    for (const bool mirrored : {false, true}) {
        SurfaceMesh surface = flat_grid(2, 2, 2.0f, 2.0f);
        for (glm::vec2& uv : surface.uvs) {
            uv.x = mirrored ? -uv.x : uv.x;
        }
        const RealizedMesh mesh = realize(slanted(surface, 1.0f, shift), ball.sample(0.5f), options, job);
        ASSERT_EQ(mesh.normals.size(), 3 * mesh.triangles.size());
        int smooth = 0;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const glm::dvec3 a = corner(mesh, mesh.triangles[i], 0);
            const glm::dvec3 face =
                glm::cross(corner(mesh, mesh.triangles[i], 1) - a, corner(mesh, mesh.triangles[i], 2) - a);
            for (int k = 0; k < 3; ++k) {
                const glm::dvec3 normal(mesh.normals[3 * i + static_cast<std::size_t>(k)]);
                ASSERT_NEAR(glm::length(normal), 1.0, 1e-5);
                const glm::dvec3 texture(mesh.texture[3 * i + static_cast<std::size_t>(k)]);
                const glm::dvec2 tile = glm::dvec2(texture) - glm::floor(glm::dvec2(texture));
                const glm::dvec3 f = glm::normalize(glm::dvec3(tile, texture.z * 0.5) - glm::dvec3(center));
                const double sheared = 0.5 * f.z + f.x * shift.x + f.y * shift.y;
                const glm::dvec3 expected = glm::normalize(glm::dvec3(mirrored ? -f.x : f.x, f.y, sheared));
                // Between a facet's corners the mean of unit normals is not quite the direction from the center.
                if (glm::length(face) > 1e-7) {
                    ASSERT_GT(glm::dot(normal, expected), 0.999) << i;
                    smooth += 1;
                }
            }
        }
        EXPECT_GT(smooth, 3000);
    }
    options.normals = std::span(normals).first(5);
    expect_refusal<InvalidArgument>([&] { realize(flat_grid(1, 1, 1, 1).shell(0.5f), ball.sample(0.5f), options, job); },
                                    {"5 normals", "three a triangle"});
}

TEST(Realize, TopWithLargerUvsTapersTheSolid)
{
    // UVs of the top are 1.5 times those of the base about the origin: a slab's sheet at height w keeps its area, for it
    // covers the prism whatever its UVs, and stays flat.
    Shell shell = flat_grid(2, 2, 1.0f, 1.0f).shell(0.4f);
    for (PrismTexels& prism : shell.prisms) {
        for (std::size_t i = 0; i < 3; ++i) {
            prism[i + 3].w *= 1.5f;
            prism[6 + (i + 3) / 4][static_cast<int>((i + 3) % 4)] *= 1.5f;
        }
    }
    Job job;
    const RealizedMesh sheets = realize(shell, slab(0.1f, 0.3f).sample(0.4f), open_options(), job);
    EXPECT_NEAR(area_of(sheets), 2.0, rounding);
    // A wall at u = 0.6, as high as the roof is, stands at x = 0.6 / (1 + w / 2) then: a vertex on it does.
    const RealizedMesh roof =
        realize(shell, sawtooth(0.02f, 0.05f, 0.35f, 0.6f, 1.0f, 4, 1).sample(0.4f), open_options(), job);
    int on_wall = 0;
    for (const glm::uvec3& t : roof.triangles) {
        const glm::dvec3 a = corner(roof, t, 0);
        const glm::dvec3 area = glm::cross(corner(roof, t, 1) - a, corner(roof, t, 2) - a);
        if (std::abs(area.x) > 0.9 * glm::length(area) && glm::length(area) > 1e-7) {  // slivers have no direction
            for (int i = 0; i < 3; ++i) {
                const glm::dvec3 p = corner(roof, t, i);
                const double u = p.x * (1.0 + 0.5 * p.z / 0.4f);
                ASSERT_NEAR(u - std::floor(u), 0.6, 2e-3);
            }
            on_wall += 1;
        }
    }
    EXPECT_GT(on_wall, 4);
}

TEST(Realize, UvsThatTurnOverAreRefused)
{
    Shell shell = flat_grid(1, 1, 1.0f, 1.0f).shell(0.4f);
    const Sample sample = slab(0.1f, 0.3f).sample(0.4f);
    std::swap(shell.prisms[1][3].w, shell.prisms[1][4].w);
    std::swap(shell.prisms[1][6].w, shell.prisms[1][7].x);
    Job job;
    expect_refusal<InvalidArgument>([&] { realize(shell, sample, job); }, {"prism 1", "turn over"});
}

TEST(Realize, PrismThatCoversNoTextureIsEmpty)
{
    SurfaceMesh surface = flat_grid(1, 1, 1.0f, 1.0f);
    std::fill(surface.uvs.begin(), surface.uvs.end(), glm::vec2(0.3f));
    EXPECT_TRUE(realize_on(surface, 0.4f, slab(0.1f, 0.3f).sample(0.4f)).positions.empty());
}

// --- Trace ---

TEST(Trace, TriangleInPerspectiveAndParallelViews)
{
    const std::vector<glm::vec3> positions{{-1, -1, 0}, {1, -1, 0.25f}, {0, 1, 0.5f}};
    const std::vector<glm::uvec3> triangles{{0, 1, 2}};
    const glm::dvec3 a(positions[0]);
    const glm::dvec3 normal = glm::normalize(glm::cross(glm::dvec3(positions[1]) - a, glm::dvec3(positions[2]) - a));
    for (const bool perspective : {true, false}) {
        const Camera camera(perspective, {0.4, -0.8, 2.5}, {0, 0, 0}, perspective ? 0.5 : 1.3, {40, 30});
        Job job;
        const Trace picture = trace(positions, triangles, camera.view(), job);
        int hits = 0;
        for (int y = 0; y < 30; ++y) {
            for (int x = 0; x < 40; ++x) {
                const CameraRay ray = camera.ray(x, y);
                const double t = glm::dot(a - ray.origin, normal) / glm::dot(ray.dir, normal);
                const glm::dvec3 p = ray.origin + ray.dir * t;
                double inside = std::numeric_limits<double>::infinity();
                for (std::size_t i = 0; i < 3; ++i) {
                    const glm::dvec3 from(positions[i]);
                    const glm::dvec3 edge = glm::normalize(glm::dvec3(positions[(i + 1) % 3]) - from);
                    inside = std::min(inside, glm::dot(normal, glm::cross(edge, p - from)));
                }
                const std::size_t pixel = static_cast<std::size_t>(y) * 40 + x;
                if (inside > 1e-5) {
                    hits += 1;
                    ASSERT_EQ(picture.hit[pixel], 1);
                    // A parallel view measures from the near plane.
                    ASSERT_NEAR(picture.distance[pixel], t, 1e-5);
                    ASSERT_LT(glm::length(glm::dvec3(picture.normal[pixel]) - normal), 1e-5);
                } else if (inside < -1e-5) {
                    ASSERT_EQ(picture.hit[pixel], 0);
                    ASSERT_TRUE(std::isinf(picture.distance[pixel]));
                    ASSERT_EQ(picture.normal[pixel], glm::vec3(0.0f));
                }
            }
        }
        EXPECT_GT(hits, 100);
    }
}

TEST(Trace, NothingBeforeTheNearPlane)
{
    const std::vector<glm::vec3> positions{{-9, -9, 1.98f}, {9, -9, 1.98f}, {0, 9, 1.98f},
                                           {-9, -9, 0},     {9, -9, 0},     {0, 9, 0}};
    Job job;
    const std::vector<glm::uvec3> triangles{{0, 1, 2}, {3, 4, 5}};
    for (const bool perspective : {true, false}) {
        // The near plane is 0.05 before the eye at z = 2.
        const Camera camera(perspective, {0, 0, 2}, {0, 0, 0}, 0.01, {3, 3});
        const Trace picture = trace(positions, triangles, camera.view(), job);
        for (const float distance : picture.distance) {
            EXPECT_NEAR(distance, perspective ? 2.0 : 1.95, 1e-3);
        }
    }
}

TEST(Trace, IndexOutOfRange)
{
    const std::vector<glm::vec3> positions(3, glm::vec3(0.0f));
    const std::vector<glm::uvec3> triangles{{0, 1, 2}, {0, 1, 3}};
    Job job;
    const View view = Camera(true, {0, 0, 2}, {0, 0, 0}, 0.5, {4, 4}).view();
    expect_refusal<InvalidArgument>([&] { trace(positions, triangles, view, job); }, {"triangle 1", "3"});
}

TEST(Realize, MirroredUvsKeepTheOutsideOutside)
{
    const Sample sample = sphere({0.5f, 0.5f, 0.3f}, 0.25f, 8, 12).sample(0.6f);
    SurfaceMesh surface = flat_grid(1, 1, 1.0f, 1.0f);
    const double volume = volume_of(realize_on(surface, 0.6f, sample));
    EXPECT_GT(volume, 0.0);
    for (glm::vec2& uv : surface.uvs) {
        uv.x = 1.0f - uv.x;
    }
    EXPECT_NEAR(volume_of(realize_on(surface, 0.6f, sample)), volume, 1e-6);
}

TEST(Realize, UvsOverTooManyTiles)
{
    const Sample sample = sphere({0.5f, 0.5f, 0.3f}, 0.25f, 4, 4).sample(0.6f);
    for (const float scale : {100.0f, 2000.0f, 1e17f, 3e38f}) {
        SurfaceMesh surface = flat_grid(1, 1, 1.0f, 1.0f);
        for (glm::vec2& uv : surface.uvs) {
            uv *= scale;
        }
        expect_refusal<InvalidArgument>([&] { realize_on(surface, 0.6f, sample); }, {"tiles", "smaller UVs"});
    }
}

}  // namespace
}  // namespace mesoshell
