// The names of layouts and precisions.
#pragma once

#include "mesoshell/compress.h"
#include "named.h"

namespace mesoshell::python {

inline constexpr Named<Precision> precisions[] = {{"byte", Precision::byte}, {"half", Precision::half}, {"float", Precision::single}};
inline constexpr Named<Layout> layouts[] = {{"paper", Layout::paper}, {"share", Layout::share}, {"nodes", Layout::nodes}, {"auto", Layout::automatic}};

// The file system's own spelling of a path argument; throws PythonError.
std::string path_argument(PyObject* object);

}  // namespace mesoshell::python
