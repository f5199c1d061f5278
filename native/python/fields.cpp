#include "fields.h"

#include <algorithm>
#include <climits>
#include <utility>

namespace mesoshell::python {
namespace {

std::string text_of(PyObject* object, const std::string& called)
{
    const char* text = PyUnicode_Check(object) ? PyUnicode_AsUTF8AndSize(object, nullptr) : nullptr;
    if (text == nullptr) {
        PyErr_Clear();
        throw InvalidArgument(called + " is no text; give a str");
    }
    return text;
}

}  // namespace

Fields::Fields(ModuleState& state, PyObject* object, std::string what, std::initializer_list<const char*> known)
    : state_(state), dict_(object), what_(std::move(what))
{
    if (!PyDict_Check(object)) {
        throw InvalidArgument(what_ + " is no dict; give one with its fields by name");
    }
    PyObject* key = nullptr;
    PyObject* value = nullptr;
    Py_ssize_t place = 0;
    while (PyDict_Next(object, &place, &key, &value)) {
        const std::string name = text_of(key, what_ + ": a key");
        if (std::none_of(known.begin(), known.end(), [&](const char* other) { return name == other; })) {
            std::string names;
            for (const char* other : known) {
                names += (names.empty() ? "" : ", ") + std::string(other);
            }
            throw InvalidArgument(what_ + " has no field '" + name + "'; its fields are " + names);
        }
    }
}

PyObject* Fields::find(const char* name) const
{
    PyObject* value = PyDict_GetItemString(dict_, name);
    return value == Py_None ? nullptr : value;
}

PyObject* Fields::need(const char* name) const
{
    PyObject* value = find(name);
    if (value == nullptr) {
        throw InvalidArgument(what_ + " lacks '" + name + "'; give it");
    }
    return value;
}

PyObject* Fields::need(const char* name, PyTypeObject* type) const
{
    PyObject* value = need(name);
    if (Py_TYPE(value) != type) {
        throw InvalidArgument(called(name) + " is none; give the module's own object");
    }
    return value;
}

double Fields::number(const char* name, double otherwise) const
{
    PyObject* value = find(name);
    if (value == nullptr) {
        return otherwise;
    }
    const double number = PyFloat_AsDouble(value);
    if (number == -1.0 && PyErr_Occurred() != nullptr) {
        PyErr_Clear();
        throw InvalidArgument(called(name) + " is no number; give one");
    }
    return number;
}

std::int32_t Fields::integer(const char* name, std::int32_t otherwise) const
{
    PyObject* value = find(name);
    if (value == nullptr) {
        return otherwise;
    }
    int overflow = 0;
    const Reference index(PyNumber_Index(value));
    const long long number = index.get() != nullptr ? PyLong_AsLongLongAndOverflow(index.get(), &overflow) : 0;
    PyErr_Clear();
    if (index.get() == nullptr || overflow != 0 || number < INT_MIN || number > INT_MAX) {
        throw InvalidArgument(called(name) + " is no integer of 32 bits; give one");
    }
    return static_cast<std::int32_t>(number);
}

bool Fields::flag(const char* name, bool otherwise) const
{
    PyObject* value = find(name);
    if (value == nullptr) {
        return otherwise;
    }
    const int truth = PyObject_IsTrue(value);
    if (truth < 0) {
        throw PythonError();
    }
    return truth != 0;
}

std::string Fields::text(const char* name, const char* otherwise) const
{
    PyObject* value = find(name);
    return value == nullptr ? otherwise : text_of(value, called(name));
}

template <typename Vector>
Vector Fields::vector(const char* name, const Vector& otherwise) const
{
    PyObject* value = find(name);
    if (value == nullptr) {
        return otherwise;
    }
    const ArrayArgument<double> array(state_, value, called(name).c_str(), 0);
    if (array.values().size() != static_cast<std::size_t>(Vector::length())) {
        throw InvalidArgument(called(name) + " has " + std::to_string(array.values().size()) + " numbers; give " +
                              std::to_string(Vector::length()));
    }
    return array.rows<Vector>()[0];
}

glm::dvec2 Fields::pair(const char* name, const glm::dvec2& otherwise) const
{
    return vector(name, otherwise);
}

glm::dvec3 Fields::triple(const char* name, const glm::dvec3& otherwise) const
{
    return vector(name, otherwise);
}

}  // namespace mesoshell::python
