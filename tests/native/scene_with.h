// What the tests of scenes share: their parts in a few words.
#pragma once

#include "camera.h"
#include "mesoshell/scene.h"
#include "meshes.h"
#include "render_with.h"

namespace mesoshell {

inline Film film_of(const Camera& camera, int samples = 1)
{
    const View view = camera.view();
    Film film;
    film.clip_from_world = view.clip_from_object;
    film.size = view.size;
    film.samples = samples;
    return film;
}

inline ScenePicture render_scene_with(const Scene& scene, const Film& film)
{
    Job job;
    return render_scene(scene, film, job);
}

inline SceneShell placed(const Shell& shell, const Map& map, const glm::dmat4& world_from_object = glm::dmat4(1.0))
{
    SceneShell placed;
    placed.shell = &shell;
    placed.map = &map;
    placed.world_from_object = world_from_object;
    return placed;
}

inline SceneMesh placed(const Mesh& mesh)
{
    SceneMesh placed;
    placed.positions = mesh.positions;
    placed.triangles = mesh.triangles;
    return placed;
}

inline SceneLight sun(const glm::dvec3& direction, float strength, bool cast_shadow = true)
{
    SceneLight light;
    light.direction = direction;
    light.color = glm::vec3(strength);
    light.cast_shadow = cast_shadow;
    return light;
}

// The rectangle between two corners of the plane z = height, facing up.
inline Mesh level_rectangle(const glm::vec2& low, const glm::vec2& high, float height)
{
    return {{{low.x, low.y, height}, {high.x, low.y, height}, {high.x, high.y, height}, {low.x, high.y, height}},
            {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace mesoshell
