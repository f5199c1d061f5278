// What render_scene refuses, and by which words.
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <vector>

#include "check.h"
#include "scene_with.h"

namespace mesoshell {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

const Map& ball_map()
{
    static const Map map = sdf_map(sphere({0.5f, 0.5f, 0.25f}, 0.2f, 8, 12).sample(0.5f), {8, 8, 5});
    return map;
}

const Shell& shell()
{
    static const Shell shell = flat_grid(1, 1, 1.0f, 1.0f).shell(0.5f);
    return shell;
}

const Mesh& mesh()
{
    static const Mesh mesh = level_rectangle({0, 0}, {1, 1}, 0.0f);
    return mesh;
}

Film small_film()
{
    return film_of(Camera(true, {0, 0, 2}, {0, 0, 0}, 0.5, {4, 4}));
}

// A good scene of three shells and three meshes, spoiled.
void refuses(const std::function<void(Scene&, Film&)>& spoil, std::initializer_list<const char*> words)
{
    Scene scene;
    scene.shells.assign(3, placed(shell(), ball_map()));
    scene.meshes.assign(3, placed(mesh()));
    scene.lights.assign(3, SceneLight{});
    Film film = small_film();
    Job job;
    ASSERT_NO_THROW(render_scene(scene, film, job));
    spoil(scene, film);
    expect_refusal<InvalidArgument>([&] { render_scene(scene, film, job); }, words);
}

TEST(SceneInput, Films)
{
    refuses([](Scene&, Film& film) { film.clip_from_world[2] = glm::dvec4(0.0); }, {"clip_from_world", "inverted"});
    refuses([](Scene&, Film& film) { film.clip_from_world[1][1] = nan; }, {"clip_from_world"});
    refuses([](Scene&, Film& film) { film.size = glm::ivec2(4, 0); }, {"4 by 0", "pixels"});
    refuses([](Scene&, Film& film) { film.samples = 0; }, {"samples is 0", "1 to 65536"});
    refuses([](Scene&, Film& film) { film.samples = 65537; }, {"samples is 65537"});
    refuses([](Scene&, Film& film) { film.filter_width = nan; }, {"filter_width", "0 to 16"});
    refuses([](Scene&, Film& film) { film.filter_width = -1.0f; }, {"filter_width"});
}

TEST(SceneInput, Shells)
{
    refuses([](Scene& scene, Film&) { scene.shells[2].shell = nullptr; }, {"shells[2]", "lacks"});
    refuses([](Scene& scene, Film&) { scene.shells[1].world_from_object[0] = glm::dvec4(0.0); },
            {"shells[1]", "world_from_object", "inverted"});
    refuses([](Scene& scene, Film&) { scene.shells[1].world_from_object[0][3] = 0.1; }, {"shells[1]", "last row"});
    refuses([](Scene& scene, Film&) { scene.shells[0].base_color.y = -0.1f; }, {"shells[0]", "base_color"});
    refuses([](Scene& scene, Film&) { scene.shells[2].settings.mode.x = 1000; }, {"shells[2]", "traversal 1000"});
    refuses([](Scene& scene, Film&) { scene.shells[2].settings.mode.z = 7; }, {"shells[2]", "fins 7"});
    static const Map without;
    refuses([](Scene& scene, Film&) { scene.shells[1].map = &without; }, {"shells[1]", "no distance field"});
}

TEST(SceneInput, Meshes)
{
    static const std::vector<glm::vec3> bad_positions{{0, 0, 0}, {1, 0, 0}, {0, nan, 0}, {0, 0, 1}};
    static const std::vector<glm::uvec3> bad_triangles{{0, 1, 2}, {0, 1, 4}};
    static const std::vector<glm::vec3> five(5, glm::vec3(0.5f));
    static const std::vector<glm::vec3> negative(2, glm::vec3(-0.5f));
    refuses([](Scene& scene, Film&) { scene.meshes[1].positions = bad_positions; }, {"meshes[1]", "positions", "row 2"});
    refuses([](Scene& scene, Film&) { scene.meshes[2].triangles = bad_triangles; }, {"meshes[2]", "vertex 4 of 4"});
    refuses([](Scene& scene, Film&) { scene.meshes[0].normals = five; }, {"meshes[0]", "normals has 5", "4", "6"});
    refuses([](Scene& scene, Film&) { scene.meshes[0].normals = bad_positions; }, {"meshes[0]", "normals"});
    refuses([](Scene& scene, Film&) { scene.meshes[0].colors = five; }, {"meshes[0]", "colors has 5", "2"});
    refuses([](Scene& scene, Film&) { scene.meshes[0].colors = negative; }, {"meshes[0]", "colors"});
    refuses([](Scene& scene, Film&) { scene.meshes[0].base_color.x = nan; }, {"meshes[0]", "base_color"});
}

TEST(SceneInput, Lights)
{
    const auto light = [](const std::function<void(SceneLight&)>& spoil) {
        return [spoil](Scene& scene, Film&) { spoil(scene.lights[1]); };
    };
    refuses(light([](SceneLight& l) { l.color.z = nan; }), {"lights[1]", "color"});
    refuses(light([](SceneLight& l) { l.direction = glm::dvec3(0.0); }), {"lights[1]", "direction"});
    refuses(light([](SceneLight& l) { l.angle = 4.0f; }), {"lights[1]", "angle"});
    const auto of = [&](LightType type, const std::function<void(SceneLight&)>& spoil) {
        return light([type, spoil](SceneLight& l) {
            l.type = type;
            spoil(l);
        });
    };
    refuses(of(LightType::point, [](SceneLight& l) { l.position.x = nan; }), {"lights[1]", "position"});
    refuses(of(LightType::point, [](SceneLight& l) { l.radius = -1.0f; }), {"lights[1]", "radius"});
    refuses(of(LightType::spot, [](SceneLight& l) { l.spot_size = 3.2f; }), {"lights[1]", "spot_size"});
    refuses(of(LightType::spot, [](SceneLight& l) { l.spot_blend = 1.5f; }), {"lights[1]", "spot_blend"});
    refuses(of(LightType::area, [](SceneLight& l) { l.size.y = -1.0f; }), {"lights[1]", "size"});
    refuses(of(LightType::area, [](SceneLight& l) { l.axis_y = glm::dvec3(nan); }), {"lights[1]", "second", "axes"});
}

TEST(SceneInput, Worlds)
{
    static const std::vector<glm::vec3> image(6, glm::vec3(0.5f));
    static const std::vector<glm::vec3> bad(6, glm::vec3(nan));
    refuses([](Scene& scene, Film&) { scene.world.color.x = -1.0f; }, {"world", "color"});
    refuses([](Scene& scene, Film&) { scene.world.image = image; }, {"world", "image has 6 pixels"});
    const auto with = [](const std::vector<glm::vec3>& pixels, const glm::ivec2& size) {
        return [&pixels, size](Scene& scene, Film&) {
            scene.world.image = pixels;
            scene.world.image_size = size;
        };
    };
    refuses(with(image, {2, 2}), {"world", "image has 6 pixels; give 4"});
    refuses(with(bad, {3, 2}), {"world", "pixel"});
}

TEST(SceneInput, NothingAtAll)
{
    Film film = small_film();
    const ScenePicture picture = render_scene_with({}, film);
    for (int i = 0; i < 16; ++i) {
        EXPECT_EQ(picture.color[i], glm::vec4(0, 0, 0, 1));
        EXPECT_EQ(picture.depth[i], 1e10f);
        EXPECT_EQ(picture.index[i], -1);
        EXPECT_EQ(picture.normal[i], glm::vec3(0.0f));
    }
    film.transparent = true;
    EXPECT_EQ(render_scene_with({}, film).color[0], glm::vec4(0.0f));
}

TEST(SceneInput, WhatIsTooFarForSinglePrecisionIsNotSeen)
{
    // Embree's debug builds abort at rays from so far away.
    for (const double scale : {1e-30, 1e-20, 1e20, 1e30}) {
        Scene scene;
        scene.shells.push_back(placed(shell(), ball_map()));
        for (int i = 0; i < 3; ++i) {
            scene.shells[0].world_from_object[i] *= scale;
        }
        scene.shells[0].world_from_object[3] = glm::dvec4(0.0, 0.0, scale, 1.0);
        scene.meshes.push_back(placed(mesh()));
        scene.meshes[0].object_index = 1;
        SceneLight light;
        light.type = LightType::point;
        light.position = glm::dvec3(0.0, 0.0, 1e30);
        scene.lights = {light, SceneLight{}};
        const ScenePicture picture = render_scene_with(scene, small_film());
        for (int i = 0; i < 16; ++i) {
            const bool floor = i % 4 >= 2 && i / 4 >= 2;
            ASSERT_EQ(picture.index[i], floor ? 1 : -1) << scale;
            ASSERT_TRUE(std::isfinite(picture.color[i].r));
        }
    }
}

TEST(SceneInput, DegenerateMeshesAreNotSeen)
{
    const Mesh nothing{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}, {1, 1, 1}}};
    Scene scene;
    scene.meshes.push_back(placed(nothing));
    scene.meshes.emplace_back();
    for (const std::int32_t index : render_scene_with(scene, small_film()).index) {
        EXPECT_EQ(index, -1);
    }
}

}  // namespace
}  // namespace mesoshell
