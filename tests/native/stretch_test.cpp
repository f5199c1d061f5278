// Stretch against closed forms, and against quadrature of the map itself.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "check.h"
#include "mesoshell/stretch.h"
#include "shell_shapes.h"

namespace mesoshell {
namespace {

constexpr double pi = std::numbers::pi;

Shell with_uvs(SurfaceMesh mesh, const glm::mat2& linear, float thickness)
{
    for (glm::vec2& uv : mesh.uvs) {
        uv = linear * uv;
    }
    return mesh.shell(thickness);
}

void expect_all(const Stretch& found, double rms, double angle)
{
    for (std::size_t p = 0; p < found.rms.size(); ++p) {
        ASSERT_NEAR(found.rms[p], rms, 1e-6 * rms);
        ASSERT_NEAR(found.angle[p], angle, 1e-6);
    }
    EXPECT_NEAR(found.total, rms, 1e-6 * rms);
    EXPECT_EQ(found.infinite, 0u);
}

TEST(Stretch, FlatIsometryHasNone)
{
    const Shell shell = with_uvs(flat_grid(4, 3, 2.0f, 1.5f), glm::mat2(1.0f), 0.25f);
    expect_all(stretch(shell, {1.0, 0.25}), 1.0, pi / 2);
    expect_all(stretch(shell), 1.0, pi / 2);
    EXPECT_NEAR(stretch(shell).proportions.aspect, 1.0, 1e-6);
    EXPECT_NEAR(stretch(shell).proportions.height, 0.25, 1e-6);
}

TEST(Stretch, SimilaritiesHaveNone)
{
    // Tiles of a third of a unit, turned; the height in proportion. Mirrored ones are not stretched either.
    const float c = 3.0f * std::cos(0.4f);
    const float s = 3.0f * std::sin(0.4f);
    for (const glm::mat2& linear : {glm::mat2(c, s, -s, c), glm::mat2(c, s, s, -c)}) {
        expect_all(stretch(with_uvs(flat_grid(4, 3, 2.0f, 1.5f), linear, 0.25f), {1.0, 0.75}), 1.0, pi / 2);
    }
}

TEST(Stretch, AnisotropicScales)
{
    // Singular values 1, 2 and 1: their mean scale is the cube root of 2.
    const Shell shell = with_uvs(flat_grid(4, 3, 2.0f, 1.5f), glm::mat2(1.0f, 0.0f, 0.0f, 0.5f), 0.25f);
    expect_all(stretch(shell, {1.0, 0.25}), std::sqrt((1.0 + 4.0 + 1.0) / 3.0) / std::cbrt(2.0), pi / 2);
    // A tile of that aspect keeps its proportions.
    expect_all(stretch(shell, {2.0, 0.25}), 1.0, pi / 2);
    expect_all(stretch(shell), 1.0, pi / 2);
    EXPECT_NEAR(stretch(shell).proportions.aspect, 2.0, 1e-6);
    // Twice too thick for the tile.
    expect_all(stretch(shell, {2.0, 0.125}), std::sqrt((1.0 + 1.0 + 4.0) / 3.0) / std::cbrt(2.0), pi / 2);
}

TEST(Stretch, ShearTurnsTheAxes)
{
    // (u, v) = (x - y tan a, y): dP/du = (1, 0), dP/dv = (tan a, 1), the angle between them pi / 2 - a.
    const double a = 0.6;
    const float t = static_cast<float>(std::tan(a));
    const Shell shell = with_uvs(flat_grid(4, 3, 2.0f, 1.5f), glm::mat2(1.0f, 0.0f, -t, 1.0f), 0.25f);
    expect_all(stretch(shell, {1.0, 0.25}), std::sqrt((1.0 + 1.0 + std::tan(a) * std::tan(a) + 1.0) / 3.0), pi / 2 - a);
}

TEST(Stretch, ConeOfOneQuadHasItsExactIntegral)
{
    // One narrow wedge of a cylinder: the base of width b, the top of width c, so that at height w the width is b + (c - b)
    // w; the depth is 1 at both. With UVs of the base in proportion, |dP/du| = 1 + k w, k = c / b - 1, |dP/dv| = 1, and
    // dP/dw is h upward and k x sideways, x from -b / 2 to b / 2.
    SurfaceMesh mesh = flat_grid(1, 1, 0.5f, 1.0f);
    const double b = 0.5;
    const double k = 0.5;
    const double h = 0.25;
    for (std::size_t i = 0; i < 4; ++i) {
        mesh.positions[i].x -= 0.25f;
    }
    Shell shell = mesh.shell(0.25f);
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::vec3 rise(static_cast<float>(k) * shell.positions[i].x, 0.0f, 0.25f);
        shell.thickness[i] = glm::length(rise);
        shell.directors[i] = rise / shell.thickness[i];
    }
    const Stretch found = stretch(shell, {1.0, h});
    // Over the volume element (1 + k w) dx dy dw, x over the base's width: the mean of |dP/du|^2 + |dP/dv|^2 + |dP/dw|^2 /
    // h^2.
    const double volume = 1.0 + k / 2;
    const double u = (std::pow(1.0 + k, 4) - 1.0) / (4.0 * k) / volume;
    const double w = 1.0 + k * k * b * b / 12.0 / (h * h);
    const double mean_scale = std::cbrt(volume);
    EXPECT_NEAR(found.total, std::sqrt((u + 1.0 + w) / 3.0) / mean_scale, 1e-6);
}

TEST(Stretch, CylinderOutwardConvergesToItsIntegral)
{
    // Radius 1, thickness 1/2, tiles in proportion on the surface: dP/du = r at radius r, the other two 1. Over the volume
    // element r dr: the mean of r^2 is (R^4 - 1) / (2 (R^2 - 1)), the mean scale the cube root of (R^2 - 1) / 2 / (R - 1).
    const double outer = 1.5;
    const double mean_square = (std::pow(outer, 4) - 1.0) / (2.0 * (outer * outer - 1.0));
    const double exact = std::sqrt((mean_square + 2.0) / 3.0) / std::cbrt((outer + 1.0) / 2.0);
    double errors[2];
    for (const int around : {48, 96}) {
        SurfaceMesh mesh = lathe(around, 4, 1.0f, 1.0f, [](double) { return 1.0; }, [](double) { return 0.0; });
        for (glm::vec2& uv : mesh.uvs) {
            uv.x *= static_cast<float>(2.0 * pi);
        }
        errors[around / 96] = std::abs(stretch(mesh.shell(0.5f), {1.0, 0.5}).total - exact);
    }
    EXPECT_LT(errors[0], 2e-3);
    EXPECT_NEAR(errors[1] / errors[0], 0.25, 0.05);  // chords are off by the square of their angle
}

// Sums over a fine grid of midpoints in prism coordinates, the map's derivative by differences: shares nothing with the
// integrals.
double brute_force_rms(const Shell& shell, std::size_t p, double aspect, double height, double scale)
{
    const glm::uvec3& t = shell.topology->triangles[p];
    const glm::uvec3& uvs = shell.topology->uv_triangles[p];
    const std::vector<glm::vec2>& top = shell.top_uvs.empty() ? shell.topology->uvs : shell.top_uvs;
    const auto position = [&](const glm::dvec3& q) {
        const double weights[3] = {1.0 - q.x - q.y, q.x, q.y};
        glm::dvec3 sum(0.0);
        for (int i = 0; i < 3; ++i) {
            sum += weights[i] * glm::mix(glm::dvec3(shell.base(t[i])), glm::dvec3(shell.top(t[i])), q.z);
        }
        return sum;
    };
    const auto texture = [&](const glm::dvec3& q) {
        const double weights[3] = {1.0 - q.x - q.y, q.x, q.y};
        glm::dvec2 sum(0.0);
        for (int i = 0; i < 3; ++i) {
            sum += weights[i] * glm::mix(glm::dvec2(shell.topology->uvs[uvs[i]]), glm::dvec2(top[uvs[i]]), q.z);
        }
        return glm::dvec3(sum.x, sum.y * aspect, q.z * height);
    };
    const int n = 48;
    double sum = 0.0;
    double volume = 0.0;
    for (int i = 0; i < 2 * n * n; ++i) {
        const int row = i / (2 * n);
        const int column = i % (2 * n) / 2;
        const double third = i % 2 == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
        const glm::dvec2 q((column + third) / n, (row + third) / n);
        if (q.x + q.y >= 1.0) {
            continue;
        }
        for (int k = 0; k < n; ++k) {
            const glm::dvec3 at(q, (k + 0.5) / n);
            glm::dmat3 by_q;
            glm::dmat3 texture_by_q;
            for (int axis = 0; axis < 3; ++axis) {
                glm::dvec3 step(0.0);
                step[axis] = 1e-4;
                by_q[axis] = (position(at + step) - position(at - step)) / 2e-4;
                texture_by_q[axis] = (texture(at + step) - texture(at - step)) / 2e-4;
            }
            const glm::dmat3 map = by_q * glm::inverse(texture_by_q);
            const double element = glm::determinant(by_q);
            volume += element;
            sum += element * (glm::dot(map[0], map[0]) + glm::dot(map[1], map[1]) + glm::dot(map[2], map[2]));
        }
    }
    return std::sqrt(sum / volume / 3.0) / scale;
}

TEST(Stretch, AgreesWithQuadratureOfTheMap)
{
    SurfaceMesh mesh = one_triangle();
    mesh.uvs = {{0.125f, 0.25f}, {0.5f, 0.5f}, {0.75f, 1.0f}};
    mesh.normals = {{0.5f, 0.2f, 1.0f}, {-0.4f, 0.3f, 1.0f}, {-0.2f, -0.5f, 1.0f}};
    for (const bool relaxed : {false, true}) {
        Shell shell = mesh.shell(0.4f);
        shell.thickness = {0.4f, 0.3f, 0.5f};
        if (relaxed) {
            shell.top_uvs = shell.topology->uvs;
            shell.top_uvs[0] += glm::vec2(0.05f, -0.02f);
            shell.top_uvs[1] += glm::vec2(-0.03f, 0.04f);
        }
        const Stretch found = stretch(shell, {1.5, 0.2});
        // One prism: its mean scale is the cube root of its volume over that in texture space.
        double volume = 0.0;
        double tiles = 0.0;
        const int n = 1000;
        for (int k = 0; k < n; ++k) {
            const double w = (k + 0.5) / n;
            const glm::uvec3& t = shell.topology->triangles[0];
            const glm::uvec3& uvs = shell.topology->uv_triangles[0];
            const auto at = [&](int i) { return glm::mix(glm::dvec3(shell.base(t[i])), glm::dvec3(shell.top(t[i])), w); };
            glm::dvec3 up(0.0);
            for (int i = 0; i < 3; ++i) {
                up += (glm::dvec3(shell.top(t[i])) - glm::dvec3(shell.base(t[i]))) / 3.0;
            }
            volume += 0.5 * glm::dot(glm::cross(at(1) - at(0), at(2) - at(0)), up) / n;
            const auto uv = [&](int i) {
                const glm::dvec2 base(shell.topology->uvs[uvs[i]]);
                return relaxed ? glm::mix(base, glm::dvec2(shell.top_uvs[uvs[i]]), w) : base;
            };
            const glm::dvec2 e1 = uv(1) - uv(0);
            const glm::dvec2 e2 = uv(2) - uv(0);
            tiles += 0.5 * std::abs(e1.x * e2.y - e1.y * e2.x) * 1.5 * 0.2 / n;
        }
        const double expected = brute_force_rms(shell, 0, 1.5, 0.2, std::cbrt(volume / tiles));
        EXPECT_NEAR(found.rms[0], expected, 2e-3 * expected);
        EXPECT_NEAR(found.total, found.rms[0], 1e-6 * expected);
    }
}

TEST(Stretch, DefaultProportionsAreTheBest)
{
    const Shell shell = vase(24, 16).shell(0.05f);
    const Stretch best = stretch(shell);
    EXPECT_GE(best.total, 1.0);
    for (const double factor : {0.8, 0.99, 1.01, 1.3}) {
        EXPECT_GT(stretch(shell, {best.proportions.aspect * factor, best.proportions.height}).total, best.total);
        EXPECT_GT(stretch(shell, {best.proportions.aspect, best.proportions.height * factor}).total, best.total);
        const Stretch fitted = stretch(shell, {best.proportions.aspect * factor, 0.0});
        EXPECT_LT(fitted.total, stretch(shell, {best.proportions.aspect * factor, fitted.proportions.height * 1.01}).total);
        EXPECT_LT(fitted.total, stretch(shell, {best.proportions.aspect * factor, fitted.proportions.height * 0.99}).total);
    }
}

TEST(Stretch, UvsWithoutAreaAreInfiniteAndCounted)
{
    SurfaceMesh mesh = flat_grid(2, 1, 2.0f, 1.0f);
    for (std::size_t i = 4; i < 8; ++i) {
        mesh.uvs[i] = {0.5f, mesh.uvs[i].y};
    }
    const Stretch found = stretch(mesh.shell(0.5f));
    EXPECT_EQ(found.infinite, 2u);
    for (std::size_t p = 0; p < 4; ++p) {
        EXPECT_EQ(std::isinf(found.rms[p]), p >= 2);
        EXPECT_TRUE(std::isfinite(found.angle[p]));
    }
    EXPECT_NEAR(found.total, 1.0, 1e-6);  // of the others
    std::fill(mesh.uvs.begin(), mesh.uvs.end(), glm::vec2(0.0f));
    EXPECT_EQ(stretch(mesh.shell(0.5f)).infinite, 4u);
    EXPECT_EQ(stretch(mesh.shell(0.5f)).total, 0.0);
}

TEST(Stretch, UvsThatTurnOverBetweenAreInfinite)
{
    // The top is the base times -1 in u and -2 in v about the triangle's middle, twice its area and wound alike; between, at
    // height w, it is (1 - 2 w) (1 - 3 w) times the area: wound the other way from 1/3 to 1/2.
    SurfaceMesh mesh = one_triangle();
    mesh.uvs = {{0.125f, 0.25f}, {0.5f, 0.5f}, {0.75f, 1.0f}};
    Shell shell = mesh.shell(0.5f);
    EXPECT_EQ(stretch(shell).infinite, 0u);
    const std::vector<glm::vec2>& uvs = shell.topology->uvs;
    const glm::vec2 middle = (uvs[0] + uvs[1] + uvs[2]) / 3.0f;
    for (const glm::vec2& uv : uvs) {
        shell.top_uvs.push_back(middle - (uv - middle) * glm::vec2(1.0f, 2.0f));
    }
    EXPECT_EQ(stretch(shell).infinite, 1u);
}

TEST(Stretch, ProportionsOutOfRange)
{
    const Shell shell = cube().shell(0.5f);
    for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        expect_refusal<InvalidArgument>([&] { stretch(shell, {bad, 1.0}); }, {"aspect", "tile widths"});
        expect_refusal<InvalidArgument>([&] { stretch(shell, {1.0, bad}); }, {"height", "tile widths"});
    }
}

}  // namespace
}  // namespace mesoshell
