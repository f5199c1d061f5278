// mesoshell_native.Gdm, Sdf, bake_gdm, bake_sdf
#include <unistd.h>

#include "arrays.h"
#include "bake_arguments.h"
#include "mesoshell/bake.h"
#include "mesoshell/libraries.h"
#include "run.h"

namespace mesoshell::python {
namespace {

template <typename Baked>
PyObject* get_height(PyObject* self, void*)
{
    return PyFloat_FromDouble(unbox<Baked>(self)->height);
}

template <typename Baked>
PyObject* get_aspect(PyObject* self, void*)
{
    return PyFloat_FromDouble(unbox<Baked>(self)->aspect);
}

PyObject* gdm_values(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& gdm = unbox<Gdm>(self);
        const GdmResolution& r = gdm->resolution;
        return array_view(state_of(self), gdm, gdm->values.data(), 'f',
                          {r.nphi, r.nodes.y, r.nodes.x, r.ntheta, r.nodes.z});
    });
}

PyObject* gdm_resolution(PyObject* self, void*)
{
    const glm::ivec3& nodes = unbox<Gdm>(self)->resolution.nodes;
    return Py_BuildValue("(iii)", nodes.x, nodes.y, nodes.z);
}

PyObject* gdm_directions(PyObject* self, void*)
{
    const GdmResolution& r = unbox<Gdm>(self)->resolution;
    return Py_BuildValue("(ii)", r.ntheta, r.nphi);
}

PyObject* gdm_ray_count(PyObject* self, void*)
{
    return PyLong_FromUnsignedLongLong(unbox<Gdm>(self)->ray_count);
}

PyGetSetDef gdm_attributes[] = {
    {"values", gdm_values, nullptr, "float32 [nphi, ny, nx, ntheta, nz], tile widths", nullptr},
    {"height", get_height<Gdm>, nullptr, "tile widths", nullptr},
    {"aspect", get_aspect<Gdm>, nullptr, "pv / pu", nullptr},
    {"resolution", gdm_resolution, nullptr, "(nx, ny, nz)", nullptr},
    {"directions", gdm_directions, nullptr, "(ntheta, nphi)", nullptr},
    {"ray_count", gdm_ray_count, nullptr, "rays cast", nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr},
};

PyType_Slot gdm_slots[] = {
    {Py_tp_doc, const_cast<char*>("A raw generalized displacement map.")},
    {Py_tp_dealloc, reinterpret_cast<void*>(dealloc_boxed<Gdm>)},
    {Py_tp_getset, gdm_attributes},
    {0, nullptr},
};

PyType_Spec gdm_spec = {"mesoshell_native.Gdm", sizeof(Boxed<Gdm>), 0,
                        Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, gdm_slots};

PyObject* sdf_values(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& sdf = unbox<Sdf>(self);
        return array_view(state_of(self), sdf, sdf->values.data(), 'f', {sdf->nodes.z, sdf->nodes.y, sdf->nodes.x});
    });
}

PyObject* sdf_resolution(PyObject* self, void*)
{
    const glm::ivec3& nodes = unbox<Sdf>(self)->nodes;
    return Py_BuildValue("(iii)", nodes.x, nodes.y, nodes.z);
}

PyGetSetDef sdf_attributes[] = {
    {"values", sdf_values, nullptr, "float32 [nz, ny, nx], tile widths, negative inside", nullptr},
    {"height", get_height<Sdf>, nullptr, "tile widths", nullptr},
    {"aspect", get_aspect<Sdf>, nullptr, "pv / pu", nullptr},
    {"resolution", sdf_resolution, nullptr, "(nx, ny, nz)", nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr},
};

PyType_Slot sdf_slots[] = {
    {Py_tp_doc, const_cast<char*>("A signed distance field of a tile.")},
    {Py_tp_dealloc, reinterpret_cast<void*>(dealloc_boxed<Sdf>)},
    {Py_tp_getset, sdf_attributes},
    {0, nullptr},
};

