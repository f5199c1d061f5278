// mesoshell_native.find_folds
#include "arrays.h"
#include "mesoshell/folds.h"
#include "run.h"

namespace mesoshell::python {
namespace {

PyObject* py_find_folds(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"shell", "threads", "progress", nullptr};
        PyObject* shell = nullptr;
        PyObject* progress = nullptr;
        int threads = 0;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!|$iO:find_folds", const_cast<char**>(names), state.shell_type,
                                         &shell, &threads, &progress)) {
            return nullptr;
        }
        const auto held = unbox<Shell>(shell);
        Job job(threads);
        Folds folds = run(job, progress, [&] { return find_folds(*held, job); });
        const auto prisms = static_cast<Py_ssize_t>(folds.inverted.size());
        const auto pairs = static_cast<Py_ssize_t>(folds.pairs.size());
        Reference dict = checked(PyDict_New());
        set_item(dict.get(), "inverted", array_from(state, std::move(folds.inverted), 'B', {prisms}));
        set_item(dict.get(), "intersecting", array_from(state, std::move(folds.intersecting), 'B', {prisms}));
        set_item(dict.get(), "base", array_from(state, std::move(folds.base), 'B', {prisms}));
        set_item(dict.get(), "pairs", array_from(state, std::move(folds.pairs), 'I', {pairs, 2}));
        return dict.release();
    });
}

PyMethodDef functions[] = {
    {"find_folds", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_find_folds)), METH_VARARGS | METH_KEYWORDS,
     "find_folds(shell, *, threads=0, progress=None)\n--\n\n"
     "Prisms that are turned inside out or overlap others: a dict of arrays, one a prism, inverted uint8 [p], intersecting "
     "uint8 [p], and base uint8 [p], 1 where the surface itself is folded or crosses itself, which no thickness mends; and "
     "pairs uint32 [k, 2], prisms that overlap. After repair only prisms marked in base overlap, and none is inverted."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace

int add_folds(PyObject* module)
{
    return PyModule_AddFunctions(module, functions);
}

}  // namespace mesoshell::python
