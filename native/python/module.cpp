// mesoshell_native: the module's definition and state. Limited API 3.11, so that one binary serves every later Python.
#include <cstring>

#include "arrays.h"
#include "mesoshell/libraries.h"

#ifndef MESOSHELL_VERSION
#error "the build defines MESOSHELL_VERSION"
#endif

namespace mesoshell::python {

int add_type(PyObject* module, PyType_Spec& spec, PyTypeObject*& slot)
{
    slot = reinterpret_cast<PyTypeObject*>(PyType_FromModuleAndSpec(module, &spec, nullptr));
    return slot == nullptr ? -1 : PyModule_AddType(module, slot);
}

namespace {

PyObject* py_libraries(PyObject* module, PyObject*)
{
    return guarded(state_of_module(module), [&] {
        Reference result = checked(PyDict_New());
        for (const auto& [name, path] : loaded_libraries()) {
            set_item(result.get(), name.c_str(), PyUnicode_DecodeFSDefault(path.c_str()));
        }
        return result.release();
    });
}

PyObject* py_embree_version(PyObject* module, PyObject*)
{
    return guarded(state_of_module(module), [&] { return PyUnicode_FromString(embree_version().c_str()); });
}

PyMethodDef functions[] = {
    {"embree_version", py_embree_version, METH_NOARGS, "embree_version()\n--\n\nVersion of the Embree in use."},
    {"libraries", py_libraries, METH_NOARGS,
     "libraries()\n--\n\nName to path of the shared library that one of its functions, as this module calls it, lies in."},
    {nullptr, nullptr, 0, nullptr},
};

int add_exception(PyObject* module, const char* full_name, const char* doc, PyObject* base, PyObject*& slot)
{
    slot = PyErr_NewExceptionWithDoc(full_name, doc, base, nullptr);
    return slot == nullptr ? -1 : PyModule_AddObjectRef(module, std::strrchr(full_name, '.') + 1, slot);
}

int execute(PyObject* module)
{
    ModuleState& state = state_of_module(module);
    if (add_exception(module, "mesoshell_native.Error", "A file that is no map, or a mesh that cannot carry a shell.", nullptr,
                      state.error) != 0 ||
        add_exception(module, "mesoshell_native.Cancelled", "The progress callback answered false.", state.error,
                      state.cancelled) != 0 ||
        add_arrays(module) != 0 || add_sample(module) != 0 || add_bake(module) != 0 || add_facets(module) != 0 ||
        add_map(module) != 0 || add_map_functions(module) != 0 || add_shell(module) != 0 || add_render(module) != 0 ||
        add_scene(module) != 0 || add_volume(module) != 0 || add_attributes(module) != 0 || add_folds(module) != 0 ||
        PyModule_AddFunctions(module, functions) != 0 ||
        PyModule_AddStringConstant(module, "__version__", MESOSHELL_VERSION) != 0) {
        return -1;
    }
    return 0;
}

int traverse(PyObject* module, visitproc visit, void* arg)
{
    const ModuleState& state = state_of_module(module);
    Py_VISIT(state.error);
    Py_VISIT(state.cancelled);
    Py_VISIT(state.numpy);
    for (PyTypeObject* type :
         {state.array_type, state.sample_type, state.gdm_type, state.sdf_type, state.facets_type, state.map_type,
          state.shell_type}) {
        Py_VISIT(type);
    }
    return 0;
}

int clear(PyObject* module)
{
    ModuleState& state = state_of_module(module);
    Py_CLEAR(state.error);
    Py_CLEAR(state.cancelled);
    Py_CLEAR(state.numpy);
    for (PyTypeObject** type :
         {&state.array_type, &state.sample_type, &state.gdm_type, &state.sdf_type, &state.facets_type, &state.map_type,
          &state.shell_type}) {
        Py_CLEAR(*type);
    }
    return 0;
}

void free_module(void* module)
{
    clear(static_cast<PyObject*>(module));
}

PyModuleDef_Slot module_slots[] = {
    {Py_mod_exec, reinterpret_cast<void*>(execute)},
    {0, nullptr},
};

PyModuleDef definition = {
    PyModuleDef_HEAD_INIT,
    "mesoshell_native",
    "Bakes, stores and renders volumetric mesostructure. Arrays in are anything numpy.asarray takes; arrays out are read-only "
    "views of native memory. Lengths in texture space are tile widths.",
    sizeof(ModuleState),
    nullptr,
    module_slots,
    traverse,
    clear,
    free_module,
};

}  // namespace
}  // namespace mesoshell::python

// What the loader calls as the module's init function.
extern "C" __attribute__((visibility("default"))) PyObject* mesoshell_module_init()
{
    return PyModuleDef_Init(&mesoshell::python::definition);
}
