// Which shared libraries serve this build: in a host that links other versions of them, ours must be the ones in use.
#pragma once

#include <map>
#include <string>

namespace mesoshell {

// Name ("embree", "opensubdiv", "openexr", "tbb", "mesoshell") to the path of the library that one of its functions, as this
// code calls it, lies in.
std::map<std::string, std::string> loaded_libraries();

// Version of Embree at run time, for instance "3.13.5".
std::string embree_version();

// Name of the instruction set that the inner loops of this processor use: "avx2", or "baseline" for any x86-64. The environment
// variable MESOSHELL_INSTRUCTION_SET=baseline, read once, holds it back.
const char* instruction_set();

}  // namespace mesoshell
