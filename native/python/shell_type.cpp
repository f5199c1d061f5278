// mesoshell_native.Shell

#include "arrays.h"
#include "mesoshell/shell.h"
#include "shell_functions.h"

namespace mesoshell::python {
namespace {

const Shell& self_of(PyObject* self)
{
    return *unbox<Shell>(self);
}

// A getter's view of rows that the shell holds.
template <typename Vector>
PyObject* rows(PyObject* self, const Vector& values, char format, std::vector<Py_ssize_t> axes)
{
    return guarded(state_of(self), [&] {
        axes.insert(axes.begin(), static_cast<Py_ssize_t>(values.size()));
        return array_view(state_of(self), unbox<Shell>(self), values.data(), format, std::move(axes));
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
    {"prisms", [](PyObject* self, void*) { return rows(self, self_of(self).prisms, 'f', {8, 4}); }, nullptr,
     "float32 [p, 8, 4], the prism table", nullptr},
    {"indices", [](PyObject* self, void*) { return rows(self, self_of(self).indices, 'I', {24}); }, nullptr,
     "uint32 [p, 24], triangles of the hulls; vertex 6 p + corner", nullptr},
    {"prism_count", [](PyObject* self, void*) { return PyLong_FromSize_t(self_of(self).prisms.size()); }, nullptr,
     "number of prisms", nullptr},
    {"bounds", shell_bounds, nullptr, "float32 [2, 3], least and greatest coordinates, object space", nullptr},
    {"positions", [](PyObject* self, void*) { return rows(self, self_of(self).positions, 'f', {3}); }, nullptr,
     "float32 [n, 3], vertices on the surface, object space", nullptr},
    {"directors", [](PyObject* self, void*) { return rows(self, self_of(self).directors, 'f', {3}); }, nullptr,
     "float32 [n, 3], one a vertex, unit length; zero where no prism has it", nullptr},
    {"tangents", [](PyObject* self, void*) { return rows(self, self_of(self).tangents, 'f', {2, 3}); }, nullptr,
     "float32 [n, 2, 3], two directions in the limit surface's tangent plane, of any length; [0, 2, 3] at level 0", nullptr},
    {"thickness", [](PyObject* self, void*) { return rows(self, self_of(self).thickness, 'f', {}); }, nullptr,
     "float32 [n], one a vertex, object units", nullptr},
    {"triangles", [](PyObject* self, void*) { return rows(self, self_of(self).topology->triangles, 'I', {3}); }, nullptr,
     "uint32 [p, 3], the vertices of each prism", nullptr},
    {"uv_triangles", [](PyObject* self, void*) { return rows(self, self_of(self).topology->uv_triangles, 'I', {3}); }, nullptr,
     "uint32 [p, 3], the rows of uvs at each prism's vertices", nullptr},
    {"uvs", [](PyObject* self, void*) { return rows(self, self_of(self).topology->uvs, 'f', {2}); }, nullptr,
     "float32 [m, 2], tiles, at the base", nullptr},
    {"top_uvs",
     [](PyObject* self, void*) {
         const Shell& shell = self_of(self);
         return rows(self, shell.top_uvs.empty() ? shell.topology->uvs : shell.top_uvs, 'f', {2});
     },
     nullptr, "float32 [m, 2], tiles, at the top", nullptr},
    {"faces", [](PyObject* self, void*) { return rows(self, self_of(self).topology->faces, 'i', {}); }, nullptr,
     "int32 [p], the face of the surface that each prism is over", nullptr},
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

}  // namespace

int add_shell(PyObject* module)
{
    if (add_type(module, shell_spec, state_of_module(module).shell_type) != 0) {
        return -1;
    }
    return PyModule_AddFunctions(module, shell_functions) != 0 ? -1 : PyModule_AddFunctions(module, stretch_functions);
}

}  // namespace mesoshell::python
