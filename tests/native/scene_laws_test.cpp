// Scenes against the renderer of one shell, closed forms and symmetries.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "check.h"
#include "scene_with.h"

namespace mesoshell {
namespace {

constexpr double pi = std::numbers::pi;

// A ball off the middle of its tile, and a shell over the unit square whose object space is texture space, one unit a tile.
constexpr glm::dvec3 ball_center(0.4, 0.55, 0.25);
constexpr double ball_radius = 0.2;

const Map& ball_map()
{
    static const Map map = sdf_map(sphere(glm::vec3(ball_center), ball_radius, 48, 64).sample(0.5f), {48, 48, 25});
    return map;
}

const Shell& square_shell()
{
    static const Shell shell = flat_grid(2, 2, 1.0f, 1.0f).shell(0.5f);
    return shell;
}

const Shell& torus_shell()
{
    static const Shell shell = torus(1.0f, 0.4f, 32, 24, 9.0f, 6.0f).shell(0.3f);
    return shell;
}

constexpr float slab_above = 0.35f;

// Everything between two heights: on a square a box, on a sphere a round layer.
const Map& slab_map()
{
    static const Map map = sdf_map(slab(0.15f, slab_above).sample(0.5f), {16, 16, 11});
    return map;
}

std::size_t at(const ScenePicture& picture, int x, int y)
{
    return static_cast<std::size_t>(y) * picture.size.x + x;
}

TEST(SceneLaws, OneShellLooksAsRenderDrawsIt)
{
    const glm::dvec3 shine(-0.3, 0.5, -0.9);
    ShellParams params = settings(sdf_traversal);
    params.base_color = glm::vec4(0.5f, 0.6f, 0.7f, 1.0f);
    params.light_world = glm::vec4(-glm::vec3(shine), 0.0f);
    params.light_color = glm::vec4(glm::vec3(3.0f / static_cast<float>(pi)), 0.0f);
    params.ambient_color = glm::vec4(0.1f, 0.2f, 0.3f, 0.0f);
    Scene scene;
    scene.shells.push_back(placed(torus_shell(), ball_map()));
    scene.shells[0].settings = params;
    scene.shells[0].base_color = glm::vec3(params.base_color);
    scene.shells[0].object_index = 7;
    scene.lights.push_back(sun(shine, 3.0f, false));
    scene.world.color = glm::vec3(params.ambient_color);
    for (const bool perspective : {true, false}) {
        const Camera camera(perspective, {1.5, -2.4, 2.2}, {0, 0, 0}, perspective ? 0.55 : 1.9, {80, 64});
        Film film = film_of(camera);
        film.transparent = true;
        const ScenePicture picture = render_scene_with(scene, film);
        Job job;
        const Rendering drawn = render(torus_shell(), ball_map(), camera.view(), params, job);
        EXPECT_GT(std::count(drawn.hit.begin(), drawn.hit.end(), 1), 600);
        for (std::size_t i = 0; i < drawn.hit.size(); ++i) {
            ASSERT_EQ(picture.index[i], drawn.hit[i] == 1 ? 7 : -1);
            ASSERT_LT(glm::length(picture.color[i] - drawn.color[i]), 1e-5f);
            ASSERT_LT(glm::length(picture.normal[i] - drawn.normal[i]), 1e-5f);
            const CameraRay ray = camera.ray(static_cast<int>(i) % 80, static_cast<int>(i) / 80);
            const double depth = drawn.hit[i] == 1 ? drawn.distance[i] * glm::dot(ray.dir, camera.forward()) : 1e10;
            ASSERT_NEAR(picture.depth[i], depth, 1e-5 * std::max(depth, 1.0));
            ASSERT_GE(picture.fetches[i], drawn.fetches[i] > 0 ? 1 : 0);
        }
    }
}

// Where a ray meets the ball behind a map of space; infinite where it misses.
double ball_entry(const CameraRay& ray, const glm::dmat4& world_from_object, double radius)
{
    const glm::dmat4 inverse = glm::inverse(world_from_object);
    const glm::dvec3 start = glm::dvec3(inverse * glm::dvec4(ray.origin, 1.0)) - ball_center;
    const glm::dvec3 dir = glm::dmat3(inverse) * ray.dir;
    const double a = glm::dot(dir, dir);
    const double b = glm::dot(start, dir);
    const double rest = b * b - a * (glm::dot(start, start) - radius * radius);
    return rest < 0.0 ? std::numeric_limits<double>::infinity() : (-b - std::sqrt(rest)) / a;
}

void check_ball(const glm::dmat4& world_from_object)
{
    Scene scene;
    scene.shells.push_back(placed(square_shell(), ball_map(), world_from_object));
    const glm::dvec3 target(world_from_object * glm::dvec4(ball_center, 1.0));
    // A voxel, where the transform is longest; sphere tracing ends a fiftieth of one early and the field is trilinear.
    const double longest = std::max({glm::length(world_from_object[0]), glm::length(world_from_object[1]),
                                     glm::length(world_from_object[2])});
    for (const bool perspective : {true, false}) {
        const Camera camera(perspective, target + glm::dvec3(0.6, -1.0, 2.0) * longest, target,
                            perspective ? 0.2 : 0.4 * longest, {64, 64});
        const ScenePicture picture = render_scene_with(scene, film_of(camera));
        int hits = 0;
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                const CameraRay ray = camera.ray(x, y);
                const double t = ball_entry(ray, world_from_object, ball_radius - 0.01);
                if (std::isinf(t)) {
                    ASSERT_TRUE(picture.index[at(picture, x, y)] == -1 ||
                                std::isfinite(ball_entry(ray, world_from_object, ball_radius + 0.002)));
                    continue;
                }
                hits += 1;
                const glm::dvec3 place = ray.origin + ray.dir * ball_entry(ray, world_from_object, ball_radius);
                const glm::dvec3 out =
                    glm::dvec3(glm::inverse(world_from_object) * glm::dvec4(place, 1.0)) - ball_center;
                const glm::dvec3 normal = glm::normalize(glm::transpose(glm::inverse(glm::dmat3(world_from_object))) * out);
                ASSERT_EQ(picture.index[at(picture, x, y)], 0);
                ASSERT_NEAR(picture.depth[at(picture, x, y)],
                            glm::dot(place - ray.origin, camera.forward()),
                            0.25 * longest / 48.0 / std::max(-glm::dot(normal, ray.dir), 0.2));
                ASSERT_GT(glm::dot(glm::dvec3(picture.normal[at(picture, x, y)]), normal), 0.99);
            }
        }
        EXPECT_GT(hits, 150);
    }
}

