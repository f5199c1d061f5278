// mesoshell_native.Sample
#include "arrays.h"
#include "mesoshell/sample.h"
#include "run.h"

namespace mesoshell::python {
namespace {

std::vector<glm::uvec3> checked_triangles(std::span<const glm::i64vec3> rows, std::size_t vertices)
{
    std::vector<glm::uvec3> triangles;
    triangles.reserve(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        for (int corner = 0; corner < 3; ++corner) {
            if (rows[i][corner] < 0 || rows[i][corner] >= static_cast<std::int64_t>(vertices)) {
                throw InvalidArgument("triangle " + std::to_string(i) + " of the tile uses vertex " +
                                      std::to_string(rows[i][corner]) + ", but there are only " + std::to_string(vertices) +
                                      " vertices");
            }
        }
        triangles.emplace_back(rows[i]);
    }
    return triangles;
}

PyObject* sample_new(PyTypeObject* type, PyObject* args, PyObject* kwargs)
{
    auto& state = *static_cast<ModuleState*>(PyType_GetModuleState(type));
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"positions", "triangles", "height", "aspect", "thickness", nullptr};
        PyObject* positions = nullptr;
        PyObject* triangles = nullptr;
        double height = 0.0;
        double aspect = 1.0;
        double thickness = 0.0;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OO|$ddd:Sample", const_cast<char**>(names), &positions, &triangles,
                                         &height, &aspect, &thickness)) {
            return nullptr;
        }
        require_keywords(kwargs, {"height"});
        const ArrayArgument<float> position_array(state, positions, "positions", 3);
        const ArrayArgument<std::int64_t> triangle_array(state, triangles, "triangles", 3);
        const auto points = position_array.rows<glm::vec3>();
        SampleOptions options;
        options.thickness = static_cast<float>(thickness);
        Job job;
        return box(type, run(job, nullptr, [&] {
            return Sample({points.begin(), points.end()},
                          checked_triangles(triangle_array.rows<glm::i64vec3>(), points.size()),
                          static_cast<float>(height), static_cast<float>(aspect), options);
        }));
    });
}

const Sample& self_of(PyObject* self)
{
    return *unbox<Sample>(self);
}

PyObject* sample_notices(PyObject* self, void*)
{
    return guarded(state_of(self), [&]() -> PyObject* {
        const std::vector<std::string>& notices = self_of(self).notices();
        Reference tuple = checked(PyTuple_New(static_cast<Py_ssize_t>(notices.size())));
        for (std::size_t i = 0; i < notices.size(); ++i) {
            Reference text = checked(PyUnicode_FromStringAndSize(notices[i].data(), static_cast<Py_ssize_t>(notices[i].size())));
            PyTuple_SetItem(tuple.get(), static_cast<Py_ssize_t>(i), text.release());
        }
        return tuple.release();
    });
}

PyGetSetDef sample_attributes[] = {
    {"height", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).height()); }, nullptr, "tile widths", nullptr},
    {"aspect", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).aspect()); }, nullptr, "pv / pu", nullptr},
    {"vertex_count", [](PyObject* self, void*) { return PyLong_FromSize_t(self_of(self).positions().size()); }, nullptr,
     "vertices of the surface", nullptr},
    {"triangle_count", [](PyObject* self, void*) { return PyLong_FromSize_t(self_of(self).triangles().size()); }, nullptr,
     "triangles of the surface", nullptr},
    {"clipped_triangles", [](PyObject* self, void*) { return PyLong_FromSize_t(self_of(self).clipped_triangles()); }, nullptr,
     "triangles cut or dropped at w = 0 and w = 1", nullptr},
    {"notices", sample_notices, nullptr, "what was repaired, in sentences", nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr},
};

PyType_Slot sample_slots[] = {
    {Py_tp_doc, const_cast<char*>("Sample(positions, triangles, *, height, aspect=1.0, thickness=0.0)\n--\n\n"
                                  "A periodic mesh in metric texture space: positions [n, 3] in tile widths (x has "
                                  "period 1, y period aspect), triangles [m, 3]. It is repaired; what is open becomes a "
                                  "sheet of the given thickness, in tile widths, or is closed. Raises ValueError.")},
    {Py_tp_new, reinterpret_cast<void*>(sample_new)},
    {Py_tp_dealloc, reinterpret_cast<void*>(dealloc_boxed<Sample>)},
    {Py_tp_getset, sample_attributes},
    {0, nullptr},
};

PyType_Spec sample_spec = {"mesoshell_native.Sample", sizeof(Boxed<Sample>), 0, Py_TPFLAGS_DEFAULT, sample_slots};

}  // namespace

int add_sample(PyObject* module)
{
    return add_type(module, sample_spec, state_of_module(module).sample_type);
}

}  // namespace mesoshell::python
