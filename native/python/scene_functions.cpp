// mesoshell_native.render_scene
#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

#include "arrays.h"
#include "mesoshell/scene.h"
#include "run.h"
#include "scene_arguments.h"

namespace mesoshell::python {
namespace {

// Finished tiles on their way from the threads that work to the one that waits.
class TileQueue {
public:
    void add(SceneTile tile)
    {
        const std::lock_guard guard(lock_);
        tiles_.push_back(std::move(tile));
    }

    // Calls on_tile(x, y, w, h, color) for each; false with a Python error set where that raised. Needs the GIL.
    bool hand_over(ModuleState& state, PyObject* on_tile)
    {
        std::vector<SceneTile> tiles;
        {
            const std::lock_guard guard(lock_);
            tiles.swap(tiles_);
        }
        for (SceneTile& tile : tiles) {
            const glm::ivec2 first = tile.first;
            const glm::ivec2 size = tile.size;
            const Reference color(array_from(state, std::move(tile.color), 'f', {size.y, size.x, 4}));
            const Reference answer(PyObject_CallFunction(on_tile, "iiiiO", first.x, first.y, size.x, size.y, color.get()));
            if (answer.get() == nullptr) {
                return false;
            }
        }
        return true;
    }

private:
    std::mutex lock_;
    std::vector<SceneTile> tiles_;
};

PyObject* picture_dict(ModuleState& state, ScenePicture picture)
{
    const Py_ssize_t w = picture.size.x;
    const Py_ssize_t h = picture.size.y;
    Reference result = checked(PyDict_New());
    set_item(result.get(), "color", array_from(state, std::move(picture.color), 'f', {h, w, 4}));
    set_item(result.get(), "depth", array_from(state, std::move(picture.depth), 'f', {h, w}));
    set_item(result.get(), "normal", array_from(state, std::move(picture.normal), 'f', {h, w, 3}));
    set_item(result.get(), "index", array_from(state, std::move(picture.index), 'i', {h, w}));
    set_item(result.get(), "fetches", array_from(state, std::move(picture.fetches), 'i', {h, w}));
    return result.release();
}

PyObject* py_render_scene(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"clip_from_world", "size",    "shells",      "meshes",       "lights",
                                      "world",           "samples", "seed",        "transparent",  "filter_width",
                                      "threads",         "progress", "on_tile",    nullptr};
        PyObject *clip_from_world = nullptr, *size = nullptr, *shells = nullptr, *meshes = nullptr, *lights = nullptr;
        PyObject *world = Py_None, *progress = Py_None, *on_tile = Py_None;
        Film film;
        int transparent = 0;
        int threads = 0;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "|$OOOOOOiIpfiOO:render_scene", const_cast<char**>(names),
                                         &clip_from_world, &size, &shells, &meshes, &lights, &world, &film.samples,
                                         &film.seed, &transparent, &film.filter_width, &threads, &progress, &on_tile)) {
            return nullptr;
        }
        require_keywords(kwargs, {"clip_from_world", "size"});
        film.clip_from_world = matrix(state, clip_from_world, "clip_from_world");
        const std::vector<int> pixels = integers(state, size, "size", 2);
        film.size = glm::ivec2(pixels[0], pixels[1]);
        film.transparent = transparent != 0;
        SceneArguments arguments(state);
        if (shells != nullptr) {
            arguments.add_shells(shells);
        }
        if (meshes != nullptr) {
            arguments.add_meshes(meshes);
        }
        if (lights != nullptr) {
            arguments.add_lights(lights);
        }
        arguments.set_world(world);
        Job job(threads);
        if (on_tile == Py_None) {
            return picture_dict(state, run(job, progress, [&] { return render_scene(arguments.scene(), film, job); }));
        }
        TileQueue queue;
        const auto tile_done = [&](SceneTile tile) { queue.add(std::move(tile)); };
        return picture_dict(state, run(job, progress, [&] { return render_scene(arguments.scene(), film, job, tile_done); },
                                       [&] { return queue.hand_over(state, on_tile); }));
    });
}

PyMethodDef functions[] = {
    {"render_scene", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_render_scene)),
     METH_VARARGS | METH_KEYWORDS,
     "render_scene(*, clip_from_world, size, shells=(), meshes=(), lights=(), world=None, samples=1, seed=0, "
     "transparent=False, "
     "filter_width=1.5, threads=0, progress=None, on_tile=None)\n--\n\n"
     "A picture of a whole scene on the CPU, as a dict of arrays [h, w, ...]: color (linear, premultiplied alpha), depth "
     "(along the "
     "view axis, 1e10 for nothing), normal (world), index (object_index, -1 for nothing) and fetches; row 0 is the "
     "bottom.\n\n"
     "shells: dicts of shell, map, world_from_object; sample, traversal='refined', settings, base_color, object_index=0, "
     "visible_camera=True, visible_shadow=True.\n"
     "meshes: dicts of positions [n, 3] in world space, triangles [m, 3]; normals [n, 3] or [3 m, 3], base_color or colors "
     "[m, 3], "
     "object_index, visible_camera, visible_shadow.\n"
     "lights: dicts of type 'SUN', 'POINT', 'SPOT' or 'AREA', position, direction, color (times energy: W/m2 of a sun, W "
     "of "
     "others), radius, angle, spot_size, spot_blend, spot_cosine, shape 'SQUARE', 'RECTANGLE', 'DISK' or 'ELLIPSE', size "
     "(x, y), "
     "axes [2, 3], cast_shadow=True.\n"
     "world: a dict of color, or of image [h, w, 3], equirectangular, row 0 at the bottom.\n"
     "on_tile(x, y, w, h, color) gets finished parts on the calling thread. Raises ValueError."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace

int add_scene(PyObject* module)
{
    return PyModule_AddFunctions(module, functions);
}

}  // namespace mesoshell::python
