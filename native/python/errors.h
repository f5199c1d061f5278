// The one map from C++ errors to Python's.
#pragma once

#include <initializer_list>

#include "state.h"

namespace mesoshell::python {

// Thrown where a Python error is already set.
struct PythonError {};

// Sets a TypeError and throws PythonError where a call lacks one of these keyword arguments.
void require_keywords(PyObject* kwargs, std::initializer_list<const char*> names);

// Call in a catch block: sets the Python error for the exception in flight.
void set_python_error(ModuleState& state) noexcept;

// Runs work() and returns its result, or null with a Python error set.
template <typename Work>
PyObject* guarded(ModuleState& state, const Work& work) noexcept
{
    try {
        return work();
    } catch (...) {
        set_python_error(state);
        return nullptr;
    }
}

}  // namespace mesoshell::python
