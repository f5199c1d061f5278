#include "map_parts.h"

#include <algorithm>
#include <climits>

namespace mesoshell::python {
namespace {

// Fills in one array of the attributes, and their nodes from the first.
void take_array(ModuleState& state, PyObject* dict, const char* name, int channels, glm::ivec3& nodes,
                std::vector<float>& values)
{
    PyObject* const given = PyDict_GetItemString(dict, name);
    if (given == nullptr) {
        throw InvalidArgument(std::string("attributes has no '") + name + "'; give color, surface and normal");
    }
    const ArrayArgument<float> array(state, given, name, Axes{4});
    glm::ivec3 found;
    for (int axis = 0; axis < 3; ++axis) {
        found[2 - axis] = static_cast<int>(std::min<Py_ssize_t>(array.shape()[axis], INT_MAX));
    }
    if (array.shape()[3] != channels || (nodes != glm::ivec3(0) && nodes != found)) {
        throw InvalidArgument(std::string("attribute '") + name + "' does not have " + std::to_string(channels) +
                              " values for each node, or other nodes than color; give [nz, ny, nx, " +
                              std::to_string(channels) + "]");
    }
    nodes = found;
    values.assign(array.values().begin(), array.values().end());
}

}  // namespace

MapParts::MapParts(ModuleState& state, PyObject* facets, PyObject* attributes)
{
    if (facets != Py_None) {
        if (Py_TYPE(facets) != state.facets_type) {
            throw InvalidArgument("facets is no Facets; pass what bake_facets returned");
        }
        facets_ = unbox<Facets>(facets);
    }
    if (attributes != Py_None) {
        if (!PyDict_Check(attributes)) {
            throw InvalidArgument("attributes is no dict; give arrays color, surface and normal");
        }
        Attributes& taken = attributes_.emplace();
        take_array(state, attributes, "color", 3, taken.nodes, taken.color);
        take_array(state, attributes, "surface", 2, taken.nodes, taken.surface);
        take_array(state, attributes, "normal", 3, taken.nodes, taken.normal);
    }
}

PyObject* map_facets(PyObject* self, void*)
{
    return guarded(state_of(self), [&]() -> PyObject* {
        const auto& map = unbox<Map>(self);
        const Facets& facets = map->facets;
        if (facets.texels.empty()) {
            Py_RETURN_NONE;
        }
        return array_view(state_of(self), map, facets.texels.data(), 'f',
                          {facets.depth(), facets.cells.y, facets.cells.x, 4});
    });
}

PyObject* map_attributes(PyObject* self, void*)
{
    return guarded(state_of(self), [&]() -> PyObject* {
        const auto& map = unbox<Map>(self);
        const Attributes& attributes = map->attributes;
        if (attributes.color.empty()) {
            Py_RETURN_NONE;
        }
        const auto view = [&](const std::vector<float>& values, int channels) {
            return array_view(state_of(self), map, values.data(), 'f',
                              {attributes.nodes.z, attributes.nodes.y, attributes.nodes.x, channels});
        };
        Reference dict = checked(PyDict_New());
        set_item(dict.get(), "color", view(attributes.color, 3));
        set_item(dict.get(), "surface", view(attributes.surface, 2));
        set_item(dict.get(), "normal", view(attributes.normal, 3));
        return dict.release();
    });
}

}  // namespace mesoshell::python
