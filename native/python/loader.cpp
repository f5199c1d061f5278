// The extension module Python finds. It opens the real one, mesoshell_native.libs/libmesoshell.so beside it, so that the
// libraries bundled with it are found before those of the same name that the host program links.
#include <Python.h>

#include <string>

#include <dlfcn.h>

extern "C" __attribute__((visibility("default"))) PyObject* PyInit_mesoshell_native()
{
    Dl_info here;
    if (dladdr(reinterpret_cast<const void*>(&PyInit_mesoshell_native), &here) == 0) {
        PyErr_SetString(PyExc_ImportError, "mesoshell_native cannot find its own file; install it again");
        return nullptr;
    }
    std::string folder(here.dli_fname);
    folder.erase(folder.find_last_of('/') + 1);
    const std::string inner = folder + "mesoshell_native.libs/libmesoshell.so";
    // Never closed: its types and threads live as long as the process.
    void* library = dlopen(inner.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND);
    if (library == nullptr) {
        PyErr_Format(PyExc_ImportError, "mesoshell_native cannot load its libraries (%s); install it again", dlerror());
        return nullptr;
    }
    using Init = PyObject* (*)();
    const auto init = reinterpret_cast<Init>(dlsym(library, "mesoshell_module_init"));
    if (init == nullptr) {
        PyErr_Format(PyExc_ImportError, "%s is of another version; install mesoshell_native again", inner.c_str());
        return nullptr;
    }
    return init();
}
