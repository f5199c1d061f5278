#include "errors.h"

#include <cerrno>

#include "mesoshell/error.h"

namespace mesoshell::python {

void require_keywords(PyObject* kwargs, std::initializer_list<const char*> names)
{
    for (const char* name : names) {
        if (kwargs == nullptr || PyDict_GetItemString(kwargs, name) == nullptr) {
            PyErr_Format(PyExc_TypeError, "missing keyword argument '%s'", name);
            throw PythonError();
        }
    }
}

void set_python_error(ModuleState& state) noexcept
{
    try {
        throw;
    } catch (const PythonError&) {
    } catch (const Cancelled& error) {
        PyErr_SetString(state.cancelled, error.what());
    } catch (const Error& error) {
        PyErr_SetString(state.error, error.what());
    } catch (const FileError& error) {
        errno = error.code;
        PyErr_SetFromErrnoWithFilename(PyExc_OSError, error.path.c_str());
    } catch (const std::invalid_argument& error) {
        PyErr_SetString(PyExc_ValueError, error.what());
    } catch (const std::bad_alloc&) {
        PyErr_NoMemory();
    } catch (const std::length_error&) {
        PyErr_NoMemory();
    } catch (const std::exception& error) {
        PyErr_SetString(state.error, error.what());
    } catch (...) {
        PyErr_SetString(state.error, "an unknown error; report it with the steps that led here");
    }
}

}  // namespace mesoshell::python