TEST(SceneLaws, UnevenScalesTurnsAndMirrors)
{
    check_ball(glm::dmat4(1.0));
    const glm::dmat4 turned = glm::rotate(glm::translate(glm::dmat4(1.0), {3.0, -2.0, 1.0}), 0.7, {0.3, 0.2, 0.9});
    check_ball(glm::scale(turned, {2.0, 0.5, 1.5}));
    check_ball(glm::scale(turned, {-1.0, 1.0, 1.0}));
    check_ball(glm::scale(turned, {-6.0, 4.0, -8.0}));
    glm::dmat4 sheared = glm::scale(turned, glm::dvec3(0.1));
    sheared[1] += sheared[0] * 0.5;
    check_ball(sheared);
}

TEST(SceneLaws, NegativeScaleShowsTheMirrorImage)
{
    Scene scene;
    scene.shells.push_back(placed(torus_shell(), ball_map()));
    scene.lights.push_back(sun({0.5, 0.3, -0.8}, 2.0f));
    Scene mirrored = scene;
    mirrored.shells[0].world_from_object = glm::scale(glm::dmat4(1.0), {-1.0, 1.0, 1.0});
    mirrored.lights[0].direction.x *= -1.0;
    const Camera camera(true, {0.0, -2.4, 1.6}, {0, 0, 0}, 0.55, {64, 48});
    const ScenePicture a = render_scene_with(scene, film_of(camera));
    const ScenePicture b = render_scene_with(mirrored, film_of(camera));
    int hits = 0;
    int differing = 0;
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64; ++x) {
            const std::size_t here = at(a, x, y);
            const std::size_t there = at(a, 63 - x, y);
            hits += a.index[here] == 0 ? 1 : 0;
            // Roundings differ, and decide at outlines.
            differing += std::abs(a.depth[here] - b.depth[there]) > 1e-3f ||
                                 glm::length(a.color[here] - b.color[there]) > 1e-2f ||
                                 glm::length(a.normal[here] - b.normal[there] * glm::vec3(-1, 1, 1)) > 1e-2f
                             ? 1
                             : 0;
        }
    }
    EXPECT_GT(hits, 600);
    EXPECT_LE(differing, 10);
}

