// mesoshell_native.Shell, build_shell
#include <optional>

#include "arrays.h"
#include "mesoshell/shell.h"
#include "run.h"

namespace mesoshell::python {
namespace {

const Shell& self_of(PyObject* self)
{
    return *unbox<Shell>(self);
}

PyObject* shell_prisms(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& shell = unbox<Shell>(self);
        return array_view(state_of(self), shell, shell->prisms.data(), 'f',
                          {static_cast<Py_ssize_t>(shell->prisms.size()), 8, 4});
    });
}

PyObject* shell_indices(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& shell = unbox<Shell>(self);
        return array_view(state_of(self), shell, shell->indices.data(), 'I',
                          {static_cast<Py_ssize_t>(shell->indices.size()), 24});
    });
}

PyObject* shell_bounds(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& shell = unbox<Shell>(self);
        return array_from(state_of(self), std::vector<glm::vec3>{shell->lower, shell->upper}, 'f', {2, 3});
    });
}

PyGetSetDef shell_attributes[] = {
    {"prisms", shell_prisms, nullptr, "float32 [p, 8, 4], the prism table", nullptr},
    {"indices", shell_indices, nullptr, "uint32 [p, 24], triangles of the hulls; vertex 6 p + corner", nullptr},
    {"prism_count", [](PyObject* self, void*) { return PyLong_FromSize_t(self_of(self).prisms.size()); }, nullptr,
     "number of prisms", nullptr},
    {"bounds", shell_bounds, nullptr, "float32 [2, 3], least and greatest coordinates, object space", nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr},
};

PyType_Slot shell_slots[] = {
    {Py_tp_doc, const_cast<char*>("The prisms over a surface.")},
    {Py_tp_dealloc, reinterpret_cast<void*>(dealloc_boxed<Shell>)},
    {Py_tp_getset, shell_attributes},
    {0, nullptr},
};

PyType_Spec shell_spec = {"mesoshell_native.Shell", sizeof(Boxed<Shell>), 0,
                          Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, shell_slots};

Scheme scheme_named(const std::string& name)
{
    if (name == "catmark") {
        return Scheme::catmark;
    }
    if (name == "loop") {
        return Scheme::loop;
    }
    if (name == "bilinear") {
        return Scheme::bilinear;
    }
    throw InvalidArgument("scheme '" + name + "' does not exist; choose 'catmark', 'loop' or 'bilinear'");
}

PyObject* py_build_shell(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"positions", "face_sizes", "corners", "uvs",     "thickness",
                                      "levels",    "scheme",     "normals", nullptr};
        PyObject* positions = nullptr;
        PyObject* face_sizes = nullptr;
        PyObject* corners = nullptr;
        PyObject* uvs = nullptr;
        double thickness = 0.0;
        int levels = 0;
        const char* scheme = "catmark";
        PyObject* normals = Py_None;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OOOO|$disO:build_shell", const_cast<char**>(names), &positions,
                                         &face_sizes, &corners, &uvs, &thickness, &levels, &scheme, &normals)) {
            return nullptr;
        }
        require_keywords(kwargs, {"thickness"});
        const ArrayArgument<float> position_array(state, positions, "positions", 3);
        const ArrayArgument<std::int32_t> size_array(state, face_sizes, "face_sizes", 0);
        const ArrayArgument<std::int32_t> corner_array(state, corners, "corners", 0);
        const ArrayArgument<float> uv_array(state, uvs, "uvs", 2);
        std::optional<ArrayArgument<float>> normal_array;
        Surface surface;
        surface.positions = position_array.rows<glm::vec3>();
        surface.face_sizes = size_array.values();
        surface.corners = corner_array.values();
        surface.uvs = uv_array.rows<glm::vec2>();
        if (normals != Py_None) {
            normal_array.emplace(state, normals, "normals", 3);
            surface.normals = normal_array->rows<glm::vec3>();
        }
        ShellOptions options;
        options.thickness = static_cast<float>(thickness);
        options.refinement.levels = levels;
        options.refinement.scheme = scheme_named(scheme);
        Job job;
        return box(state.shell_type, run(job, nullptr, [&] { return build_shell(surface, options, job); }));
    });
}

PyMethodDef functions[] = {
    {"build_shell", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_build_shell)),
     METH_VARARGS | METH_KEYWORDS,
     "build_shell(positions, face_sizes, corners, uvs, *, thickness, levels=0, scheme='catmark', normals=None)\n--\n\n"
     "Prisms over a polygon mesh: positions [n, 3], face_sizes [f], corners [c], uvs [c, 2] in tiles, thickness in object "
     "units. Raises ValueError, or Error for a mesh that cannot carry a shell."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace

int add_shell(PyObject* module)
{
    if (add_type(module, shell_spec, state_of_module(module).shell_type) != 0) {
        return -1;
    }
    return PyModule_AddFunctions(module, functions);
}

}  // namespace mesoshell::python
