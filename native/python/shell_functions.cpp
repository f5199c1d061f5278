// build_shell and update_shell: their many arguments, held while they run.
#include "shell_functions.h"

#include <algorithm>
#include <optional>

#include "arrays.h"
#include "mesoshell/shell.h"
#include "named.h"
#include "run.h"

namespace mesoshell::python {
namespace {

constexpr Named<Scheme> schemes[] = {{"catmark", Scheme::catmark}, {"loop", Scheme::loop}, {"bilinear", Scheme::bilinear}};
constexpr Named<Boundary> boundaries[] = {{"edges_and_corners", Boundary::edges_and_corners}, {"edges", Boundary::edges}};
constexpr Named<UvRule> uv_rules[] = {{"smooth", UvRule::smooth},
                                      {"corners", UvRule::corners},
                                      {"corners_and_junctions", UvRule::corners_and_junctions},
                                      {"corners_junctions_and_concave", UvRule::corners_junctions_and_concave},
                                      {"boundaries", UvRule::boundaries},
                                      {"linear", UvRule::linear}};
constexpr Named<float> offsets[] = {{"outward", 0.0f}, {"centered", -0.5f}, {"inward", -1.0f}};

// An array argument that may be None.
template <typename Element>
class OptionalArray {
public:
    template <typename Shape>
    OptionalArray(ModuleState& state, PyObject* object, const char* name, Shape shape)
    {
        if (object != Py_None) {
            array_.emplace(state, object, name, shape);
        }
    }
    bool given() const { return array_.has_value(); }
    std::span<const Element> values() const { return array_ ? array_->values() : std::span<const Element>(); }
    std::span<const Py_ssize_t> shape() const { return array_->shape(); }
    template <typename Vector>
    std::span<const Vector> rows() const
    {
        return array_ ? array_->template rows<Vector>() : std::span<const Vector>();
    }

private:
    std::optional<ArrayArgument<Element>> array_;
};

glm::vec2 pair(ModuleState& state, PyObject* object, const char* name, glm::vec2 otherwise)
{
    if (object == Py_None) {
        return otherwise;
    }
    const ArrayArgument<float> array(state, object, name, 0);
    if (array.values().size() != 2) {
        throw InvalidArgument(std::string(name) + " has " + std::to_string(array.values().size()) + " numbers; give two, for u and v");
    }
    return {array.values()[0], array.values()[1]};
}

PyObject* py_build_shell(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"positions", "face_sizes", "corners", "uvs", "thickness", "levels", "scheme", "normals",
                                      "boundary", "uv_rule", "crease_edges", "crease_sharpness", "corner_vertices",
                                      "corner_sharpness", "edge_length", "edge_pixels", "clip_from_object", "screen", "covered",
                                      "thickness_factors", "thickness_image", "offset", "smooth_directors", "uv_scale",
                                      "uv_rotation", "uv_offset", "repair", "relax", "threads", "progress", nullptr};
        PyObject *positions = nullptr, *face_sizes = nullptr, *corners = nullptr, *uvs = nullptr;
        PyObject *normals = Py_None, *crease_edges = Py_None, *crease_sharpness = Py_None, *corner_vertices = Py_None;
        PyObject *corner_sharpness = Py_None, *clip_from_object = Py_None, *screen = Py_None, *covered = Py_None;
        PyObject *factors = Py_None, *image = Py_None, *uv_scale = Py_None, *uv_offset = Py_None, *progress = Py_None;
        double thickness = 0.0, edge_length = 0.0, edge_pixels = 0.0, uv_rotation = 0.0;
        int levels = 0, smooth_directors = 0, repair = 0, relax = 0, threads = 0;
        const char *scheme = "catmark", *boundary = "edges_and_corners", *uv_rule = "boundaries", *offset = "outward";
        if (!PyArg_ParseTupleAndKeywords(
                args, kwargs, "OOOO|$disOssOOOOddOOOOOsiOdOpiiO:build_shell", const_cast<char**>(names), &positions, &face_sizes,
                &corners, &uvs, &thickness, &levels, &scheme, &normals, &boundary, &uv_rule, &crease_edges, &crease_sharpness,
                &corner_vertices, &corner_sharpness, &edge_length, &edge_pixels, &clip_from_object, &screen, &covered, &factors,
                &image, &offset, &smooth_directors, &uv_scale, &uv_rotation, &uv_offset, &repair, &relax, &threads, &progress)) {
            return nullptr;
        }
        require_keywords(kwargs, {"thickness"});
        const ArrayArgument<float> position_array(state, positions, "positions", 3);
        const ArrayArgument<std::int32_t> size_array(state, face_sizes, "face_sizes", 0);
        const ArrayArgument<std::int32_t> corner_array(state, corners, "corners", 0);
        const ArrayArgument<float> uv_array(state, uvs, "uvs", 2);
        const OptionalArray<float> normal_array(state, normals, "normals", 3);
        const OptionalArray<std::int32_t> crease_edge_array(state, crease_edges, "crease_edges", 2);
        const OptionalArray<float> crease_sharpness_array(state, crease_sharpness, "crease_sharpness", 0);
        const OptionalArray<std::int32_t> corner_vertex_array(state, corner_vertices, "corner_vertices", 0);
        const OptionalArray<float> corner_sharpness_array(state, corner_sharpness, "corner_sharpness", 0);
        const OptionalArray<std::int32_t> covered_array(state, covered, "covered", 0);
        const OptionalArray<float> factor_array(state, factors, "thickness_factors", 0);
        const OptionalArray<float> image_array(state, image, "thickness_image", Axes{2});