TEST(SceneLaws, WhiteFurnaceStaysWhite)
{
    const Mesh ball = sphere({0.2f, -1.0f, 0.5f}, 0.3f, 12, 16);
    Scene scene;
    scene.shells.push_back(placed(torus_shell(), ball_map()));
    scene.shells[0].base_color = glm::vec3(1.0f);
    scene.meshes.push_back(placed(ball));
    scene.meshes[0].base_color = glm::vec3(1.0f);
    scene.world.color = glm::vec3(0.7f, 0.8f, 0.9f);
    const Film film = film_of(Camera(true, {1.5, -2.4, 2.2}, {0, 0, 0}, 0.55, {48, 40}), 4);
    for (const glm::vec4& color : render_scene_with(scene, film).color) {
        ASSERT_LT(glm::length(color - glm::vec4(scene.world.color, 1.0f)), 1e-5f);
    }
    // The same sky as an image.
    const std::vector<glm::vec3> image(3, scene.world.color);
    scene.world.image = image;
    scene.world.image_size = glm::ivec2(3, 1);
    for (const glm::vec4& color : render_scene_with(scene, film).color) {
        ASSERT_LT(glm::length(color - glm::vec4(scene.world.color, 1.0f)), 1e-3f);
    }
}

TEST(SceneLaws, ShellsHideOneAnotherByDepth)
{
    // Two boxes across one another and a mesh between: what is nearest along the ray is seen.
    Scene scene;
    const glm::dmat4 other = glm::translate(glm::dmat4(1.0), {0.3, 0.25, 0.5});
    scene.shells.push_back(placed(square_shell(), slab_map()));
    scene.shells.push_back(placed(square_shell(), slab_map(), other));
    scene.shells[1].object_index = 1;
    const Mesh between = level_rectangle({0.6f, -1.0f}, {2.0f, 2.0f}, 0.5f);
    scene.meshes.push_back(placed(between));
    scene.meshes[0].object_index = 2;
    const auto box = [](const CameraRay& ray, const glm::dvec3& low, const glm::dvec3& high) {
        const glm::dvec3 a = (low - ray.origin) / ray.dir;
        const glm::dvec3 b = (high - ray.origin) / ray.dir;
        const glm::dvec3 enter = glm::min(a, b);
        const glm::dvec3 leave = glm::max(a, b);
        const double in = std::max({enter.x, enter.y, enter.z});
        return in < std::min({leave.x, leave.y, leave.z}) ? in : std::numeric_limits<double>::infinity();
    };
    const glm::dvec3 low(0.0, 0.0, 0.15);
    const glm::dvec3 high(1.0, 1.0, slab_above);
    for (const glm::dvec3& eye : {glm::dvec3(0.6, 0.7, 4.0), glm::dvec3(0.7, 0.6, -3.0), glm::dvec3(-2.0, -1.5, 0.9)}) {
        const Camera camera(true, eye, {0.65, 0.6, 0.5}, 0.35, {64, 64});
        const ScenePicture picture = render_scene_with(scene, film_of(camera));
        int seen[4] = {};
        int doubtful = 0;
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                const CameraRay ray = camera.ray(x, y);
                const auto expected = [&](double grown) {
                    const glm::dvec3 margin(grown);
                    const glm::dvec3 lift(other[3]);
                    double ends[3] = {box(ray, low - margin, high + margin),
                                      box(ray, low + lift - margin, high + lift + margin),
                                      (0.5 - ray.origin.z) / ray.dir.z};
                    const glm::dvec3 place = ray.origin + ray.dir * ends[2];
                    if (ends[2] < 0.0 || place.x < 0.6 - grown || place.y < -1.0 || place.x > 2.0 || place.y > 2.0) {
                        ends[2] = std::numeric_limits<double>::infinity();
                    }
                    const double* nearest = std::min_element(ends, ends + 3);
                    return std::isinf(*nearest) ? -1 : static_cast<int>(nearest - ends);
                };
                // Sphere tracing ends a fiftieth of a voxel before the surface: outlines are that wide.
                if (expected(2e-3) != expected(-2e-3)) {
                    doubtful += 1;
                    continue;
                }
                ASSERT_EQ(picture.index[at(picture, x, y)], expected(0.0)) << x << " " << y;
                seen[expected(0.0) + 1] += 1;
            }
        }
        EXPECT_GT(*std::min_element(seen + 1, seen + 4), 20);
        EXPECT_LT(doubtful, 200);
    }
}

