// mesoshell_native.closest_points
#include "arrays.h"
#include "mesoshell/attributes.h"
#include "run.h"

namespace mesoshell::python {
namespace {

PyObject* py_closest_points(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"sample", "resolution", "threads", "progress", nullptr};
        PyObject* sample = nullptr;
        PyObject* resolution = nullptr;
        PyObject* progress = nullptr;
        int threads = 0;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!|$OiO:closest_points", const_cast<char**>(names), state.sample_type,
                                         &sample, &resolution, &threads, &progress)) {
            return nullptr;
        }
        glm::ivec3 nodes(64, 64, 33);
        if (resolution != nullptr) {
            const std::vector<int> given = integers(state, resolution, "resolution", 3);
            nodes = glm::ivec3(given[0], given[1], given[2]);
        }
        const auto held = unbox<Sample>(sample);
        Job job(threads);
        SurfacePoints points = run(job, progress, [&] { return closest_points(*held, nodes, job); });
        Reference dict = checked(PyDict_New());
        set_item(dict.get(), "triangles", array_from(state, std::move(points.triangles), 'i', {nodes.z, nodes.y, nodes.x}));
        set_item(dict.get(), "weights", array_from(state, std::move(points.weights), 'f', {nodes.z, nodes.y, nodes.x, 2}));
        set_item(dict.get(), "outward", array_from(state, std::move(points.outward), 'f', {nodes.z, nodes.y, nodes.x, 3}));
        return dict.release();
    });
}

PyMethodDef functions[] = {
    {"closest_points", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_closest_points)),
     METH_VARARGS | METH_KEYWORDS,
     "closest_points(sample, *, resolution=(64, 64, 33), threads=0, progress=None)\n--\n\n"
     "For every node the nearest point of the mesh that the sample was made of, within the slab: a dict of arrays triangles "
     "int32 [nz, ny, nx], weights float32 [nz, ny, nx, 2] of its second and third corner, and outward float32 [nz, ny, nx, 3], "
     "the repaired surface's normals."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace

int add_attributes(PyObject* module)
{
    return PyModule_AddFunctions(module, functions);
}

}  // namespace mesoshell::python