        Surface surface;
        surface.positions = position_array.rows<glm::vec3>();
        surface.face_sizes = size_array.values();
        surface.corners = corner_array.values();
        surface.uvs = uv_array.rows<glm::vec2>();
        surface.normals = normal_array.rows<glm::vec3>();
        surface.crease_edges = crease_edge_array.rows<glm::ivec2>();
        surface.crease_sharpness = crease_sharpness_array.values();
        surface.corner_vertices = corner_vertex_array.values();
        surface.corner_sharpness = corner_sharpness_array.values();

        ShellOptions options;
        options.refinement.levels = levels;
        options.refinement.scheme = choice_of(schemes, "scheme", scheme);
        options.refinement.boundary = choice_of(boundaries, "boundary", boundary);
        options.refinement.uv_rule = choice_of(uv_rules, "uv_rule", uv_rule);
        options.refinement.edge_length = static_cast<float>(edge_length);
        options.refinement.edge_pixels = static_cast<float>(edge_pixels);
        if (clip_from_object != Py_None) {
            options.refinement.clip_from_object = matrix(state, clip_from_object, "clip_from_object");
        }
        if (screen != Py_None) {
            const std::vector<int> size = integers(state, screen, "screen", 2);
            options.refinement.screen = {size[0], size[1]};
        }
        options.thickness = static_cast<float>(thickness);
        options.thickness_factors = factor_array.values();
        if (image_array.given()) {
            options.thickness_image.values = image_array.values();
            options.thickness_image.size = {static_cast<int>(image_array.shape()[1]), static_cast<int>(image_array.shape()[0])};
        }
        options.shift = choice_of(offsets, "offset", offset);
        options.director_smoothing = smooth_directors;
        std::vector<std::uint8_t> marks(covered_array.values().size());
        std::transform(covered_array.values().begin(), covered_array.values().end(), marks.begin(),
                       [](std::int32_t mark) { return mark != 0 ? 1 : 0; });
        options.covered = marks;
        options.placement.scale = pair(state, uv_scale, "uv_scale", glm::vec2(1.0f));
        options.placement.rotation = static_cast<float>(uv_rotation);
        options.placement.offset = pair(state, uv_offset, "uv_offset", glm::vec2(0.0f));
        options.repair = repair != 0;
        options.relax_steps = relax;
        Job job(threads);
        return box(state.shell_type, run(job, progress, [&] { return build_shell(surface, options, job); }));
    });
}

PyObject* py_update_shell(PyObject* module, PyObject* args, PyObject* kwargs)
{
    ModuleState& state = state_of_module(module);
    return guarded(state, [&]() -> PyObject* {
        static const char* names[] = {"shell", "positions", "normals", "thickness_factors", "threads", "progress", nullptr};
        PyObject *shell = nullptr, *positions = nullptr, *normals = Py_None, *factors = Py_None, *progress = Py_None;
        int threads = 0;
        if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!O|$OOiO:update_shell", const_cast<char**>(names), state.shell_type, &shell,
                                         &positions, &normals, &factors, &threads, &progress)) {
            return nullptr;
        }
        const ArrayArgument<float> position_array(state, positions, "positions", 3);
        const OptionalArray<float> normal_array(state, normals, "normals", 3);
        const OptionalArray<float> factor_array(state, factors, "thickness_factors", 0);
        const Pose pose{position_array.rows<glm::vec3>(), normal_array.rows<glm::vec3>(), factor_array.values()};
        Job job(threads);
        return box(state.shell_type, run(job, progress, [&] { return update_shell(*unbox<Shell>(shell), pose, job); }));
    });
}

}  // namespace

PyMethodDef shell_functions[] = {
    {"build_shell", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_build_shell)),
     METH_VARARGS | METH_KEYWORDS,
     "build_shell(positions, face_sizes, corners, uvs, *, thickness, levels=0, scheme='catmark', normals=None, "
     "boundary='edges_and_corners', uv_rule='boundaries', crease_edges=None, crease_sharpness=None, corner_vertices=None, "
     "corner_sharpness=None, edge_length=0.0, edge_pixels=0.0, clip_from_object=None, screen=None, covered=None, "
     "thickness_factors=None, thickness_image=None, offset='outward', smooth_directors=0, uv_scale=(1, 1), uv_rotation=0.0, "
     "uv_offset=(0, 0), repair=False, relax=0, threads=0, progress=None)\n--\n\n"
     "Prisms over a polygon mesh: positions [n, 3], face_sizes [f], corners [c], uvs [c, 2], thickness in object units. Raises "
     "ValueError, or Error for a mesh that cannot carry a shell."},
    {"update_shell", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(py_update_shell)), METH_VARARGS | METH_KEYWORDS,
     "update_shell(shell, positions, *, normals=None, thickness_factors=None, threads=0, progress=None)\n--\n\n"
     "The same shell where the vertices of its surface have moved to positions [n, 3]: topology, UVs and options stay. Normals "
     "[n, 3] are used at level 0 and computed without. Raises ValueError for counts that do not fit, or Error where a vertex has "
     "no normal."},
    {nullptr, nullptr, 0, nullptr},
};

}  // namespace mesoshell::python
