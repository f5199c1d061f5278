#include "mesoshell/libraries.h"

#include <dlfcn.h>

#include <OpenEXR/ImfHeader.h>
#include <oneapi/tbb/version.h>

#include "embree_scene.h"
#include "limit_surface.h"

namespace mesoshell {
namespace {

std::string path_of(const void* function)
{
    Dl_info info;
    return dladdr(function, &info) != 0 && info.dli_fname != nullptr ? info.dli_fname : "";
}

}  // namespace

std::map<std::string, std::string> loaded_libraries()
{
    return {
        {"embree", path_of(embree_function())},
        {"opensubdiv", path_of(opensubdiv_function())},
        {"openexr", path_of(reinterpret_cast<const void*>(&Imf::staticInitialize))},
        {"tbb", path_of(reinterpret_cast<const void*>(&TBB_runtime_version))},
        {"mesoshell", path_of(reinterpret_cast<const void*>(&loaded_libraries))},
    };
}

}  // namespace mesoshell
