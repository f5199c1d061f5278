// mesoshell_native.Map, compress, load
#include <algorithm>

#include "arrays.h"
#include "map_parts.h"
#include "mesoshell/compress.h"
#include "mesoshell/render.h"
#include "mesoshell/store.h"
#include "run.h"

namespace mesoshell::python {
namespace {

const Map& self_of(PyObject* self)
{
    return *unbox<Map>(self);
}

PyObject* map_weights(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& map = unbox<Map>(self);
        const GdmResolution& r = map->resolution;
        return array_view(state_of(self), map, map->weights.data(), 'f', {map->terms, r.nphi, r.nodes.y, r.nodes.x});
    });
}

PyObject* map_eigenmaps(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& map = unbox<Map>(self);
        return array_view(state_of(self), map, map->eigenmaps.data(), 'f',
                          {map->terms, map->resolution.ntheta, map->resolution.nodes.z});
    });
}

PyObject* map_sdf(PyObject* self, void*)
{
    return guarded(state_of(self), [&]() -> PyObject* {
        const auto& map = unbox<Map>(self);
        if (map->sdf.empty()) {
            Py_RETURN_NONE;
        }
        const glm::ivec3& nodes = map->sdf_nodes;
        return array_view(state_of(self), map, map->sdf.data(), 'f', {nodes.z, nodes.y, nodes.x});
    });
}

PyObject* map_resolution(PyObject* self, void*)
{
    const glm::ivec3& nodes = self_of(self).resolution.nodes;
    return Py_BuildValue("(iii)", nodes.x, nodes.y, nodes.z);
}

PyObject* map_directions(PyObject* self, void*)
{
    return Py_BuildValue("(ii)", self_of(self).resolution.ntheta, self_of(self).resolution.nphi);
}

PyGetSetDef map_getters[] = {
    {"weights", map_weights, nullptr, "float32 [terms, nphi, ny, nx]", nullptr},
    {"eigenmaps", map_eigenmaps, nullptr, "float32 [terms, ntheta, nz]", nullptr},
    {"sdf", map_sdf, nullptr, "float32 [mz, my, mx], tile widths, negative inside; or None", nullptr},
    {"leaps", map_leaps, nullptr, "uint8 [directions ** 2, cz, cy, cx], in leap units; or None", nullptr},
    {"leap_unit", [](PyObject*, void*) { return PyFloat_FromDouble(leap_unit); }, nullptr, "tile widths", nullptr},
    {"attributes", map_attributes, nullptr,
     "dict of float32 [nz, ny, nx, channels]: color (linear), surface (roughness, metallic), normal; or None", nullptr},
    {"height", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).height); }, nullptr, "tile widths", nullptr},
    {"aspect", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).aspect); }, nullptr, "pv / pu", nullptr},
    {"terms", [](PyObject* self, void*) { return PyLong_FromLong(self_of(self).terms); }, nullptr, "SVD terms", nullptr},
    {"rmse", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).rmse); }, nullptr,
     "error of the stored terms over the grid, tile widths", nullptr},
    {"max_error", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).max_error); }, nullptr,
     "largest error of the stored terms over the grid, tile widths", nullptr},
    {"resolution", map_resolution, nullptr, "(nx, ny, nz)", nullptr},
    {"directions", map_directions, nullptr, "(ntheta, nphi)", nullptr},
    {"precision",
     [](PyObject* self, void*) {
         return PyUnicode_FromString(self_of(self).precision == Precision::half ? "half" : "float");
     },
     nullptr, "\"half\" or \"float\"", nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr},
};

// The file system's own spelling of a path argument; throws PythonError.
std::string path_argument(PyObject* object)
{
    PyObject* bytes = nullptr;
    if (!PyUnicode_FSConverter(object, &bytes)) {
        throw PythonError();
    }
    const Reference owned(bytes);
    return PyBytes_AsString(bytes);
}

PyObject* map_save(PyObject* self, PyObject* path)
{
    return guarded(state_of(self), [&]() -> PyObject* {
        const std::string target = path_argument(path);
        const auto map = unbox<Map>(self);
        Job job;
        run(job, nullptr, [&] {
            save_map(*map, target);
            return true;
        });
        Py_RETURN_NONE;
    });
}

PyObject* map_lookup(PyObject* self, PyObject* args)
{
    return guarded(state_of(self), [&]() -> PyObject* {
        PyObject* positions = nullptr;
        PyObject* directions = nullptr;
        if (!PyArg_ParseTuple(args, "OO:lookup", &positions, &directions)) {
            return nullptr;
        }
        const ArrayArgument<float> pos(state_of(self), positions, "pos_texture", 3);
        const ArrayArgument<float> dir(state_of(self), directions, "dir_metric", 3);
        const auto map = unbox<Map>(self);
        Job job;
        std::vector<float> distances =
            run(job, nullptr, [&] { return lookup_gdm(*map, pos.rows<glm::vec3>(), dir.rows<glm::vec3>()); });
        const auto count = static_cast<Py_ssize_t>(distances.size());
        return array_from(state_of(self), std::move(distances), 'f', {count});
    });
}

