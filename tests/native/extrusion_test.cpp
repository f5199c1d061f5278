// Covered faces, thickness, shift and placement: laws that hold on any mesh.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "check.h"
#include "meshes.h"

namespace mesoshell {
namespace {

constexpr float ulp = 0x1p-23f;

// As many tiles around as faces, so that UVs and their seams are exact.
SurfaceMesh seamed_torus()
{
    return torus(1.0f, 0.4f, 8, 8, 8.0f, 8.0f);
}

Shell shell_of(const SurfaceMesh& mesh, const ShellOptions& options)
{
    return build_shell(mesh.surface(), options);
}

// --- Covered faces ---

TEST(Covered, BothPartsTogetherAreTheWhole)
{
    const SurfaceMesh mesh = seamed_torus();
    std::vector<std::uint8_t> covered(mesh.face_sizes.size());
    std::vector<std::uint8_t> uncovered(mesh.face_sizes.size());
    Random random(3);
    for (std::size_t i = 0; i < covered.size(); ++i) {
        covered[i] = random.below(2) == 0 ? 7 : 0;
        uncovered[i] = covered[i] == 0 ? 1 : 0;
    }
    std::vector<float> factors(mesh.positions.size());
    for (float& factor : factors) {
        factor = static_cast<float>(random.uniform(0.1, 1.0));
    }
    for (const int levels : {0, 2}) {
        ShellOptions options;
        options.refinement.levels = levels;
        options.thickness_factors = factors;
        options.shift = -0.5f;
        options.placement = {{2.0f, -1.0f}, 0.3f, {0.1f, 0.2f}};
        const Shell whole = shell_of(mesh, options);
        std::size_t prisms = 0;
        for (const std::vector<std::uint8_t>* part : {&covered, &uncovered}) {
            options.covered = *part;
            const Shell half = shell_of(mesh, options);
            std::size_t next = 0;
            for (std::size_t p = 0; p < whole.prisms.size(); ++p) {
                if ((*part)[static_cast<std::size_t>(whole.topology->faces[p])] != 0) {
                    ASSERT_LT(next, half.prisms.size());
                    ASSERT_EQ(half.topology->faces[next], whole.topology->faces[p]);
                    ASSERT_EQ(half.prisms[next++], whole.prisms[p]);
                }
            }
            ASSERT_EQ(next, half.prisms.size());
            prisms += next;
        }
        EXPECT_EQ(prisms, whole.prisms.size());
    }
}

TEST(Covered, UncoveredFaceMayHaveAnyCorners)
{
    SurfaceMesh mesh = one_triangle();
    mesh.normals.clear();
    mesh.positions.insert(mesh.positions.end(), {{-1, 0, 0}, {-1, -1, 0}, {0, -1, 0}});
    mesh.face_sizes.push_back(5);
    mesh.corners.insert(mesh.corners.end(), {2, 3, 4, 5, 0});
    mesh.uvs.resize(8, glm::vec2(0.0f));
    ShellOptions options;
    expect_refusal<Error>([&] { shell_of(mesh, options); }, {"face 1", "5 corners"});
    const std::vector<std::uint8_t> covered{1, 0};
    options.covered = covered;
    EXPECT_EQ(shell_of(mesh, options).prisms.size(), 1u);
}

// --- Thickness ---

TEST(Thickness, LinearFactorsStayLinearWhereFacesAreRegular)
{
    // Subdivision of a regular grid reproduces linear functions; at the border too, where edges follow their own rule.
    const SurfaceMesh mesh = flat_grid(6, 4, 3.0f, 2.0f);
    std::vector<float> factors;
    const auto linear = [](const glm::vec3& p) { return 0.1f + 0.2f * p.x + 0.1f * p.y; };
    for (const glm::vec3& p : mesh.positions) {
        factors.push_back(linear(p));
    }
    for (const Scheme scheme : {Scheme::catmark, Scheme::bilinear}) {
        for (const int levels : {0, 1, 2, 3}) {
            ShellOptions options;
            options.thickness = 0.5f;
            options.thickness_factors = factors;
            options.refinement.levels = levels;
            options.refinement.scheme = scheme;
            const Shell shell = shell_of(mesh, options);
            ASSERT_EQ(shell.prisms.size(), static_cast<std::size_t>(2 * 6 * 4) << (2 * levels));
            for (std::size_t v = 0; v < shell.positions.size(); ++v) {
                ASSERT_NEAR(shell.thickness[v], 0.5f * linear(shell.positions[v]), 8 * ulp);
            }
        }
    }
}

TEST(Thickness, ConstantImageAndConstantFactorsScaleIt)
{
    const SurfaceMesh mesh = seamed_torus();
    for (const float value : {0.75f, 0.3f}) {
        const std::vector<float> pixels(12, value);
        const std::vector<float> factors(mesh.positions.size(), value);
        ShellOptions scaled;
        scaled.thickness = 0.2f * value;
        ShellOptions by_image;
        by_image.thickness = 0.2f;
        by_image.thickness_image = {pixels, {4, 3}};
        ShellOptions by_factors;
        by_factors.thickness = 0.2f;
        by_factors.thickness_factors = factors;
        EXPECT_EQ(shell_of(mesh, by_image).prisms, shell_of(mesh, scaled).prisms);
        EXPECT_EQ(shell_of(mesh, by_factors).prisms, shell_of(mesh, scaled).prisms);
    }
}

TEST(Thickness, ImageIsBilinearBetweenCentersAndRepeats)
{
    // 4 pixels along u, 2 along v: at u = 3/8 and 5/8 the centers of pixels 1 and 2, halfway between them u = 1/2; u = 0
    // lies between the last pixel and the first. UVs a tile and more away see the same.
    const std::vector<float> pixels{1, 2, 3, 4, 10, 20, 30, 40};
    const struct {
        glm::vec2 uv;
        float expected;
    } cases[] = {{{0.375f, 0.25f}, 2.0f},  {{0.625f, 0.25f}, 3.0f}, {{0.5f, 0.25f}, 2.5f},     {{0.0f, 0.25f}, 2.5f},
                 {{1.0f, 0.75f}, 25.0f},   {{0.375f, 0.5f}, 11.0f}, {{0.375f, 0.0f}, 11.0f},   {{0.375f, 1.0f}, 11.0f},
                 {{-2.625f, 3.25f}, 2.0f}, {{5.5f, -7.75f}, 2.5f},  {{0.4375f, 0.375f}, 7.3125f}};
    for (const auto& [uv, expected] : cases) {
        SurfaceMesh mesh = one_triangle();
        mesh.uvs[1] = uv;  // of vertex 0
        ShellOptions options;
        options.thickness = 2.0f;
        options.thickness_image = {pixels, {4, 2}};
        EXPECT_EQ(shell_of(mesh, options).thickness[0], 2.0f * expected) << uv.x << ", " << uv.y;
    }
}

TEST(Thickness, ImageIsSampledBeforePlacement)
{
    const std::vector<float> pixels{0.2f, 0.4f, 0.9f};
    const SurfaceMesh mesh = flat_grid(5, 5, 1.0f, 1.0f);
    ShellOptions options;
    options.thickness_image = {pixels, {3, 1}};
    const std::vector<float> before = shell_of(mesh, options).thickness;
    options.placement = {{3.0f, 0.5f}, 1.0f, {0.3f, 0.4f}};
    EXPECT_EQ(shell_of(mesh, options).thickness, before);
}

TEST(Thickness, ColumnOnASeamIsOneAndTheMeanOfItsSides)
{
    SurfaceMesh mesh = flat_grid(2, 1, 2.0f, 1.0f);
    for (std::size_t i = 0; i < 8; ++i) {
        mesh.uvs[i] = glm::vec2(i < 4 ? 0.25f : 0.75f, 0.5f);  // each quad sees one pixel
    }
    const std::vector<float> pixels{0.5f, 1.0f};
    ShellOptions options;
    options.thickness = 1.0f;
    options.thickness_image = {pixels, {2, 1}};
    for (const int levels : {0, 1, 2}) {
        options.refinement.levels = levels;
        const Shell shell = shell_of(mesh, options);
        std::map<std::array<float, 3>, std::vector<glm::vec3>> tops;
        for (const PrismTexels& prism : shell.prisms) {
            for (int i = 0; i < 3; ++i) {
                const glm::vec3 base(prism[i]);
                const float expected = base.x < 1.0f - ulp ? 0.5f : base.x > 1.0f + ulp ? 1.0f : 0.75f;
                ASSERT_EQ(prism[i + 3].z, expected) << "at x = " << base.x;
                tops[{base.x, base.y, base.z}].push_back(glm::vec3(prism[i + 3]));
            }
        }
        for (const auto& [base, columns] : tops) {
            for (const glm::vec3& top : columns) {
                ASSERT_EQ(top, columns[0]);
            }
        }
    }
}

TEST(Thickness, PrismsWithoutVolumeAreLeftOut)
{
    // Of 4 x 1 quads the vertices of the first two columns are 0: the first quad's prisms go, the second's become wedges.
    const SurfaceMesh mesh = flat_grid(4, 1, 4.0f, 1.0f);
    std::vector<float> factors;
    for (const glm::vec3& p : mesh.positions) {
        factors.push_back(p.x < 1.5f ? 0.0f : 1.0f);
    }
    ShellOptions options;
    options.thickness_factors = factors;
    const Shell shell = shell_of(mesh, options);
    ASSERT_EQ(shell.prisms.size(), 6u);
    EXPECT_EQ(std::count(shell.topology->faces.begin(), shell.topology->faces.end(), 0), 0);
    for (std::size_t p = 0; p < 6; ++p) {
        const glm::uvec3& t = shell.topology->triangles[p];
        EXPECT_GT(shell.thickness[t.x] + shell.thickness[t.y] + shell.thickness[t.z], 0.0f);
    }
}

// --- Shift ---

TEST(Shift, InwardIsOutwardOfTheSurfaceBelow)
{
    SurfaceMesh mesh = flat_grid(3, 2, 1.5f, 1.0f);
    SurfaceMesh below = mesh;
    for (glm::vec3& p : below.positions) {
        p.z = -0.25f;
    }
    SurfaceMesh half_below = mesh;
    for (glm::vec3& p : half_below.positions) {
        p.z = -0.125f;
    }
    ShellOptions options;
    options.thickness = 0.25f;
    const auto outward_of_below = shell_of(below, options);
    const auto outward_of_half_below = shell_of(half_below, options);
    options.shift = -1.0f;
    const Shell inward = shell_of(mesh, options);
    EXPECT_EQ(inward.prisms, outward_of_below.prisms);
    EXPECT_EQ(inward.indices, outward_of_below.indices);
    options.shift = -0.5f;
    EXPECT_EQ(shell_of(mesh, options).prisms, outward_of_half_below.prisms);
}

TEST(Shift, TopOfAnInwardShellIsTheSurfaceItself)
{
    const SurfaceMesh mesh = seamed_torus();
    ShellOptions options;
    options.thickness = 0.1f;
    const Shell outward = shell_of(mesh, options);
    options.shift = -1.0f;
    const Shell inward = shell_of(mesh, options);
    for (std::size_t p = 0; p < inward.prisms.size(); ++p) {
        for (int i = 0; i < 3; ++i) {
            ASSERT_EQ(inward.prisms[p][i + 3], outward.prisms[p][i]);
        }
        // The prism is not turned over: its volume at the base is positive still.
        const auto at = [&](int i) { return glm::vec3(inward.prisms[p][i]); };
        ASSERT_GT(glm::dot(glm::cross(at(1) - at(0), at(2) - at(0)), at(3) - at(0)), 0.0f);
    }
}

// --- Placement ---

std::vector<glm::vec2> placed(const Placement& placement)
{
    ShellOptions options;
    options.placement = placement;
    return shell_of(flat_grid(3, 2, 1.5f, 1.0f), options).topology->uvs;
}

TEST(Placement, ScalesThenTurnsCounterclockwiseThenMoves)
{
    const std::vector<glm::vec2> plain = placed({});
    const Placement placement{{2.0f, -3.0f}, 0.5f, {0.25f, -0.75f}};
    const std::vector<glm::vec2> uvs = placed(placement);
    for (std::size_t i = 0; i < uvs.size(); ++i) {
        const glm::dvec2 scaled(2.0 * plain[i].x, -3.0 * plain[i].y);
        const glm::dvec2 expected(std::cos(0.5) * scaled.x - std::sin(0.5) * scaled.y + 0.25,
                                  std::sin(0.5) * scaled.x + std::cos(0.5) * scaled.y - 0.75);
        EXPECT_LT(glm::length(glm::dvec2(uvs[i]) - expected), 4 * ulp);
    }
}

TEST(Placement, HalfATurnNegates)
{
    const std::vector<glm::vec2> plain = placed({});
    const std::vector<glm::vec2> turned = placed({{1.0f, 1.0f}, std::numbers::pi_v<float>, {0.0f, 0.0f}});
    const std::vector<glm::vec2> negated = placed({{-1.0f, -1.0f}, 0.0f, {0.0f, 0.0f}});
    for (std::size_t i = 0; i < plain.size(); ++i) {
        EXPECT_EQ(negated[i], -plain[i]);
        EXPECT_LT(glm::length(turned[i] - negated[i]), 2 * ulp);
    }
}

TEST(Placement, TurnsAddUp)
{
    SurfaceMesh mesh = flat_grid(3, 2, 1.5f, 1.0f);
    ShellOptions once;
    once.placement.rotation = 0.7f;
    // The placed UVs, corner by corner, as the UVs of a mesh: the prisms list its triangles in the order of faces.
    const Shell first = shell_of(mesh, once);
    SurfaceMesh turned = mesh;
    turned.face_sizes.assign(first.prisms.size(), 3);
    turned.corners.clear();
    turned.uvs.clear();
    for (std::size_t p = 0; p < first.prisms.size(); ++p) {
        for (int i = 0; i < 3; ++i) {
            turned.corners.push_back(static_cast<std::int32_t>(first.topology->triangles[p][i]));
            turned.uvs.push_back(first.topology->uvs[first.topology->uv_triangles[p][i]]);
        }
    }
    ShellOptions twice;
    twice.placement.rotation = 1.4f;
    const Shell composed = shell_of(turned, once);
    const Shell direct = shell_of(mesh, twice);
    for (std::size_t p = 0; p < direct.prisms.size(); ++p) {
        for (int i = 0; i < 3; ++i) {
            const glm::vec2 a = composed.topology->uvs[composed.topology->uv_triangles[p][i]];
            const glm::vec2 b = direct.topology->uvs[direct.topology->uv_triangles[p][i]];
            EXPECT_LT(glm::length(a - b), 8 * ulp);
        }
    }
}

TEST(Placement, WholeTilesOfAnOffsetCostNoDigits)
{
    const std::vector<glm::vec2> near = placed({{0.3f, 0.3f}, 0.2f, {0.25f, -0.5f}});
    const std::vector<glm::vec2> far = placed({{0.3f, 0.3f}, 0.2f, {2097152.25f, -1048576.5f}});
    EXPECT_EQ(near, far);
}

}  // namespace
}  // namespace mesoshell
