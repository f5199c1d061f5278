// Arguments that several functions which render take.
#pragma once

#include <Python.h>

#include "mesoshell/interface.h"

namespace mesoshell::python {

// The uniform block from any bytes-like object of its size; its defaults for None or null. Throws InvalidArgument;
// PythonError.
ShellParams params_argument(PyObject* object);

}  // namespace mesoshell::python