PyType_Spec sdf_spec = {"mesoshell_native.Sdf", sizeof(Boxed<Sdf>), 0,
                        Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, sdf_slots};

PyObject* py_bake_gdm(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"sample", "resolution", "directions", "engine", "threads", "progress", nullptr};
        PyObject* sample = nullptr;
        BakeArguments arguments;
        PyObject* progress = nullptr;
        int threads = 0;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!|$OOsiO:bake_gdm", const_cast<char**>(names), state.sample_type,
                                         &sample, &arguments.resolution, &arguments.directions, &arguments.engine, &threads,
                                         &progress)) {
            return nullptr;
        }
        const GdmResolution resolution = arguments.checked_resolution(state);
        const Engine engine = arguments.checked_engine();
        const auto held = unbox<Sample>(sample);
        Job job(threads);
        return box(state.gdm_type, run(job, progress, [&] { return bake_gdm(*held, resolution, engine, job); }));
    });
}

PyObject* py_bake_sdf(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"sample", "resolution", "threads", "progress", nullptr};
        PyObject* sample = nullptr;
        PyObject* resolution = nullptr;
        PyObject* progress = nullptr;
        int threads = 0;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!|$OiO:bake_sdf", const_cast<char**>(names), state.sample_type,
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
        return box(state.sdf_type, run(job, progress, [&] { return bake_sdf(*held, nodes, job); }));
    });
}

PyObject* py_instruction_set(PyObject*, PyObject*)
{
    return PyUnicode_FromString(instruction_set());
}

PyMethodDef functions[] = {
    {"bake_gdm", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_bake_gdm)), METH_VARARGS | METH_KEYWORDS,
     "bake_gdm(sample, *, resolution=(64, 64, 32), directions=(16, 32), engine=\"auto\", threads=0, progress=None)\n--\n\n"
     "The raw GDM of a sample; resolution (nx, ny, nz), directions (ntheta, nphi). Engines: \"embree\" casts rays, \"slices\" "
     "rasterizes triangles, \"auto\" takes the faster one for the number of triangles."},
    {"bake_sdf", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_bake_sdf)), METH_VARARGS | METH_KEYWORDS,
     "bake_sdf(sample, *, resolution=(64, 64, 33), threads=0, progress=None)\n--\n\n"
     "The signed distance field of a sample; resolution (nx, ny, nz)."},
    {"instruction_set", py_instruction_set, METH_NOARGS,
     "instruction_set()\n--\n\nThe instruction set that the inner loops of this processor use: \"avx2\" or \"baseline\" (any x86-64)."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace

GdmResolution BakeArguments::checked_resolution(ModuleState& state) const
{
    GdmResolution wanted;
    if (resolution != nullptr) {
        const std::vector<int> nodes = integers(state, resolution, "resolution", 3);
        wanted.nodes = glm::ivec3(nodes[0], nodes[1], nodes[2]);
    }
    if (directions != nullptr) {
        const std::vector<int> angles = integers(state, directions, "directions", 2);
        wanted.ntheta = angles[0];
        wanted.nphi = angles[1];
    }
    return wanted;
}

Engine BakeArguments::checked_engine() const
{
    for (const auto& [known, choice] : {std::pair("auto", Engine::automatic), {"embree", Engine::embree}, {"slices", Engine::slices}}) {
        if (std::string(engine) == known) {
            return choice;
        }
    }
    throw InvalidArgument("engine is '" + std::string(engine) + "'; give auto, embree or slices");
}

double default_memory()
{
    return 0.25 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

int add_bake(PyObject* module)
{
    ModuleState& state = state_of_module(module);
    if (add_type(module, gdm_spec, state.gdm_type) != 0 || add_type(module, sdf_spec, state.sdf_type) != 0) {
        return -1;
    }
    return PyModule_AddFunctions(module, functions);
}

}  // namespace mesoshell::python
