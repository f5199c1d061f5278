// mesoshell_native.Facets, bake_facets
#include "arrays.h"
#include "mesoshell/facets.h"
#include "run.h"

namespace mesoshell::python {
namespace {

const Facets& self_of(PyObject* self)
{
    return *unbox<Facets>(self);
}

PyObject* facets_texels(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& facets = unbox<Facets>(self);
        return array_view(state_of(self), facets, facets->texels.data(), 'f',
                          {facets->depth(), facets->cells.y, facets->cells.x, 4});
    });
}

PyObject* facets_cells(PyObject* self, void*)
{
    const glm::ivec3& cells = self_of(self).cells;
    return Py_BuildValue("(iii)", cells.x, cells.y, cells.z);
}

PyGetSetDef facets_attributes[] = {
    {"texels", facets_texels, nullptr, "float32 [depth, cy, cx, 4], bits of shaders/lib/facets.glsl", nullptr},
    {"height", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).height); }, nullptr, "tile widths",
     nullptr},
    {"aspect", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).aspect); }, nullptr, "pv / pu", nullptr},
    {"cells", facets_cells, nullptr, "(cx, cy, cz)", nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr},
};

PyType_Slot facets_slots[] = {
    {Py_tp_doc, const_cast<char*>("Of each cell of a tile, the planes that bound the solid in it, or how far all is empty.")},
    {Py_tp_dealloc, reinterpret_cast<void*>(dealloc_boxed<Facets>)},
    {Py_tp_getset, facets_attributes},
    {0, nullptr},
};

PyType_Spec facets_spec = {"mesoshell_native.Facets", sizeof(Boxed<Facets>), 0,
                           Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, facets_slots};

PyObject* py_bake_facets(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"sample", "cells", "boxes", "threads", "progress", nullptr};
        PyObject* sample = nullptr;
        PyObject* progress = nullptr;
        int cells = 64;
        int boxes = 1;
        int threads = 0;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!|$ipiO:bake_facets", const_cast<char**>(names), state.sample_type,
                                         &sample, &cells, &boxes, &threads, &progress)) {
            return nullptr;
        }
        const auto held = unbox<Sample>(sample);
        Job job(threads);
        return box(state.facets_type, run(job, progress, [&] { return bake_facets(*held, cells, job, boxes != 0); }));
    });
}

PyMethodDef functions[] = {
    {"bake_facets", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_bake_facets)), METH_VARARGS | METH_KEYWORDS,
     "bake_facets(sample, *, cells=64, boxes=True, threads=0, progress=None)\n--\n\n"
     "The facets of a sample, which the traversal 'refined' reads; cells along u, and along v and w so many that they are "
     "nearly cubes. Without boxes an empty cell knows only of itself, and rays go from cell to cell."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace

int add_facets(PyObject* module)
{
    if (add_type(module, facets_spec, state_of_module(module).facets_type) != 0) {
        return -1;
    }
    return PyModule_AddFunctions(module, functions);
}

}  // namespace mesoshell::python
