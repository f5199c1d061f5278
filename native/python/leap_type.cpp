// mesoshell_native.Leaps, bake_leaps
#include "arrays.h"
#include "mesoshell/leaps.h"
#include "run.h"

namespace mesoshell::python {
namespace {

const Leaps& self_of(PyObject* self)
{
    return *unbox<Leaps>(self);
}

PyObject* leaps_values(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& leaps = unbox<Leaps>(self);
        const glm::ivec3& cells = leaps->cells;
        return array_view(state_of(self), leaps, leaps->values.data(), 'B',
                          {leaps->directions * leaps->directions, cells.z, cells.y, cells.x});
    });
}

PyObject* leaps_cells(PyObject* self, void*)
{
    const glm::ivec3& cells = self_of(self).cells;
    return Py_BuildValue("(iii)", cells.x, cells.y, cells.z);
}

PyObject* leaps_lookup(PyObject* self, PyObject* args)
{
    return guarded(state_of(self), [&]() -> PyObject* {
        PyObject* positions = nullptr;
        PyObject* directions = nullptr;
        if (!PyArg_ParseTuple(args, "OO:lookup", &positions, &directions)) {
            return nullptr;
        }
        const ArrayArgument<float> pos(state_of(self), positions, "pos_texture", 3);
        const ArrayArgument<float> dir(state_of(self), directions, "dir_metric", 3);
        const auto leaps = unbox<Leaps>(self);
        Job job;
        std::vector<float> lengths =
            run(job, nullptr, [&] { return leap_lengths(*leaps, pos.rows<glm::vec3>(), dir.rows<glm::vec3>()); });
        const auto count = static_cast<Py_ssize_t>(lengths.size());
        return array_from(state_of(self), std::move(lengths), 'f', {count});
    });
}

PyGetSetDef leaps_attributes[] = {
    {"values", leaps_values, nullptr, "uint8 [directions ** 2, cz, cy, cx], in units", nullptr},
    {"unit", [](PyObject*, void*) { return PyFloat_FromDouble(leap_unit); }, nullptr, "tile widths", nullptr},
    {"height", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).height); }, nullptr, "tile widths",
     nullptr},
    {"aspect", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).aspect); }, nullptr, "pv / pu", nullptr},
    {"cells", leaps_cells, nullptr, "(cx, cy, cz)", nullptr},
    {"directions", [](PyObject* self, void*) { return PyLong_FromLong(self_of(self).directions); }, nullptr,
     "side of the octahedral map", nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr},
};

PyMethodDef leaps_methods[] = {
    {"lookup", leaps_lookup, METH_VARARGS,
     "lookup(pos_texture, dir_metric)\n--\n\nHow far rays may go: float32 [n], tile widths, from positions [n, 3] along "
     "directions [n, 3]: to the end of the cell, and as far as its bound from there."},
    {nullptr, nullptr, 0, nullptr},
};

PyType_Slot leaps_slots[] = {
    {Py_tp_doc, const_cast<char*>("How far every ray of a cell and a bin of directions goes freely, at least.")},
    {Py_tp_dealloc, reinterpret_cast<void*>(dealloc_boxed<Leaps>)},
    {Py_tp_getset, leaps_attributes},
    {Py_tp_methods, leaps_methods},
    {0, nullptr},
};

PyType_Spec leaps_spec = {"mesoshell_native.Leaps", sizeof(Boxed<Leaps>), 0,
                          Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, leaps_slots};

PyObject* py_bake_leaps(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"sample", "cells", "directions", "threads", "progress", nullptr};
        PyObject* sample = nullptr;
        PyObject* cells = nullptr;
        PyObject* progress = nullptr;
        LeapResolution resolution;
        int threads = 0;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!|$OiiO:bake_leaps", const_cast<char**>(names), state.sample_type,
                                         &sample, &cells, &resolution.directions, &threads, &progress)) {
            return nullptr;
        }
        if (cells != nullptr) {
            const std::vector<int> given = integers(state, cells, "cells", 3);
            resolution.cells = glm::ivec3(given[0], given[1], given[2]);
        }
        const auto held = unbox<Sample>(sample);
        Job job(threads);
        return box(state.leaps_type, run(job, progress, [&] { return bake_leaps(*held, resolution, job); }));
    });
}

PyMethodDef functions[] = {
    {"bake_leaps", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_bake_leaps)), METH_VARARGS | METH_KEYWORDS,
     "bake_leaps(sample, *, cells=(32, 32, 16), directions=8, threads=0, progress=None)\n--\n\n"
     "The leap table of a sample; cells (cx, cy, cz), directions the even side of the octahedral map."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace

int add_leaps(PyObject* module)
{
    if (add_type(module, leaps_spec, state_of_module(module).leaps_type) != 0) {
        return -1;
    }
    return PyModule_AddFunctions(module, functions);
}

}  // namespace mesoshell::python
