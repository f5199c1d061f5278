// What the module owns: its types and exceptions, and how a C++ value becomes a Python object.
#pragma once

#include <Python.h>

#include <memory>
#include <new>

namespace mesoshell::python {

struct ModuleState {
    PyObject* error;      // mesoshell_native.Error
    PyObject* cancelled;  // mesoshell_native.Cancelled
    PyObject* numpy;      // the module, imported on first use
    PyTypeObject* array_type;
    PyTypeObject* sample_type;
    PyTypeObject* gdm_type;
    PyTypeObject* sdf_type;
    PyTypeObject* facets_type;
    PyTypeObject* map_type;
    PyTypeObject* shell_type;
};

inline ModuleState& state_of_module(PyObject* module)
{
    return *static_cast<ModuleState*>(PyModule_GetState(module));
}

inline ModuleState& state_of(PyObject* self)
{
    return *static_cast<ModuleState*>(PyType_GetModuleState(Py_TYPE(self)));
}

// A Python object that shares ownership of an immutable C++ value.
template <typename Value>
struct Boxed {
    PyObject_HEAD
    std::shared_ptr<const Value> value;
};

template <typename Value>
const std::shared_ptr<const Value>& unbox(PyObject* self)
{
    return reinterpret_cast<Boxed<Value>*>(self)->value;
}

template <typename Value>
PyObject* box(PyTypeObject* type, Value value)
{
    auto shared = std::make_shared<const Value>(std::move(value));
    PyObject* self = PyType_GenericAlloc(type, 0);
    if (self != nullptr) {
        new (&reinterpret_cast<Boxed<Value>*>(self)->value) std::shared_ptr<const Value>(std::move(shared));
    }
    return self;
}

template <typename Value>
void dealloc_boxed(PyObject* self)
{
    PyTypeObject* type = Py_TYPE(self);
    reinterpret_cast<Boxed<Value>*>(self)->value.~shared_ptr<const Value>();
    PyObject_Free(self);
    Py_DECREF(type);
}

// One function a file of types: each adds its types and functions to the module; -1 with a Python error set on failure.
int add_arrays(PyObject* module);
int add_sample(PyObject* module);
int add_bake(PyObject* module);
int add_facets(PyObject* module);
int add_map(PyObject* module);
int add_map_functions(PyObject* module);
int add_shell(PyObject* module);
int add_render(PyObject* module);
int add_scene(PyObject* module);
int add_volume(PyObject* module);
int add_attributes(PyObject* module);
int add_folds(PyObject* module);

// Makes a heap type, stores it in `slot` and in the module under the last part of its name.
int add_type(PyObject* module, PyType_Spec& spec, PyTypeObject*& slot);

}  // namespace mesoshell::python
