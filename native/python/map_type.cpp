// mesoshell_native.Map, compress, load
#include <algorithm>

#include "arrays.h"
#include "bake_arguments.h"
#include "mesoshell/compress.h"
#include "mesoshell/measure.h"
#include "mesoshell/render.h"
#include "mesoshell/store.h"
#include "run.h"

namespace mesoshell::python {
namespace {

template <typename Choice>
struct Named {
    const char* name;
    Choice choice;
};

constexpr Named<Precision> precisions[] = {{"byte", Precision::byte}, {"half", Precision::half}, {"float", Precision::single}};
constexpr Named<Layout> layouts[] = {{"paper", Layout::paper}, {"share", Layout::share}, {"nodes", Layout::nodes}, {"auto", Layout::automatic}};

template <typename Choice, std::size_t count>
PyObject* name_of(const Named<Choice> (&named)[count], Choice choice)
{
    const auto* found = std::find_if(named, named + count, [&](const auto& entry) { return entry.choice == choice; });
    return PyUnicode_FromString(found->name);
}

template <typename Choice, std::size_t count>
Choice choice_of(const Named<Choice> (&named)[count], const std::string& what, const std::string& name)
{
    const auto* found = std::find_if(named, named + count, [&](const auto& entry) { return entry.name == name; });
    if (found == named + count) {
        std::string known;
        for (std::size_t i = 0; i < count; ++i) {
            known += std::string(i == 0 ? "" : i + 1 == count ? " or " : ", ") + named[i].name;
        }
        throw InvalidArgument(what + " '" + name + "' does not exist; choose " + known);
    }
    return found->choice;
}

const Map& self_of(PyObject* self)
{
    return *unbox<Map>(self);
}

PyObject* map_weights(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& map = unbox<Map>(self);
        const glm::ivec3& nodes = map->resolution.nodes;
        return array_view(state_of(self), map, map->weights.data(), 'f', {map->terms, map->weight_azimuths(), nodes.y, nodes.x});
    });
}

PyObject* map_eigenmaps(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& map = unbox<Map>(self);
        return array_view(state_of(self), map, map->eigenmaps.data(), 'f',
                          {map->terms, map->eigen_azimuths(), map->resolution.ntheta, map->resolution.nodes.z});
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

PyGetSetDef map_attributes[] = {
    {"weights", map_weights, nullptr, "float32 [terms, nphi or 1, ny, nx]", nullptr},
    {"eigenmaps", map_eigenmaps, nullptr, "float32 [terms, 1 or nphi, ntheta, nz]", nullptr},
    {"sdf", map_sdf, nullptr, "float32 [mz, my, mx], tile widths, negative inside; or None", nullptr},
    {"height", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).height); }, nullptr, "tile widths", nullptr},
    {"aspect", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).aspect); }, nullptr, "pv / pu", nullptr},
    {"terms", [](PyObject* self, void*) { return PyLong_FromLong(self_of(self).terms); }, nullptr, "SVD terms", nullptr},
    {"rmse", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).rmse); }, nullptr,
     "error of the stored terms over the grid, tile widths", nullptr},
    {"max_error", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).max_error); }, nullptr,
     "largest error of the stored terms over the grid, tile widths", nullptr},
    {"resolution", map_resolution, nullptr, "(nx, ny, nz)", nullptr},
    {"directions", map_directions, nullptr, "(ntheta, nphi)", nullptr},
    {"precision", [](PyObject* self, void*) { return name_of(precisions, self_of(self).precision); }, nullptr,
     "\"byte\", \"half\" or \"float\"", nullptr},
    {"layout", [](PyObject* self, void*) { return name_of(layouts, self_of(self).layout); }, nullptr,
     "\"paper\", \"share\" or \"nodes\"", nullptr},
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
    {Py_tp_doc, const_cast<char*>("A baked tile: the GDM's SVD terms and its distance field.")},
    {Py_tp_dealloc, reinterpret_cast<void*>(dealloc_boxed<Map>)},
    {Py_tp_getset, map_attributes},
    {Py_tp_methods, map_methods},
    {0, nullptr},
};

PyType_Spec map_spec = {"mesoshell_native.Map", sizeof(Boxed<Map>), 0,
                        Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, map_slots};

// What compress and bake_map have in common.
struct CompressArguments {
    PyObject* sdf = Py_None;
    PyObject* terms = Py_None;
    PyObject* max_rmse = Py_None;
    const char* layout = "auto";
    const char* precision = "byte";

    CompressOptions options() const
    {
        CompressOptions options;
        options.layout = choice_of(layouts, "layout", layout);
        options.precision = choice_of(precisions, "precision", precision);
        if (terms != Py_None && max_rmse != Py_None) {
            throw InvalidArgument("terms and max_rmse are both given; choose one");
        }
        if (terms != Py_None) {
            const long wanted = PyLong_AsLong(terms);
            options.terms = static_cast<int>(std::clamp(wanted, -1L, 1L << 30));
            options.terms = wanted == 0 ? -1 : options.terms;  // a number of terms, not the default
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
        return options;
    }

    std::shared_ptr<const Sdf> held_sdf(const ModuleState& state) const
    {
        if (sdf != Py_None && Py_TYPE(sdf) != state.sdf_type) {
            throw InvalidArgument("sdf is no Sdf; pass what bake_sdf returned");
        }
        return sdf == Py_None ? nullptr : unbox<Sdf>(sdf);
    }
};

PyObject* py_compress(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"gdm",       "sdf",     "terms",    "max_rmse", "layout",
                                      "precision", "threads", "progress", nullptr};
        PyObject* gdm = nullptr;
        CompressArguments arguments;
        int threads = 0;
        PyObject* progress = nullptr;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!|$OOOssiO:compress", const_cast<char**>(names), state.gdm_type, &gdm,
                                         &arguments.sdf, &arguments.terms, &arguments.max_rmse, &arguments.layout,
                                         &arguments.precision, &threads, &progress)) {
            return nullptr;
        }
        const CompressOptions options = arguments.options();
        const auto held = unbox<Gdm>(gdm);
        const auto sdf = arguments.held_sdf(state);
        Job job(threads);
        return box(state.map_type, run(job, progress, [&] { return compress(*held, sdf.get(), options, job); }));
    });
}