TEST(SceneLaws, ClipPlanesCutMeshesAndShells)
{
    const Mesh floor = level_rectangle({-5.0f, -5.0f}, {6.0f, 6.0f}, -1.0f);
    const Mesh beyond = level_rectangle({-50.0f, -50.0f}, {60.0f, 60.0f}, 2.0f - 51.0f);
    const Mesh before = level_rectangle({-5.0f, -5.0f}, {6.0f, 6.0f}, 2.0f - 0.04f);
    Scene scene;
    scene.shells.push_back(placed(square_shell(), slab_map()));
    for (const bool perspective : {true, false}) {
        const Film film = film_of(Camera(perspective, {0.5, 0.5, 2.0}, {0.5, 0.5, 0.0}, 0.1, {4, 4}));
        const double start = perspective ? 0.0 : Camera::near;
        scene.meshes = {placed(floor), placed(before)};
        scene.meshes[0].object_index = 1;
        for (const float depth : render_scene_with(scene, film).depth) {
            ASSERT_NEAR(depth, 2.0 - slab_above - start, 2e-3);
        }
        Scene empty;
        empty.meshes = {placed(beyond), placed(before)};
        for (const std::int32_t index : render_scene_with(empty, film).index) {
            ASSERT_EQ(index, -1);
        }
        // The eye in the slab's solid sees it from the near plane on.
        const Film inside = film_of(Camera(perspective, {0.5, 0.5, 0.45}, {0.5, 0.5, 0.0}, 0.1, {4, 4}));
        for (const float depth : render_scene_with(scene, inside).depth) {
            ASSERT_NEAR(depth, 0.45 - slab_above - start, 2e-3);
        }
    }
}

TEST(SceneLaws, ThreadsChangeNoBitAndSeedsDo)
{
    const Mesh ball = sphere({0.2f, -1.0f, 0.5f}, 0.3f, 12, 16);
    Scene scene;
    scene.shells.push_back(placed(torus_shell(), ball_map()));
    scene.meshes.push_back(placed(ball));
    scene.lights.push_back(sun({0.5, 0.3, -0.8}, 2.0f));
    scene.lights[0].angle = 0.2f;
    scene.world.color = glm::vec3(0.1f);
    Film film = film_of(Camera(true, {1.5, -2.4, 2.2}, {0, 0, 0}, 0.55, {70, 50}), 3);
    Job one(1);
    Job four(4);
    const ScenePicture a = render_scene(scene, film, one);
    const ScenePicture b = render_scene(scene, film, four);
    EXPECT_EQ(a.color, b.color);
    EXPECT_EQ(a.depth, b.depth);
    EXPECT_EQ(a.fetches, b.fetches);
    film.seed = 1;
    EXPECT_NE(render_scene_with(scene, film).color, a.color);
    EXPECT_EQ(render_scene_with(scene, film).depth, a.depth);
}

TEST(SceneLaws, TilesMakeThePicture)
{
    const Mesh ball = sphere({0.0f, 0.0f, 0.0f}, 1.0f, 12, 16);
    Scene scene;
    scene.meshes.push_back(placed(ball));
    scene.world.color = glm::vec3(0.25f, 0.5f, 0.75f);
    const Film film = film_of(Camera(true, {1.5, -2.4, 2.2}, {0, 0, 0}, 0.4, {70, 33}));
    Job job(1);
    std::vector<glm::vec4> whole(70 * 33, glm::vec4(-1.0f));
    const ScenePicture picture = render_scene(scene, film, job, [&](const SceneTile& tile) {
        for (int i = 0; i < tile.size.x * tile.size.y; ++i) {
            whole[(tile.first.y + i / tile.size.x) * 70 + tile.first.x + i % tile.size.x] = tile.color[i];
        }
    });
    EXPECT_EQ(whole, picture.color);
}

}  // namespace
}  // namespace mesoshell
