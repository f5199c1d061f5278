// The facets and the attributes of a Map: arguments of the calls that make one, and arrays of one that is there.
#pragma once

#include <memory>
#include <optional>

#include "arrays.h"
#include "mesoshell/compress.h"

namespace mesoshell::python {

// What becomes part of a Map beside its terms and its distance field.
class MapParts {
public:
    // facets: a Facets or None; attributes: None or a dict of arrays, "color" [nz, ny, nx, 3], "surface" [nz, ny, nx, 2] and
    // "normal" [nz, ny, nx, 3], which is copied. Throws InvalidArgument that names the argument; PythonError.
    MapParts(ModuleState& state, PyObject* facets, PyObject* attributes);

    void attach_to(Map& map) const { attach(map, facets_.get(), attributes_ ? &*attributes_ : nullptr); }

private:
    std::shared_ptr<const Facets> facets_;
    std::optional<Attributes> attributes_;
};

// Getters of the type Map.
PyObject* map_facets(PyObject* self, void*);
PyObject* map_attributes(PyObject* self, void*);

}  // namespace mesoshell::python
