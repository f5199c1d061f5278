// mesoshell_native.seams and mesoshell_native.stretch: what a shell does to the pattern it carries.
#include "arrays.h"
#include "mesoshell/seams.h"
#include "mesoshell/stretch.h"
#include "run.h"
#include "shell_functions.h"

namespace mesoshell::python {
namespace {

PyObject* py_seams(PyObject* module, PyObject* args)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        PyObject* shell = nullptr;
        if (!PyArg_ParseTuple(args, "O!:seams", state.shell_type, &shell)) {
            return nullptr;
        }
        const std::shared_ptr<const Shell> held = unbox<Shell>(shell);
        Job job;
        Seams seams = run(job, nullptr, [&] { return find_seams(*held); });
        const auto count = static_cast<Py_ssize_t>(seams.edges.size());
        Reference result = checked(PyDict_New());
        set_item(result.get(), "edges", array_from(state, std::move(seams.edges), 'f', {count, 2, 3}));
        set_item(result.get(), "tops", array_from(state, std::move(seams.tops), 'f', {count, 2, 3}));
        set_item(result.get(), "count", PyLong_FromSsize_t(count));
        return result.release();
    });
}

PyObject* py_stretch(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"shell", "aspect", "height", "threads", "progress", nullptr};
        PyObject *shell = nullptr, *progress = Py_None;
        Proportions proportions;
        int threads = 0;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!|$ddiO:stretch", const_cast<char**>(names), state.shell_type,
                                         &shell, &proportions.aspect, &proportions.height, &threads, &progress)) {
            return nullptr;
        }
        const std::shared_ptr<const Shell> held = unbox<Shell>(shell);
        Job job(threads);
        Stretch found = run(job, progress, [&] { return stretch(*held, proportions, job); });
        const auto count = static_cast<Py_ssize_t>(found.rms.size());
        Reference result = checked(PyDict_New());
        set_item(result.get(), "rms", array_from(state, std::move(found.rms), 'f', {count}));
        set_item(result.get(), "angle", array_from(state, std::move(found.angle), 'f', {count}));
        set_item(result.get(), "total", PyFloat_FromDouble(found.total));
        set_item(result.get(), "infinite", PyLong_FromSize_t(found.infinite));
        set_item(result.get(), "aspect", PyFloat_FromDouble(found.proportions.aspect));
        set_item(result.get(), "height", PyFloat_FromDouble(found.proportions.height));
        return result.release();
    });
}

}  // namespace

PyMethodDef stretch_functions[] = {
    {"seams", py_seams, METH_VARARGS,
     "seams(shell)\n--\n\n"
     "Edges where the pattern does not continue, since UVs on both sides differ by other than whole tiles or are mirrored: "
     "a dict of edges [s, 2, 3] at the base, tops [s, 2, 3] and count."},
    {"stretch", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_stretch)), METH_VARARGS | METH_KEYWORDS,
     "stretch(shell, *, aspect=0.0, height=0.0, threads=0, progress=None)\n--\n\n"
     "A dict of rms [p] (1: no stretch), angle [p] between the texture axes in radians, total, infinite (prisms whose UVs have "
     "no area) and the aspect and height that were used, tile widths: those given or, where 0, those at which the total is "
     "least."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace mesoshell::python
