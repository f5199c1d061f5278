// What render_scene is given in Python, as a Scene.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "arrays.h"
#include "mesoshell/scene.h"

namespace mesoshell::python {

// A Scene and all that its spans and pointers name. Throws InvalidArgument; PythonError.
class SceneArguments {
public:
    explicit SceneArguments(ModuleState& state) : state_(state) {}

    void add_shells(PyObject* shells);
    void add_meshes(PyObject* meshes);
    void add_lights(PyObject* lights);
    void set_world(PyObject* world);

    const Scene& scene() const { return scene_; }

private:
    void add_shell(PyObject* object, const std::string& what);
    void add_mesh(PyObject* object, const std::string& what);
    void add_light(PyObject* object, const std::string& what);
    std::span<const glm::vec3> vectors(PyObject* object, const std::string& called);

    ModuleState& state_;
    Scene scene_;
    std::deque<ArrayArgument<float>> arrays_;
    std::deque<std::vector<glm::uvec3>> triangles_;
    std::vector<std::shared_ptr<const void>> held_;
};

}  // namespace mesoshell::python
