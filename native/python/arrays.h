// NumPy arrays in and out, through the buffer protocol and without copies where the type already fits.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "errors.h"
#include "mesoshell/error.h"

namespace mesoshell::python {

// An owned reference.
class Reference {
public:
    explicit Reference(PyObject* object = nullptr) : object_(object) {}
    Reference(Reference&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
    Reference& operator=(Reference&& other) noexcept
    {
        std::swap(object_, other.object_);
        return *this;
    }
    ~Reference() { Py_XDECREF(object_); }
    PyObject* get() const { return object_; }
    PyObject* release() { return std::exchange(object_, nullptr); }

private:
    PyObject* object_;
};

// Throws PythonError for null.
Reference checked(PyObject* object);

// How many axes an array argument has.
struct Axes {
    int count;
};

// A contiguous array argument of one element type, held while this lives.
template <typename Element>
class ArrayArgument {
public:
    // Accepts whatever numpy.asarray does; integers for integer elements only. `row` is the extent of the last axis (0: one
    // axis of any length). Throws InvalidArgument that names the argument; PythonError.
    ArrayArgument(ModuleState& state, PyObject* object, const char* name, int row);
    // The same with that many axes of any lengths.
    ArrayArgument(ModuleState& state, PyObject* object, const char* name, Axes axes);
    ~ArrayArgument() { PyBuffer_Release(&view_); }
    ArrayArgument(const ArrayArgument&) = delete;
    ArrayArgument& operator=(const ArrayArgument&) = delete;

    std::span<const Element> values() const
    {
        return {static_cast<const Element*>(view_.buf), static_cast<std::size_t>(view_.len) / sizeof(Element)};
    }
    std::span<const Py_ssize_t> shape() const { return {view_.shape, static_cast<std::size_t>(view_.ndim)}; }
    // The same memory as rows of vectors.
    template <typename Vector>
    std::span<const Vector> rows() const
    {
        return {static_cast<const Vector*>(view_.buf), static_cast<std::size_t>(view_.len) / sizeof(Vector)};
    }

private:
    void acquire(ModuleState& state, PyObject* object, const std::string& called);
    [[noreturn]] void refuse_shape(const std::string& called, const std::string& wanted);

    Py_buffer view_{};
};

extern template class ArrayArgument<float>;
extern template class ArrayArgument<double>;
extern template class ArrayArgument<std::int32_t>;
extern template class ArrayArgument<std::int64_t>;

// A read-only NumPy view of memory that `owner` keeps alive. `format` is a struct code: f, B, i, I.
PyObject* array_view(ModuleState& state, std::shared_ptr<const void> owner, const void* data, char format,
                     std::vector<Py_ssize_t> shape);

// A NumPy array that owns a vector's memory, zero-copy.
template <typename Value>
PyObject* array_from(ModuleState& state, std::vector<Value> values, char format, std::vector<Py_ssize_t> shape)
{
    auto owner = std::make_shared<const std::vector<Value>>(std::move(values));
    const void* data = owner->data();
    return array_view(state, std::move(owner), data, format, std::move(shape));
}

// dict[name] = value, which is consumed.
void set_item(PyObject* dict, const char* name, PyObject* value);

// Three or two integers from a sequence; throws InvalidArgument that names the argument.
std::vector<int> integers(ModuleState& state, PyObject* object, const char* name, int count);

// A 4 x 4 matrix, rows first as NumPy has it.
glm::dmat4 matrix(ModuleState& state, PyObject* object, const char* name);

}  // namespace mesoshell::python
