#include "scene_arguments.h"

#include <algorithm>
#include <climits>
#include <string>

#include "fields.h"
#include "mesoshell/traversal.h"
#include "named.h"
#include "render_arguments.h"

namespace mesoshell::python {
namespace {

constexpr Named<LightType> light_types[] = {
    {"SUN", LightType::sun}, {"POINT", LightType::point}, {"SPOT", LightType::spot}, {"AREA", LightType::area}};
// Blender's words; what tells a square from a rectangle is its size.
constexpr Named<AreaShape> area_shapes[] = {{"SQUARE", AreaShape::rectangle},
                                            {"RECTANGLE", AreaShape::rectangle},
                                            {"DISK", AreaShape::ellipse},
                                            {"ELLIPSE", AreaShape::ellipse}};

template <typename Add>
void add_each(PyObject* sequence, const char* name, const Add& add)
{
    const Reference list(PySequence_List(sequence));
    if (list.get() == nullptr) {
        PyErr_Clear();
        throw InvalidArgument(std::string(name) + " is no sequence; give a list of dicts");
    }
    for (Py_ssize_t i = 0; i < PyList_Size(list.get()); ++i) {
        add(PyList_GetItem(list.get(), i), std::string(name) + "[" + std::to_string(i) + "]");
    }
}

}  // namespace

std::span<const glm::vec3> SceneArguments::vectors(PyObject* object, const std::string& called)
{
    return arrays_.emplace_back(state_, object, called.c_str(), 3).rows<glm::vec3>();
}

void SceneArguments::add_shells(PyObject* shells)
{
    add_each(shells, "shells", [&](PyObject* object, const std::string& what) { add_shell(object, what); });
}

void SceneArguments::add_meshes(PyObject* meshes)
{
    add_each(meshes, "meshes", [&](PyObject* object, const std::string& what) { add_mesh(object, what); });
}

void SceneArguments::add_lights(PyObject* lights)
{
    add_each(lights, "lights", [&](PyObject* object, const std::string& what) { add_light(object, what); });
}

void SceneArguments::add_shell(PyObject* object, const std::string& what)
{
    const Fields fields(state_, object, what,
                        {"shell", "map", "sample", "world_from_object", "traversal", "settings", "base_color",
                         "object_index", "visible_camera", "visible_shadow"});
    SceneShell shell;
    const auto held_shell = unbox<Shell>(fields.need("shell", state_.shell_type));
    const auto held_map = unbox<Map>(fields.need("map", state_.map_type));
    held_.insert(held_.end(), {held_shell, held_map});
    shell.shell = held_shell.get();
    shell.map = held_map.get();
    if (fields.find("sample") != nullptr) {
        const auto held_sample = unbox<Sample>(fields.need("sample", state_.sample_type));
        held_.push_back(held_sample);
        shell.sample = held_sample.get();
    }
    shell.world_from_object = matrix(state_, fields.need("world_from_object"), fields.called("world_from_object").c_str());
    try {
        shell.settings = params_argument(fields.find("settings"));
        shell.settings.mode.x = static_cast<int>(traversal_named(fields.text("traversal", "refined")));
    } catch (const InvalidArgument& problem) {
        throw InvalidArgument(what + ": " + problem.what());
    }
    shell.base_color = glm::vec3(fields.triple("base_color", glm::dvec3(glm::vec3(shell.settings.base_color))));
    shell.object_index = fields.integer("object_index", 0);
    shell.visible_camera = fields.flag("visible_camera", true);
    shell.visible_shadow = fields.flag("visible_shadow", true);
    scene_.shells.push_back(shell);
}

void SceneArguments::add_mesh(PyObject* object, const std::string& what)
{
    const Fields fields(state_, object, what,
                        {"positions", "triangles", "normals", "base_color", "colors", "object_index", "visible_camera",
                         "visible_shadow"});
    SceneMesh mesh;
    mesh.positions = vectors(fields.need("positions"), fields.called("positions"));
    const ArrayArgument<std::int64_t> triangles(state_, fields.need("triangles"), fields.called("triangles").c_str(), 3);
    std::vector<glm::uvec3>& corners = triangles_.emplace_back();
    corners.reserve(triangles.values().size() / 3);
    for (const glm::i64vec3& t : triangles.rows<glm::i64vec3>()) {
        // Out of range either way: render_scene says so.
        corners.emplace_back(glm::min(glm::u64vec3(t), glm::u64vec3(~0u)));
    }
    mesh.triangles = corners;
    if (PyObject* normals = fields.find("normals"); normals != nullptr) {
        mesh.normals = vectors(normals, fields.called("normals"));
    }
    if (PyObject* colors = fields.find("colors"); colors != nullptr) {
        mesh.colors = vectors(colors, fields.called("colors"));
    }
    mesh.base_color = glm::vec3(fields.triple("base_color", glm::dvec3(mesh.base_color)));
    mesh.object_index = fields.integer("object_index", 0);
    mesh.visible_camera = fields.flag("visible_camera", true);
    mesh.visible_shadow = fields.flag("visible_shadow", true);
    scene_.meshes.push_back(mesh);
}

void SceneArguments::add_light(PyObject* object, const std::string& what)
{
    const Fields fields(state_, object, what,
                        {"type", "position", "direction", "color", "radius", "angle", "spot_size", "spot_blend",
                         "spot_cosine", "shape", "size", "axes", "cast_shadow"});
    SceneLight light;
    fields.need("type");
    light.type = choice_of(light_types, fields.called("type"), fields.text("type", ""));
    if (light.type != LightType::sun) {
        fields.need("position");
    }
    if (light.type != LightType::point) {
        fields.need("direction");
    }
    light.position = fields.triple("position", light.position);
    light.direction = fields.triple("direction", light.direction);
    light.color = glm::vec3(fields.triple("color", glm::dvec3(light.color)));
    light.radius = static_cast<float>(fields.number("radius", light.radius));
    light.angle = static_cast<float>(fields.number("angle", light.angle));
    light.spot_size = static_cast<float>(fields.number("spot_size", light.spot_size));
    light.spot_blend = static_cast<float>(fields.number("spot_blend", light.spot_blend));
    light.spot_cosine = fields.flag("spot_cosine", light.spot_cosine);
    light.shape = choice_of(area_shapes, fields.called("shape"), fields.text("shape", "SQUARE"));
    light.size = glm::vec2(fields.pair("size", glm::dvec2(light.size)));
    if (light.type == LightType::area) {
        const ArrayArgument<double> axes(state_, fields.need("axes"), fields.called("axes").c_str(), 3);
        if (axes.values().size() != 6) {
            throw InvalidArgument(fields.called("axes") + " has " + std::to_string(axes.values().size() / 3) +
                                  " rows; give two");
        }
        light.axis_x = axes.rows<glm::dvec3>()[0];
        light.axis_y = axes.rows<glm::dvec3>()[1];
    }
    light.cast_shadow = fields.flag("cast_shadow", true);
    scene_.lights.push_back(light);
}

void SceneArguments::set_world(PyObject* world)
{
    if (world == Py_None) {
        return;
    }
    const Fields fields(state_, world, "world", {"color", "image"});
    scene_.world.color = glm::vec3(fields.triple("color", glm::dvec3(0.0)));
    PyObject* image = fields.find("image");
    if (image == nullptr) {
        return;
    }
    const ArrayArgument<float>& array = arrays_.emplace_back(state_, image, "world: image", Axes{3});
    if (array.shape()[2] != 3 || std::max(array.shape()[0], array.shape()[1]) > INT_MAX || array.values().empty()) {
        throw InvalidArgument("world: image is no image; give an array [height, width, 3] with pixels");
    }
    scene_.world.image = array.rows<glm::vec3>();
    scene_.world.image_size = glm::ivec2(array.shape()[1], array.shape()[0]);
}

}  // namespace mesoshell::python
