// What options of a shell are refused, and that a refusal names what is wrong with them.
#include <algorithm>
#include <cmath>
#include <limits>

#include "check.h"
#include "meshes.h"

namespace mesoshell {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

template <typename Refusal = InvalidArgument>
void expect_refused(const ShellOptions& options, std::initializer_list<const char*> words)
{
    const SurfaceMesh mesh = flat_grid(2, 2, 1.0f, 1.0f);
    expect_refusal<Refusal>([&] { build_shell(mesh.surface(), options); }, words);
}

TEST(ExtrusionInput, CoveredFaces)
{
    ShellOptions options;
    const std::vector<std::uint8_t> none(4, 0);
    options.covered = none;
    expect_refused(options, {"no face", "covered", "mark"});
    options.covered = std::span(none).first(3);
    expect_refused(options, {"covered", "3 marks", "4 faces"});
}

TEST(ExtrusionInput, CoveredFacesWithoutArea)
{
    SurfaceMesh mesh = one_triangle();
    mesh.face_sizes.push_back(3);
    mesh.corners.insert(mesh.corners.end(), {0, 0, 1});
    mesh.uvs.resize(6);
    const std::vector<std::uint8_t> covered{0, 1};
    ShellOptions options;
    options.covered = covered;
    expect_refusal<Error>([&] { build_shell(mesh.surface(), options); }, {"covered face", "zero area"});
}

TEST(ExtrusionInput, ThicknessFactors)
{
    ShellOptions options;
    std::vector<float> factors(9, 0.5f);
    options.thickness_factors = std::span(factors).first(8);
    expect_refused(options, {"8 thickness factors", "9 vertices"});
    options.thickness_factors = factors;
    for (const float bad : {-0.001f, 1.001f, nan, infinite}) {
        factors[4] = bad;
        expect_refused(options, {"factor of vertex 4", "0 to 1"});
    }
    std::fill(factors.begin(), factors.end(), 0.0f);
    expect_refused<Error>(options, {"thickness is 0 everywhere", "paint"});
}

TEST(ExtrusionInput, ThicknessImage)
{
    ShellOptions options;
    std::vector<float> pixels(6, 1.0f);
    options.thickness_image = {pixels, {3, 3}};
    expect_refused(options, {"image", "6 values", "3 x 3"});
    options.thickness_image = {pixels, {-3, -2}};
    expect_refused(options, {"image", "6 values"});
    options.thickness_image = {{}, {0, 3}};
    expect_refused(options, {"image", "0 values"});
    options.thickness_image = {pixels, {3, 2}};
    for (const float bad : {-1.0f, nan, infinite}) {
        pixels[5] = bad;
        expect_refused(options, {"pixel (2, 1)", "negative"});
    }
    std::fill(pixels.begin(), pixels.end(), 1e30f);
    options.thickness = 1e30f;
    expect_refused<Error>(options, {"image", "beyond all numbers"});
}

TEST(ExtrusionInput, ShiftAndSteps)
{
    for (const float bad : {0.5f, -1.5f, nan}) {
        ShellOptions options;
        options.shift = bad;
        expect_refused(options, {"shift", "outward", "inward"});
    }
    for (const int bad : {-1, 101}) {
        ShellOptions options;
        options.director_smoothing = bad;
        expect_refused(options, {"smoothing", "0 to 100"});
        options = {};
        options.relax_steps = bad;
        expect_refused(options, {"relaxation", "0 to 100"});
    }
}

TEST(ExtrusionInput, Placement)
{
    for (const float bad : {0.0f, nan, infinite}) {
        for (int axis = 0; axis < 2; ++axis) {
            ShellOptions options;
            options.placement.scale[axis] = bad;
            expect_refused(options, {"UV scale", "other than 0"});
        }
    }
    for (const float bad : {nan, infinite}) {
        ShellOptions options;
        options.placement.rotation = bad;
        expect_refused(options, {"UV rotation", "angle"});
        options = {};
        options.placement.offset.y = bad;
        expect_refused(options, {"UV offset", "tiles"});
    }
    SurfaceMesh far = flat_grid(1, 1, 1.0f, 1.0f);
    for (glm::vec2& uv : far.uvs) {
        uv *= 1e30f;
    }
    ShellOptions options;
    options.placement.scale.x = 1e30f;
    expect_refusal<InvalidArgument>([&] { build_shell(far.surface(), options); }, {"UV scale", "smaller"});
}

}  // namespace
}  // namespace mesoshell
