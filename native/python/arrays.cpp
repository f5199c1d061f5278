#include "arrays.h"

#include <climits>
#include <type_traits>

namespace mesoshell::python {
namespace {

// Exports memory that a C++ value owns.
struct ExportedArray {
    std::shared_ptr<const void> owner;
    const void* data;
    char format[2];
    Py_ssize_t item_size;
    std::vector<Py_ssize_t> shape;
    std::vector<Py_ssize_t> strides;
};

int get_buffer(PyObject* self, Py_buffer* view, int flags)
{
    if ((flags & PyBUF_WRITABLE) != 0) {
        PyErr_SetString(PyExc_BufferError, "the array is read-only; copy it first");
        return -1;
    }
    auto& array = const_cast<ExportedArray&>(*unbox<ExportedArray>(self));
    Py_ssize_t count = 1;
    for (const Py_ssize_t extent : array.shape) {
        count *= extent;
    }
    view->buf = const_cast<void*>(array.data);
    view->obj = Py_NewRef(self);
    view->len = count * array.item_size;
    view->readonly = 1;
    view->itemsize = array.item_size;
    view->format = (flags & PyBUF_FORMAT) != 0 ? array.format : nullptr;
    view->ndim = static_cast<int>(array.shape.size());
    view->shape = (flags & PyBUF_ND) != 0 ? array.shape.data() : nullptr;
    view->strides = (flags & PyBUF_STRIDES) == PyBUF_STRIDES ? array.strides.data() : nullptr;
    view->suboffsets = nullptr;
    view->internal = nullptr;
    return 0;
}

PyType_Slot array_slots[] = {
    {Py_tp_doc, const_cast<char*>("Memory of a native object; numpy.asarray makes an array of it without a copy.")},
    {Py_tp_dealloc, reinterpret_cast<void*>(dealloc_boxed<ExportedArray>)},
    {Py_bf_getbuffer, reinterpret_cast<void*>(get_buffer)},
    {0, nullptr},
};

PyType_Spec array_spec = {"mesoshell_native.Array", sizeof(Boxed<ExportedArray>), 0,
                          Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, array_slots};

PyObject* numpy(ModuleState& state)
{
    if (state.numpy == nullptr) {
        state.numpy = PyImport_ImportModule("numpy");
        if (state.numpy == nullptr) {
            throw PythonError();
        }
    }
    return state.numpy;
}

template <typename Element>
const char* dtype_name();
template <>
const char* dtype_name<float>()
{
    return "f4";
}
template <>
const char* dtype_name<double>()
{
    return "f8";
}
template <>
const char* dtype_name<std::int32_t>()
{
    return "i4";
}
template <>
const char* dtype_name<std::int64_t>()
{
    return "i8";
}

// "b", "i", "u", "f", ... of a NumPy array.
char kind_of(PyObject* array)
{
    const Reference dtype = checked(PyObject_GetAttrString(array, "dtype"));
    const Reference kind = checked(PyObject_GetAttrString(dtype.get(), "kind"));
    const Reference bytes = checked(PyUnicode_AsASCIIString(kind.get()));
    return PyBytes_AsString(bytes.get())[0];
}

}  // namespace

int add_arrays(PyObject* module)
{
    return add_type(module, array_spec, state_of_module(module).array_type);
}

Reference checked(PyObject* object)
{
    if (object == nullptr) {
        throw PythonError();
    }
    return Reference(object);
}

template <typename Element>
void ArrayArgument<Element>::acquire(ModuleState& state, PyObject* object, const std::string& called)
{
    const Reference given = checked(PyObject_CallMethod(numpy(state), "asarray", "(O)", object));
    const char kind = kind_of(given.get());
    const bool integer = kind == 'i' || kind == 'u';
    if (std::is_integral_v<Element> ? !integer : !(integer || kind == 'f')) {
        throw InvalidArgument(called + " holds " + (std::is_integral_v<Element> ? "no integers" : "no numbers") +
                              "; give an array of " + dtype_name<Element>());
    }
    const Reference array =
        checked(PyObject_CallMethod(numpy(state), "ascontiguousarray", "Os", given.get(), dtype_name<Element>()));
    if (PyObject_GetBuffer(array.get(), &view_, PyBUF_ND | PyBUF_FORMAT) != 0) {
        throw PythonError();
    }
}

template <typename Element>
void ArrayArgument<Element>::refuse_shape(const std::string& called, const std::string& wanted)
{
    std::string shape;
    for (int axis = 0; axis < view_.ndim; ++axis) {
        shape += (axis > 0 ? ", " : "") + std::to_string(view_.shape[axis]);
    }
    PyBuffer_Release(&view_);
    throw InvalidArgument(called + " has shape [" + shape + "]; give " + wanted);
}

template <typename Element>
ArrayArgument<Element>::ArrayArgument(ModuleState& state, PyObject* object, const char* name, int row)
{
    acquire(state, object, name);
    if (row == 0 ? view_.ndim != 1 : view_.ndim != 2 || view_.shape[1] != row) {
        refuse_shape(name, row == 0 ? "[n]" : "[n, " + std::to_string(row) + "]");
    }
}

template <typename Element>
ArrayArgument<Element>::ArrayArgument(ModuleState& state, PyObject* object, const char* name, Axes axes)
{
    acquire(state, object, name);
    if (view_.ndim != axes.count) {
        refuse_shape(name, std::to_string(axes.count) + " axes");
    }
}

template class ArrayArgument<float>;
template class ArrayArgument<double>;
template class ArrayArgument<std::int32_t>;
template class ArrayArgument<std::int64_t>;

PyObject* array_view(ModuleState& state, std::shared_ptr<const void> owner, const void* data, char format,
                     std::vector<Py_ssize_t> shape)
{
    ExportedArray array;
    array.owner = std::move(owner);
    array.data = data;
    array.format[0] = format;
    array.format[1] = '\0';
    array.item_size = format == 'B' ? 1 : 4;
    array.shape = std::move(shape);
    array.strides.resize(array.shape.size());
    Py_ssize_t stride = array.item_size;
    for (std::size_t axis = array.shape.size(); axis-- > 0;) {
        array.strides[axis] = stride;
        stride *= array.shape[axis];
    }
    const Reference exported = checked(box(state.array_type, std::move(array)));
    return checked(PyObject_CallMethod(numpy(state), "asarray", "(O)", exported.get())).release();
}

void set_item(PyObject* dict, const char* name, PyObject* value)
{
    const Reference owned = checked(value);
    if (PyDict_SetItemString(dict, name, owned.get()) != 0) {
        throw PythonError();
    }
}

std::vector<int> integers(ModuleState& state, PyObject* object, const char* name, int count)
{
    const ArrayArgument<std::int64_t> array(state, object, name, 0);
    if (static_cast<int>(array.values().size()) != count) {
        throw InvalidArgument(std::string(name) + " has " + std::to_string(array.values().size()) + " values; give " +
                              std::to_string(count));
    }
    std::vector<int> values;
    for (const std::int64_t value : array.values()) {
        if (value < INT_MIN || value > INT_MAX) {
            throw InvalidArgument(std::string(name) + " holds " + std::to_string(value) + ", which is out of range");
        }
        values.push_back(static_cast<int>(value));
    }
    return values;
}

glm::dmat4 matrix(ModuleState& state, PyObject* object, const char* name)
{
    const ArrayArgument<double> array(state, object, name, 4);
    if (array.values().size() != 16) {
        throw InvalidArgument(std::string(name) + " has " + std::to_string(array.values().size() / 4) + " rows; give 4");
    }
    glm::dmat4 columns;
    for (int i = 0; i < 16; ++i) {
        columns[i % 4][i / 4] = array.values()[static_cast<std::size_t>(i)];
    }
    return columns;
}

}  // namespace mesoshell::python