PyObject* map_sample_sdf(PyObject* self, PyObject* positions)
{
    return guarded(state_of(self), [&] {
        const ArrayArgument<float> pos(state_of(self), positions, "pos_texture", 3);
        const auto map = unbox<Map>(self);
        Job job;
        std::vector<float> distances = run(job, nullptr, [&] { return lookup_sdf(*map, pos.rows<glm::vec3>()); });
        const auto count = static_cast<Py_ssize_t>(distances.size());
        return array_from(state_of(self), std::move(distances), 'f', {count});
    });
}

PyMethodDef map_methods[] = {
    {"save", map_save, METH_O, "save(path)\n--\n\nWrite an OpenEXR file; what was there stays until it is whole. Raises OSError."},
    {"lookup", map_lookup, METH_VARARGS,
     "lookup(pos_texture, dir_metric)\n--\n\nThe shader text's GDM lookup: float32 [n], tile widths, of positions [n, 3] and "
     "directions [n, 3]."},
    {"sample_sdf", map_sample_sdf, METH_O,
     "sample_sdf(pos_texture)\n--\n\nThe shader text's SDF lookup: float32 [n], tile widths, of positions [n, 3]."},
    {nullptr, nullptr, 0, nullptr},
};

PyType_Slot map_slots[] = {
    {Py_tp_doc, const_cast<char*>("A baked tile: the GDM's SVD terms, its distance field, its leap table and its surface's attributes.")},
    {Py_tp_dealloc, reinterpret_cast<void*>(dealloc_boxed<Map>)},
    {Py_tp_getset, map_getters},
    {Py_tp_methods, map_methods},
    {0, nullptr},
};

PyType_Spec map_spec = {"mesoshell_native.Map", sizeof(Boxed<Map>), 0,
                        Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, map_slots};

PyObject* py_compress(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"gdm",     "sdf",      "terms", "max_rmse",   "layout", "precision",
                                      "threads", "progress", "leaps", "attributes", nullptr};
        PyObject* gdm = nullptr;
        PyObject* sdf = Py_None;
        PyObject* terms = Py_None;
        PyObject* max_rmse = Py_None;
        const char* layout = "paper";
        const char* precision = "half";
        int threads = 0;
        PyObject* progress = nullptr;
        PyObject* leaps = Py_None;
        PyObject* attributes = Py_None;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!|$OOOssiOOO:compress", const_cast<char**>(names), state.gdm_type,
                                         &gdm, &sdf, &terms, &max_rmse, &layout, &precision, &threads, &progress, &leaps,
                                         &attributes)) {
            return nullptr;
        }
        if (std::string(layout) != "paper") {
            throw InvalidArgument("layout '" + std::string(layout) + "' does not exist; choose 'paper'");
        }
        CompressOptions options;
        if (std::string(precision) == "float") {
            options.precision = Precision::single;
        } else if (std::string(precision) != "half") {
            throw InvalidArgument("precision '" + std::string(precision) + "' does not exist; choose 'half' or 'float'");
        }
        if (sdf != Py_None && Py_TYPE(sdf) != state.sdf_type) {
            throw InvalidArgument("sdf is no Sdf; pass what bake_sdf returned");
        }
        if (terms != Py_None && max_rmse != Py_None) {
            throw InvalidArgument("terms and max_rmse are both given; choose one");
        }
        if (terms != Py_None) {
            const long wanted = PyLong_AsLong(terms);
            options.terms = static_cast<int>(std::clamp(wanted, -1L, 1L << 30));
        }
        if (max_rmse != Py_None) {
            options.max_rmse = static_cast<float>(PyFloat_AsDouble(max_rmse));
        }
        if (PyErr_Occurred() != nullptr) {
            throw PythonError();
        }
        if (max_rmse != Py_None && !(options.max_rmse > 0.0f)) {
            throw InvalidArgument("max_rmse is " + std::to_string(options.max_rmse) + "; give a positive number of tile widths");
        }
        const auto held = unbox<Gdm>(gdm);
        const std::shared_ptr<const Sdf> held_sdf = sdf == Py_None ? nullptr : unbox<Sdf>(sdf);
        const MapParts parts(state, leaps, attributes);
        Job job(threads);
        return box(state.map_type, run(job, progress, [&] {
            Map map = compress(*held, held_sdf.get(), options, job);
            parts.attach_to(map);
            return map;
        }));
    });
}

PyObject* py_load(PyObject* module, PyObject* path)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&] {
        const std::string source = path_argument(path);
        Job job;
        return box(state.map_type, run(job, nullptr, [&] { return load_map(source); }));
    });
}

PyMethodDef functions[] = {
    {"compress", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_compress)), METH_VARARGS | METH_KEYWORDS,
     "compress(gdm, *, sdf=None, terms=16, max_rmse=None, layout='paper', precision='half', threads=0, progress=None, "
     "leaps=None, attributes=None)\n--\n\n"
     "A Map of the GDM's truncated SVD, the distance field, the leap table and the attributes; max_rmse in tile widths picks "
     "the fewest terms."},
    {"load", py_load, METH_O, "load(path)\n--\n\nRead a map. Raises OSError, or Error for a file that is no map."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace

int add_map(PyObject* module)
{
    if (add_type(module, map_spec, state_of_module(module).map_type) != 0) {
        return -1;
    }
    return PyModule_AddFunctions(module, functions);
}

}  // namespace mesoshell::python
