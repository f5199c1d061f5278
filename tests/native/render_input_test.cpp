// Views, and what the renderer refuses.
#include <algorithm>
#include <cmath>
#include <limits>

#include "camera.h"
#include "check.h"
#include "mesoshell/realize.h"
#include "meshes.h"
#include "render_with.h"

namespace mesoshell {
namespace {

const Map& ball_map()
{
    static const Map map = sdf_map(sphere({0.5f, 0.5f, 0.25f}, 0.2f, 8, 12).sample(0.5f), {8, 8, 5});
    return map;
}

TEST(EyeOf, PerspectiveAndParallelViews)
{
    Random random(1);
    for (int i = 0; i < 100; ++i) {
        const glm::dvec3 eye = random.in_box(glm::dvec3(-5.0), glm::dvec3(5.0));
        const glm::dvec3 target = random.in_box(glm::dvec3(-1.0), glm::dvec3(1.0));
        const Camera near_camera(true, eye, target, random.uniform(0.2, 2.0), {40, 30});
        EXPECT_LT(glm::length(eye_of(near_camera.view().clip_from_object) - glm::dvec4(eye, 1.0)), 1e-8);
        const Camera parallel(false, eye, target, random.uniform(0.2, 2.0), {40, 30});
        EXPECT_LT(glm::length(eye_of(parallel.view().clip_from_object) - glm::dvec4(-parallel.forward(), 0.0)), 1e-8);
    }
}

TEST(RenderInput, MatricesThatAreNoView)
{
    const Shell shell = flat_grid(1, 1, 1.0f, 1.0f).shell(0.5f);
    const Map& map = ball_map();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    View flat;
    flat.clip_from_object[2] = glm::dvec4(0.0);
    for (const glm::dmat4& matrix : {glm::dmat4(0.0), glm::dmat4(nan),
                                     glm::dmat4(std::numeric_limits<double>::infinity()), flat.clip_from_object}) {
        View view;
        view.clip_from_object = matrix;
        view.size = glm::ivec2(4);
        expect_refusal<InvalidArgument>([&] { eye_of(matrix); }, {"clip_from_object"});
        expect_refusal<InvalidArgument>([&] { render_with(shell, map, view, sdf_traversal); }, {"clip_from_object"});
    }
}

TEST(RenderInput, SizesOutOfRange)
{
    const Shell shell = flat_grid(1, 1, 1.0f, 1.0f).shell(0.5f);
    const Map& map = ball_map();
    for (const glm::ivec2 size : {glm::ivec2(0, 4), {4, 0}, {-4, 4}, {4, 16385}}) {
        View view = Camera(true, {0, 0, 2}, {0, 0, 0}, 0.5, {4, 4}).view();
        view.size = size;
        expect_refusal<InvalidArgument>([&] { render_with(shell, map, view, sdf_traversal); },
                                        {"pixels", "1 to 16384"});
        Job job;
        expect_refusal<InvalidArgument>([&] { trace({}, {}, view, job); }, {"pixels", "1 to 16384"});
    }
}

TEST(RenderInput, TraversalThatDoesNotExist)
{
    const Shell shell = flat_grid(1, 1, 1.0f, 1.0f).shell(0.5f);
    const View view = Camera(true, {0, 0, 2}, {0, 0, 0}, 0.5, {4, 4}).view();
    for (const int traversal : {-1, 6, 1000}) {
        expect_refusal<InvalidArgument>([&] { render_with(shell, ball_map(), view, traversal); },
                                        {"traversal", std::to_string(traversal).c_str()});
    }
}

TEST(RenderInput, ExactWithoutTheTileOfTheMap)
{
    const Shell shell = flat_grid(1, 1, 1.0f, 1.0f).shell(0.5f);
    const View view = Camera(true, {0, 0, 2}, {0, 0, 0}, 0.5, {4, 4}).view();
    expect_refusal<InvalidArgument>([&] { render_with(shell, ball_map(), view, exact_traversal); }, {"exact", "sample"});
    Job job;
    const Sample other = sphere({0.5f, 0.5f, 0.3f}, 0.2f, 6, 8).sample(0.625f, 1.5f);
    expect_refusal<InvalidArgument>([&] { render(shell, ball_map(), view, settings(exact_traversal), job, &other); },
                                    {"0.625", "1.5", "sample"});
}

TEST(RenderInput, FinsThatDoNotExist)
{
    const Shell shell = flat_grid(1, 1, 1.0f, 1.0f).shell(0.5f);
    const View view = Camera(true, {0, 0, 2}, {0, 0, 0}, 0.5, {4, 4}).view();
    for (const int fins : {-1, 6, 1000}) {
        ShellParams params = settings(sdf_traversal);
        params.mode.z = fins;
        Job job;
        expect_refusal<InvalidArgument>([&] { render(shell, ball_map(), view, params, job); },
                                        {"fins", std::to_string(fins).c_str()});
    }
}

TEST(RenderInput, MapWithoutADistanceField)
{
    const Shell shell = flat_grid(1, 1, 1.0f, 1.0f).shell(0.5f);
    const View view = Camera(true, {0, 0, 2}, {0, 0, 0}, 0.5, {4, 4}).view();
    Map map = ball_map();  // a copy
    map.sdf.clear();
    map.sdf_nodes = glm::ivec3(0);
    for (const int traversal : {gdm_traversal, sdf_traversal}) {
        expect_refusal<InvalidArgument>([&] { render_with(shell, map, view, traversal); }, {"no distance field"});
    }
}

TEST(RenderInput, EmptyShellIsAnEmptyPicture)
{
    const View view = Camera(true, {0, 0, 2}, {0, 0, 0}, 0.5, {4, 4}).view();
    const Rendering picture = render_with(Shell{}, ball_map(), view, sdf_traversal);
    EXPECT_EQ(std::count(picture.hit.begin(), picture.hit.end(), 1), 0);
}

}  // namespace
}  // namespace mesoshell
