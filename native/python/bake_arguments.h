// What the functions that bake a GDM have in common.
#pragma once

#include "arrays.h"
#include "mesoshell/bake.h"

namespace mesoshell::python {

struct BakeArguments {
    PyObject* resolution = nullptr;
    PyObject* directions = nullptr;
    const char* engine = "auto";

    // Throw InvalidArgument; PythonError.
    GdmResolution checked_resolution(ModuleState& state) const;
    Engine checked_engine() const;
};

// Bytes: a quarter of the machine's memory.
double default_memory();

}  // namespace mesoshell::python
