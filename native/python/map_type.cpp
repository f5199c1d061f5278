// mesoshell_native.Map
#include <algorithm>

#include "arrays.h"
#include "map_choices.h"
#include "map_parts.h"
#include "mesoshell/compress.h"
#include "mesoshell/render.h"
#include "mesoshell/store.h"
#include "run.h"

namespace mesoshell::python {
namespace {

const Map& self_of(PyObject* self)
{
    return *unbox<Map>(self);
}

PyObject* map_weights(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& map = unbox<Map>(self);
        const glm::ivec3& nodes = map->resolution.nodes;
        return array_view(state_of(self), map, map->weights.data(), 'f', {map->terms, map->weight_azimuths(), nodes.y, nodes.x});
    });
}

PyObject* map_eigenmaps(PyObject* self, void*)
{
    return guarded(state_of(self), [&] {
        const auto& map = unbox<Map>(self);
        return array_view(state_of(self), map, map->eigenmaps.data(), 'f',
                          {map->terms, map->eigen_azimuths(), map->resolution.ntheta, map->resolution.nodes.z});
    });
}

PyObject* map_sdf(PyObject* self, void*)
{
    return guarded(state_of(self), [&]() -> PyObject* {
        const auto& map = unbox<Map>(self);
        if (map->sdf.empty()) {
            Py_RETURN_NONE;
        }
        const glm::ivec3& nodes = map->sdf_nodes;
        return array_view(state_of(self), map, map->sdf.data(), 'f', {nodes.z, nodes.y, nodes.x});
    });
}

PyObject* map_resolution(PyObject* self, void*)
{
    const glm::ivec3& nodes = self_of(self).resolution.nodes;
    return Py_BuildValue("(iii)", nodes.x, nodes.y, nodes.z);
}

PyObject* map_facet_cells(PyObject* self, void*)
{
    const glm::ivec3& cells = self_of(self).facets.cells;
    return Py_BuildValue("(iii)", cells.x, cells.y, cells.z);
}

PyObject* map_directions(PyObject* self, void*)
{
    return Py_BuildValue("(ii)", self_of(self).resolution.ntheta, self_of(self).resolution.nphi);
}

PyGetSetDef map_getters[] = {
    {"weights", map_weights, nullptr, "float32 [terms, nphi or 1, ny, nx]", nullptr},
    {"eigenmaps", map_eigenmaps, nullptr, "float32 [terms, 1 or nphi, ntheta, nz]", nullptr},
    {"sdf", map_sdf, nullptr, "float32 [mz, my, mx], tile widths, negative inside; or None", nullptr},
    {"facets", map_facets, nullptr, "float32 [depth, cy, cx, 4], bits of shaders/lib/facets.glsl; or None", nullptr},
    {"facet_cells", map_facet_cells, nullptr, "(cx, cy, cz), zeros without facets", nullptr},
    {"attributes", map_attributes, nullptr,
     "dict of float32 [nz, ny, nx, channels]: color (linear), surface (roughness, metallic), normal; or None", nullptr},
    {"height", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).height); }, nullptr, "tile widths", nullptr},
    {"aspect", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).aspect); }, nullptr, "pv / pu", nullptr},
    {"terms", [](PyObject* self, void*) { return PyLong_FromLong(self_of(self).terms); }, nullptr, "SVD terms", nullptr},
    {"rmse", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).rmse); }, nullptr,
     "error of the stored terms over the grid, tile widths", nullptr},
    {"max_error", [](PyObject* self, void*) { return PyFloat_FromDouble(self_of(self).max_error); }, nullptr,
     "largest error of the stored terms over the grid, tile widths", nullptr},
    {"resolution", map_resolution, nullptr, "(nx, ny, nz)", nullptr},
    {"directions", map_directions, nullptr, "(ntheta, nphi)", nullptr},
    {"precision", [](PyObject* self, void*) { return name_of(precisions, self_of(self).precision); }, nullptr,
     "\"byte\", \"half\" or \"float\"", nullptr},
    {"layout", [](PyObject* self, void*) { return name_of(layouts, self_of(self).layout); }, nullptr,
     "\"paper\", \"share\" or \"nodes\"", nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr},
};

PyObject* map_save(PyObject* self, PyObject* path)
{
    return guarded(state_of(self), [&]() -> PyObject* {
        const std::string target = path_argument(path);
        const auto map = unbox<Map>(self);
        Job job;
        run(job, nullptr, [&] {
            save_map(*map, target);
            return true;
        });
        Py_RETURN_NONE;
    });
}

PyObject* map_lookup(PyObject* self, PyObject* args)
{
    return guarded(state_of(self), [&]() -> PyObject* {
        PyObject* positions = nullptr;
        PyObject* directions = nullptr;
        if (!PyArg_ParseTuple(args, "OO:lookup", &positions, &directions)) {
            return nullptr;
        }
        const ArrayArgument<float> pos(state_of(self), positions, "pos_texture", 3);
        const ArrayArgument<float> dir(state_of(self), directions, "dir_metric", 3);
        const auto map = unbox<Map>(self);
        Job job;
        std::vector<float> distances =
            run(job, nullptr, [&] { return lookup_gdm(*map, pos.rows<glm::vec3>(), dir.rows<glm::vec3>()); });
        const auto count = static_cast<Py_ssize_t>(distances.size());
        return array_from(state_of(self), std::move(distances), 'f', {count});
    });
}

PyObject* map_sample_sdf(PyObject* self, PyObject* positions)
{
    return guarded(state_of(self), [&] {
        const ArrayArgument<float> pos(state_of(self), positions, "pos_texture", 3);
        const auto map = unbox<Map>(self);
        Job job;
        std::vector<float> distances = run(job, nullptr, [&] { return lookup_sdf(*map, pos.rows<glm::vec3>()); });
        const auto count = static_cast<Py_ssize_t>(distances.size());
        return array_from(state_of(self), std::move(distances), 'f', {count});
    });
}

PyMethodDef map_methods[] = {
    {"save", map_save, METH_O, "save(path)\n--\n\nWrite an OpenEXR file; what was there stays until it is whole. Raises OSError."},
    {"lookup", map_lookup, METH_VARARGS,
     "lookup(pos_texture, dir_metric)\n--\n\nThe shader text's GDM lookup: float32 [n], tile widths, of positions [n, 3] and "
     "directions [n, 3]."},
    {"sample_sdf", map_sample_sdf, METH_O,
     "sample_sdf(pos_texture)\n--\n\nThe shader text's SDF lookup: float32 [n], tile widths, of positions [n, 3]."},
    {nullptr, nullptr, 0, nullptr},
};

PyType_Slot map_slots[] = {
    {Py_tp_doc, const_cast<char*>("A baked tile: the GDM's SVD terms, its distance field, its facets and its surface's attributes.")},
    {Py_tp_dealloc, reinterpret_cast<void*>(dealloc_boxed<Map>)},
    {Py_tp_getset, map_getters},
    {Py_tp_methods, map_methods},
    {0, nullptr},
};

PyType_Spec map_spec = {"mesoshell_native.Map", sizeof(Boxed<Map>), 0,
                        Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, map_slots};

}  // namespace

int add_map(PyObject* module)
{
    return add_type(module, map_spec, state_of_module(module).map_type);
}

}  // namespace mesoshell::python
