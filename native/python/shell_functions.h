// What makes and asks shells.
#pragma once

#include "state.h"

namespace mesoshell::python {

extern PyMethodDef shell_functions[];
extern PyMethodDef stretch_functions[];

}  // namespace mesoshell::python
