// A dict argument: its fields by name, each refused by a sentence that says where it is.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>

#include <glm/glm.hpp>

#include "arrays.h"

namespace mesoshell::python {

class Fields {
public:
    // Throws InvalidArgument for what is no dict, or has keys that are none of these.
    Fields(ModuleState& state, PyObject* object, std::string what, std::initializer_list<const char*> known);

    // "lights[2]: radius"
    std::string called(const char* name) const { return what_ + ": " + name; }

    // Borrowed; null where the field is missing or None.
    PyObject* find(const char* name) const;
    // Throws InvalidArgument where it is missing.
    PyObject* need(const char* name) const;
    // One of the module's types.
    PyObject* need(const char* name, PyTypeObject* type) const;

    double number(const char* name, double otherwise) const;
    std::int32_t integer(const char* name, std::int32_t otherwise) const;
    bool flag(const char* name, bool otherwise) const;
    std::string text(const char* name, const char* otherwise) const;
    // Two or three numbers.
    glm::dvec2 pair(const char* name, const glm::dvec2& otherwise) const;
    glm::dvec3 triple(const char* name, const glm::dvec3& otherwise) const;

private:
    template <typename Vector>
    Vector vector(const char* name, const Vector& otherwise) const;

    ModuleState& state_;
    PyObject* dict_;
    std::string what_;
};

}  // namespace mesoshell::python
