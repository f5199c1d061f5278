// mesoshell_native.render, realize, trace, eye, shell_params, TRAVERSALS
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "mesoshell/realize.h"
#include "mesoshell/render.h"
#include "mesoshell/traversal.h"
#include "render_arguments.h"
#include "run.h"

namespace mesoshell::python {

ShellParams params_argument(PyObject* object)
{
    ShellParams params;
    if (object == nullptr || object == Py_None) {
        return params;
    }
    Py_buffer view;
    if (PyObject_GetBuffer(object, &view, PyBUF_SIMPLE) != 0) {
        throw PythonError();
    }
    const Py_ssize_t given = view.len;
    if (given == static_cast<Py_ssize_t>(sizeof params)) {
        std::memcpy(&params, view.buf, sizeof params);
    }
    PyBuffer_Release(&view);
    if (given != static_cast<Py_ssize_t>(sizeof params)) {
        throw InvalidArgument("settings has " + std::to_string(given) + " bytes; give the " +
                              std::to_string(sizeof params) + " of the uniform block");
    }
    return params;
}

namespace {

View view_argument(ModuleState& state, PyObject* clip_from_object, PyObject* size)
{
    View view;
    view.clip_from_object = matrix(state, clip_from_object, "clip_from_object");
    const std::vector<int> pixels = integers(state, size, "size", 2);
    view.size = glm::ivec2(pixels[0], pixels[1]);
    return view;
}

PyObject* py_render(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"shell",    "map",     "clip_from_object", "size",
                                      "traversal", "settings", "sample",           "threads",  "progress", nullptr};
        PyObject* shell = nullptr;
        PyObject* map = nullptr;
        PyObject* clip_from_object = nullptr;
        PyObject* size = nullptr;
        const char* traversal = "refined";
        PyObject* settings = Py_None;
        PyObject* sample = Py_None;
        int threads = 0;
        PyObject* progress = nullptr;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!O!|$OOsOOiO:render", const_cast<char**>(names), state.shell_type,
                                         &shell, state.map_type, &map, &clip_from_object, &size, &traversal, &settings, &sample,
                                         &threads, &progress)) {
            return nullptr;
        }
        if (sample != Py_None && Py_TYPE(sample) != state.sample_type) {
            throw InvalidArgument("sample is no Sample; pass the tile that the map was baked from");
        }
        require_keywords(kwargs, {"clip_from_object", "size"});
        const View view = view_argument(state, clip_from_object, size);
        ShellParams params = params_argument(settings);
        params.mode.x = static_cast<int>(traversal_named(traversal));
        const auto held_shell = unbox<Shell>(shell);
        const auto held_map = unbox<Map>(map);
        const auto held_sample = sample == Py_None ? nullptr : unbox<Sample>(sample);
        Job job(threads);
        Rendering picture =
            run(job, progress, [&] { return render(*held_shell, *held_map, view, params, job, held_sample.get()); });
        const Py_ssize_t w = view.size.x;
        const Py_ssize_t h = view.size.y;
        Reference result = checked(PyDict_New());
        set_item(result.get(), "color", array_from(state, std::move(picture.color), 'f', {h, w, 4}));
        set_item(result.get(), "hit", array_from(state, std::move(picture.hit), 'B', {h, w}));
        set_item(result.get(), "distance", array_from(state, std::move(picture.distance), 'f', {h, w}));
        set_item(result.get(), "normal", array_from(state, std::move(picture.normal), 'f', {h, w, 3}));
        set_item(result.get(), "texture", array_from(state, std::move(picture.texture), 'f', {h, w, 3}));
        set_item(result.get(), "prism", array_from(state, std::move(picture.prism), 'i', {h, w}));
        set_item(result.get(), "fetches", array_from(state, std::move(picture.fetches), 'i', {h, w}));
        return result.release();
    });
}

PyObject* py_realize(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"shell", "sample", "error", "caps", "normals", "threads", "progress", nullptr};
        PyObject* shell = nullptr;
        PyObject* sample = nullptr;
        RealizeOptions options;
        int caps = options.caps ? 1 : 0;
        PyObject* normals = Py_None;
        int threads = 0;
        PyObject* progress = nullptr;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!O!|$fpOiO:realize", const_cast<char**>(names), state.shell_type,
                                         &shell, state.sample_type, &sample, &options.error, &caps, &normals, &threads,
                                         &progress)) {
            return nullptr;
        }
        options.caps = caps != 0;
        std::optional<ArrayArgument<float>> normal_array;
        if (normals != Py_None) {
            normal_array.emplace(state, normals, "normals", 3);
            options.normals = normal_array->rows<glm::vec3>();
        }
        const auto held_shell = unbox<Shell>(shell);
        const auto held_sample = unbox<Sample>(sample);
        Job job(threads);
        RealizedMesh mesh = run(job, progress, [&] { return realize(*held_shell, *held_sample, options, job); });
        const auto vertices = static_cast<Py_ssize_t>(mesh.positions.size());
        const auto triangles = static_cast<Py_ssize_t>(mesh.triangles.size());
        Reference result = checked(PyDict_New());
        set_item(result.get(), "positions", array_from(state, std::move(mesh.positions), 'f', {vertices, 3}));
        set_item(result.get(), "triangles", array_from(state, std::move(mesh.triangles), 'I', {triangles, 3}));
        set_item(result.get(), "texture", array_from(state, std::move(mesh.texture), 'f', {triangles, 3, 3}));
        set_item(result.get(), "weights", array_from(state, std::move(mesh.weights), 'f', {triangles, 3, 2}));
        if (normals != Py_None) {
            set_item(result.get(), "normals", array_from(state, std::move(mesh.normals), 'f', {triangles, 3, 3}));
        }
        set_item(result.get(), "source", array_from(state, std::move(mesh.source), 'I', {triangles}));
        set_item(result.get(), "prism", array_from(state, std::move(mesh.prism), 'I', {triangles}));
        set_item(result.get(), "open_edges", PyLong_FromSize_t(mesh.open_edges));
        return result.release();
    });
}