PyObject* py_bake_map(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"sample", "resolution", "directions", "engine",  "sdf",      "terms", "max_rmse",
                                      "layout", "precision",  "memory",     "threads", "progress", nullptr};
        PyObject* sample = nullptr;
        BakeArguments bake;
        CompressArguments arguments;
        double memory = 0.0;
        int threads = 0;
        PyObject* progress = nullptr;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!|$OOsOOOssdiO:bake_map", const_cast<char**>(names), state.sample_type,
                                         &sample, &bake.resolution, &bake.directions, &bake.engine, &arguments.sdf,
                                         &arguments.terms, &arguments.max_rmse, &arguments.layout, &arguments.precision, &memory,
                                         &threads, &progress)) {
            return nullptr;
        }
        const GdmResolution resolution = bake.checked_resolution(state);
        const Engine engine = bake.checked_engine();
        const CompressOptions options = arguments.options();
        const auto held = unbox<Sample>(sample);
        const auto sdf = arguments.held_sdf(state);
        const double limit = memory > 0.0 ? memory : default_memory();
        Job job(threads);
        return box(state.map_type, run(job, progress, [&] {
            return bake_map(*held, resolution, engine, sdf.get(), options, limit, job);
        }));
    });
}

PyObject* py_term_bytes(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"resolution", "directions", "terms", "layout", "precision", nullptr};
        BakeArguments bake;
        CompressArguments arguments;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "|$OOOss:term_bytes", const_cast<char**>(names), &bake.resolution,
                                         &bake.directions, &arguments.terms, &arguments.layout, &arguments.precision)) {
            return nullptr;
        }
        const GdmResolution resolution = bake.checked_resolution(state);
        CompressOptions options = arguments.options();
        options.layout = options.layout == Layout::automatic ? Layout::nodes : options.layout;
        options.terms = options.terms == 0 ? default_terms(resolution, options.layout, options.precision) : options.terms;
        return Py_BuildValue("(di)", term_bytes(resolution, options), options.terms);
    });
}

PyObject* py_measure(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"map", "sample", "rays", "count", "seed", "threads", "progress", nullptr};
        PyObject* map = nullptr;
        PyObject* sample = nullptr;
        const char* rays = "off_grid";
        int count = 100000;
        unsigned int seed = 1;
        int threads = 0;
        PyObject* progress = nullptr;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!O!|$siIiO:measure", const_cast<char**>(names), state.map_type, &map,
                                         state.sample_type, &sample, &rays, &count, &seed, &threads, &progress)) {
            return nullptr;
        }
        constexpr Named<RaySet> sets[] = {{"on_grid", RaySet::on_grid}, {"off_grid", RaySet::off_grid}};
        const RaySet set = choice_of(sets, "rays", rays);
        const auto held_map = unbox<Map>(map);
        const auto held_sample = unbox<Sample>(sample);
        Job job(threads);
        const ErrorReport report =
            run(job, progress, [&] { return measure(*held_map, *held_sample, set, count, seed, job); });
        return Py_BuildValue("{s:L,s:d,s:d,s:d,s:d,s:d,s:d,s:d,s:d}", "rays", static_cast<long long>(report.rays), "rmse", report.rmse,
                             "median", report.median, "percentile_95", report.percentile_95, "percentile_99",
                             report.percentile_99, "largest", report.largest, "hits", report.hits, "false_hits",
                             report.false_hits, "false_misses", report.false_misses);
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
     "compress(gdm, *, sdf=None, terms=None, max_rmse=None, layout='auto', precision='byte', threads=0, progress=None)\n--\n\n"
     "A Map of the GDM's truncated SVD and the distance field; max_rmse in tile widths picks the fewest terms."},
    {"bake_map", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_bake_map)), METH_VARARGS | METH_KEYWORDS,
     "bake_map(sample, *, resolution=(64, 64, 32), directions=(16, 32), engine='auto', sdf=None, terms=None, max_rmse=None, "
     "layout='auto', precision='byte', memory=0, threads=0, progress=None)\n--\n\n"
     "bake_gdm and compress in at most `memory` bytes (0: a quarter of the machine's), the raw GDM streaming through in blocks of "
     "azimuths."},
    {"term_bytes", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_term_bytes)), METH_VARARGS | METH_KEYWORDS,
     "term_bytes(*, resolution=(64, 64, 32), directions=(16, 32), terms=None, layout='nodes', precision='byte')\n--\n\n"
     "(bytes of a map's terms before they are packed into a file, number of terms)."},
    {"measure", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_measure)), METH_VARARGS | METH_KEYWORDS,
     "measure(map, sample, *, rays='off_grid', count=100000, seed=1, threads=0, progress=None)\n--\n\n"
     "Error report of a map against Embree on its sample, over random rays: a dict of lengths in tile widths (rmse, median, "
     "percentile_95, percentile_99, largest) and shares of the rays (hits, false_hits, false_misses)."},
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
