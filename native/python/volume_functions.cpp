// mesoshell_native.contour
#include <algorithm>
#include <climits>

#include "arrays.h"
#include "mesoshell/contour.h"
#include "run.h"

namespace mesoshell::python {
namespace {

PyObject* py_contour(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"values", "threshold", "height", "aspect", "threads", "progress", nullptr};
        PyObject* values = nullptr;
        PyObject* progress = nullptr;
        double threshold = 0.0;
        double height = 0.0;
        double aspect = 1.0;
        int threads = 0;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "Od|$ddiO:contour", const_cast<char**>(names), &values, &threshold,
                                         &height, &aspect, &threads, &progress)) {
            return nullptr;
        }
        require_keywords(kwargs, {"height"});
        const ArrayArgument<float> array(state, values, "values", Axes{3});
        glm::ivec3 nodes;
        for (int axis = 0; axis < 3; ++axis) {
            nodes[2 - axis] = static_cast<int>(std::min<Py_ssize_t>(array.shape()[axis], INT_MAX));
        }
        Job job(threads);
        Contour mesh = run(job, progress, [&] {
            return contour(array.values(), nodes, static_cast<float>(threshold), static_cast<float>(height),
                           static_cast<float>(aspect), job);
        });
        const auto vertices = static_cast<Py_ssize_t>(mesh.positions.size());
        const auto faces = static_cast<Py_ssize_t>(mesh.triangles.size());
        const Reference positions = checked(array_from(state, std::move(mesh.positions), 'f', {vertices, 3}));
        const Reference triangles = checked(array_from(state, std::move(mesh.triangles), 'i', {faces, 3}));
        return PyTuple_Pack(2, positions.get(), triangles.get());
    });
}

PyMethodDef functions[] = {
    {"contour", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_contour)), METH_VARARGS | METH_KEYWORDS,
     "contour(values, threshold, *, height, aspect=1.0, threads=0, progress=None)\n--\n\n"
     "(positions [n, 3], triangles [m, 3]) of the periodic solid where values [nz, ny, nx] are above the threshold, closed and "
     "capped at w = 0 and w = 1: a Sample's arguments. Raises ValueError."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace

int add_volume(PyObject* module)
{
    return PyModule_AddFunctions(module, functions);
}

}  // namespace mesoshell::python