PyObject* py_trace(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"positions", "triangles", "clip_from_object", "size", "threads", "progress", nullptr};
        PyObject* positions = nullptr;
        PyObject* triangles = nullptr;
        PyObject* clip_from_object = nullptr;
        PyObject* size = nullptr;
        int threads = 0;
        PyObject* progress = nullptr;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OO|$OOiO:trace", const_cast<char**>(names), &positions, &triangles,
                                         &clip_from_object, &size, &threads, &progress)) {
            return nullptr;
        }
        require_keywords(kwargs, {"clip_from_object", "size"});
        const ArrayArgument<float> position_array(state, positions, "positions", 3);
        const ArrayArgument<std::int64_t> triangle_array(state, triangles, "triangles", 3);
        const View view = view_argument(state, clip_from_object, size);
        std::vector<glm::uvec3> corners;
        for (const glm::i64vec3& t : triangle_array.rows<glm::i64vec3>()) {
            // Out of range either way: trace says so.
            corners.emplace_back(glm::min(glm::u64vec3(t), glm::u64vec3(~0u)));
        }
        const auto points = position_array.rows<glm::vec3>();
        Job job(threads);
        Trace picture = run(job, progress, [&] { return trace(points, corners, view, job); });
        const Py_ssize_t w = view.size.x;
        const Py_ssize_t h = view.size.y;
        Reference result = checked(PyDict_New());
        set_item(result.get(), "hit", array_from(state, std::move(picture.hit), 'B', {h, w}));
        set_item(result.get(), "distance", array_from(state, std::move(picture.distance), 'f', {h, w}));
        set_item(result.get(), "normal", array_from(state, std::move(picture.normal), 'f', {h, w, 3}));
        return result.release();
    });
}

PyObject* py_eye(PyObject* module, PyObject* clip_from_object)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&] {
        const glm::dvec4 eye = eye_of(matrix(state, clip_from_object, "clip_from_object"));
        return Py_BuildValue("(dddd)", eye.x, eye.y, eye.z, eye.w);
    });
}

PyObject* py_shell_params(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"settings", "map", "clip_from_object", nullptr};
        PyObject* settings = nullptr;
        PyObject* map = nullptr;
        PyObject* clip_from_object = nullptr;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OO!O:shell_params", const_cast<char**>(names), &settings,
                                         state.map_type, &map, &clip_from_object)) {
            return nullptr;
        }
        const ShellParams params = complete_params(params_argument(settings), *unbox<Map>(map),
                                                   matrix(state, clip_from_object, "clip_from_object"));
        return PyBytes_FromStringAndSize(reinterpret_cast<const char*>(&params), sizeof params);
    });
}

PyObject* traversal_tuple()
{
    const std::vector<std::string> names = traversal_names();
    Reference tuple = checked(PyTuple_New(static_cast<Py_ssize_t>(names.size())));
    for (std::size_t i = 0; i < names.size(); ++i) {
        PyTuple_SetItem(tuple.get(), static_cast<Py_ssize_t>(i), checked(PyUnicode_FromString(names[i].c_str())).release());
    }
    return tuple.release();
}

PyMethodDef functions[] = {
    {"render", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_render)), METH_VARARGS | METH_KEYWORDS,
     "render(shell, map, *, clip_from_object, size, traversal='refined', settings=None, sample=None, threads=0, progress=None)\n--\n\n"
     "A picture by the shader text on the CPU, as a dict of arrays [h, w, ...]; row 0 is the bottom."},
    {"realize", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_realize)), METH_VARARGS | METH_KEYWORDS,
     "realize(shell, sample, *, error=0.001, caps=True, normals=None, threads=0, progress=None)\n--\n\n"
     "The sample's triangles warped into the shell: a dict of positions [n, 3], triangles [m, 3], texture [m, 3, 3], "
     "weights [m, 3, 2], source [m], prism [m], open_edges and, where the sample's corners are given some [3 * triangles, 3], "
     "normals [m, 3, 3]."},
    {"trace", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_trace)), METH_VARARGS | METH_KEYWORDS,
     "trace(positions, triangles, *, clip_from_object, size, threads=0, progress=None)\n--\n\n"
     "A picture of any triangle mesh by Embree: a dict of hit, distance and normal [h, w, ...]."},
    {"eye", py_eye, METH_O,
     "eye(clip_from_object)\n--\n\nThe center of projection: (x, y, z, 1), or minus the view direction and 0."},
    {"shell_params", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_shell_params)),
     METH_VARARGS | METH_KEYWORDS,
     "shell_params(settings, map, clip_from_object)\n--\n\n"
     "The uniform block's bytes with everything set that the map and the view determine."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace

int add_render(PyObject* module)
{
    // Null with a Python error set, which AddObjectRef then leaves as it is, if there is no memory.
    const Reference names(guarded(state_of_module(module), traversal_tuple));
    return PyModule_AddObjectRef(module, "TRAVERSALS", names.get()) != 0 ? -1 : PyModule_AddFunctions(module, functions);
}

}  // namespace mesoshell::python
