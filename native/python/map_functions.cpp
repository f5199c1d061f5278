// mesoshell_native.compress, bake_map, plan_bake, measure, load
#include <algorithm>

#include "arrays.h"
#include "bake_arguments.h"
#include "map_choices.h"
#include "map_parts.h"
#include "mesoshell/compress.h"
#include "mesoshell/measure.h"
#include "mesoshell/store.h"
#include "run.h"

namespace mesoshell::python {
namespace {

// What compress and bake_map have in common.
struct CompressArguments {
    PyObject* sdf = Py_None;
    PyObject* facets = Py_None;
    PyObject* attributes = Py_None;
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
        static const char* names[] = {"gdm",    "sdf",       "facets",   "attributes", "terms", "max_rmse",
                                      "layout", "precision", "threads", "progress",   nullptr};
        PyObject* gdm = nullptr;
        CompressArguments arguments;
        int threads = 0;
        PyObject* progress = nullptr;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!|$OOOOOssiO:compress", const_cast<char**>(names), state.gdm_type, &gdm,
                                         &arguments.sdf, &arguments.facets, &arguments.attributes, &arguments.terms,
                                         &arguments.max_rmse, &arguments.layout, &arguments.precision, &threads, &progress)) {
            return nullptr;
        }
        const CompressOptions options = arguments.options();
        const auto held = unbox<Gdm>(gdm);
        const auto sdf = arguments.held_sdf(state);
        const MapParts parts(state, arguments.facets, arguments.attributes);
        Job job(threads);
        return box(state.map_type, run(job, progress, [&] {
            Map map = compress(*held, sdf.get(), options, job);
            parts.attach_to(map);
            return map;
        }));
    });
}

PyObject* py_bake_map(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"sample",   "resolution", "directions", "engine",  "sdf",      "facets", "attributes", "terms",
                                      "max_rmse", "layout",     "precision",  "memory",  "threads",  "progress", nullptr};
        PyObject* sample = nullptr;
        BakeArguments bake;
        CompressArguments arguments;
        double memory = 0.0;
        int threads = 0;
        PyObject* progress = nullptr;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!|$OOsOOOOOssdiO:bake_map", const_cast<char**>(names), state.sample_type,
                                         &sample, &bake.resolution, &bake.directions, &bake.engine, &arguments.sdf,
                                         &arguments.facets, &arguments.attributes, &arguments.terms, &arguments.max_rmse,
                                         &arguments.layout, &arguments.precision, &memory, &threads, &progress)) {
            return nullptr;
        }
        const GdmResolution resolution = bake.checked_resolution(state);
        const Engine engine = bake.checked_engine();
        const CompressOptions options = arguments.options();
        const auto held = unbox<Sample>(sample);
        const auto sdf = arguments.held_sdf(state);
        const MapParts parts(state, arguments.facets, arguments.attributes);
        const double limit = memory > 0.0 ? memory : default_memory();
        Job job(threads);
        return box(state.map_type, run(job, progress, [&] {
            Map map = bake_map(*held, resolution, engine, sdf.get(), options, limit, job);
            parts.attach_to(map);
            return map;
        }));
    });
}

PyObject* py_plan_bake(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"resolution", "directions", "terms", "layout", "precision", "memory", nullptr};
        BakeArguments bake;
        CompressArguments arguments;
        double memory = 0.0;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "|$OOOssd:plan_bake", const_cast<char**>(names), &bake.resolution,
                                         &bake.directions, &arguments.terms, &arguments.layout, &arguments.precision, &memory)) {
            return nullptr;
        }
        const GdmResolution resolution = bake.checked_resolution(state);
        const double limit = memory > 0.0 ? memory : default_memory();
        const BakePlan plan = plan_bake(resolution, arguments.options(), limit);
        const Reference layout = checked(name_of(layouts, plan.options.layout));
        return Py_BuildValue("{s:O,s:i,s:d,s:d,s:d,s:d,s:i}", "layout", layout.get(), "terms", plan.options.terms, "term_bytes",
                             term_bytes(resolution, plan.options), "limit", limit, "needed", plan.needed, "used", plan.used,
                             "blocks", plan.blocks);
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
     "compress(gdm, *, sdf=None, facets=None, attributes=None, terms=None, max_rmse=None, layout='auto', precision='byte', threads=0, "
     "progress=None)\n--\n\n"
     "A Map of the GDM's truncated SVD, the distance field, the facets and the attributes; max_rmse in tile widths picks the "
     "fewest terms."},
    {"bake_map", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_bake_map)), METH_VARARGS | METH_KEYWORDS,
     "bake_map(sample, *, resolution=(64, 64, 32), directions=(16, 32), engine='auto', sdf=None, facets=None, attributes=None, "
     "terms=None, max_rmse=None, layout='auto', precision='byte', memory=0, threads=0, progress=None)\n--\n\n"
     "bake_gdm and compress in at most `memory` bytes (0: a quarter of the machine's), the raw GDM streaming through in blocks of "
     "azimuths."},
    {"plan_bake", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_plan_bake)), METH_VARARGS | METH_KEYWORDS,
     "plan_bake(*, resolution=(64, 64, 32), directions=(16, 32), terms=None, layout='auto', precision='byte', memory=0)\n--\n\n"
     "What bake_map would do, a dict: layout, terms, term_bytes (before they are packed into a file), limit, needed, used (bytes of "
     "memory), blocks (0: the limit is too low; 1: the raw GDM is kept)."},
    {"measure", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_measure)), METH_VARARGS | METH_KEYWORDS,
     "measure(map, sample, *, rays='off_grid', count=100000, seed=1, threads=0, progress=None)\n--\n\n"
     "Error report of a map against Embree on its sample, over random rays: a dict of lengths in tile widths (rmse, median, "
     "percentile_95, percentile_99, largest) and shares of the rays (hits, false_hits, false_misses)."},
    {"load", py_load, METH_O, "load(path)\n--\n\nRead a map. Raises OSError, or Error for a file that is no map."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace

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

int add_map_functions(PyObject* module)
{
    return PyModule_AddFunctions(module, functions);
}

}  // namespace mesoshell::python
