#include "scene_check.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "mesoshell/render.h"

namespace mesoshell {
namespace {

constexpr int most_samples = 65536;
constexpr float widest_filter = 16.0f;
constexpr std::size_t most_triangles = std::size_t(1) << 31;

[[noreturn]] void refuse(const std::string& what, const std::string& problem)
{
    throw InvalidArgument(what + ": " + problem);
}

template <typename Vector>
bool all_finite(const Vector& vector)
{
    for (int i = 0; i < Vector::length(); ++i) {
        if (!std::isfinite(vector[i])) {
            return false;
        }
    }
    return true;
}

template <typename Values>
void check_finite(const std::string& what, const char* name, const Values& values)
{
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!all_finite(values[i])) {
            refuse(what, std::string(name) + " hold a number that is not finite, in row " + std::to_string(i));
        }
    }
}

void check_color(const std::string& what, const char* name, const glm::vec3& color)
{
    if (!all_finite(color) || std::min({color.x, color.y, color.z}) < 0.0f) {
        refuse(what, std::string(name) + " is no color; give three numbers that are finite and not negative");
    }
}

void check_between(const std::string& what, const char* name, float value, float low, float high)
{
    if (!(value >= low && value <= high)) {
        refuse(what, std::string(name) + " is " + std::to_string(value) + "; give " + std::to_string(low) + " to " +
                         std::to_string(high));
    }
}

void check_direction(const std::string& what, const char* name, const glm::dvec3& direction)
{
    const double size = glm::length(direction);
    if (!(size > 0.0 && std::isfinite(size))) {
        refuse(what, std::string(name) + " has no direction; give a finite vector that is not zero");
    }
}

void check_shell(const std::string& what, const SceneShell& shell)
{
    if (shell.shell == nullptr || shell.map == nullptr) {
        refuse(what, "it lacks its shell or its map");
    }
    const glm::dmat4& matrix = shell.world_from_object;
    const glm::dmat4 inverse = glm::inverse(matrix);
    for (int i = 0; i < 4; ++i) {
        if (!all_finite(matrix[i]) || !all_finite(inverse[i])) {
            refuse(what,
                   "world_from_object cannot be inverted; give a matrix that is finite and leaves the object a volume");
        }
        if (matrix[i][3] != (i == 3 ? 1.0 : 0.0)) {
            refuse(what, "world_from_object has a last row other than 0, 0, 0, 1; give a matrix without perspective");
        }
    }
    check_color(what, "base_color", shell.base_color);
}

void check_mesh(const std::string& what, const SceneMesh& mesh)
{
    check_finite(what, "positions", mesh.positions);
    for (const glm::uvec3& triangle : mesh.triangles) {
        const std::uint32_t largest = std::max({triangle.x, triangle.y, triangle.z});
        if (largest >= mesh.positions.size()) {
            refuse(what,
                   "triangles name vertex " + std::to_string(largest) + " of " + std::to_string(mesh.positions.size()));
        }
    }
    const std::size_t corners = 3 * mesh.triangles.size();
    if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size() && mesh.normals.size() != corners) {
        refuse(what, "normals has " + std::to_string(mesh.normals.size()) + " rows; give " +
                         std::to_string(mesh.positions.size()) + ", one a vertex, or " + std::to_string(corners) +
                         ", one a corner");
    }
    check_finite(what, "normals", mesh.normals);
    if (!mesh.colors.empty() && mesh.colors.size() != mesh.triangles.size()) {
        refuse(what, "colors has " + std::to_string(mesh.colors.size()) + " rows; give " +
                         std::to_string(mesh.triangles.size()) + ", one a triangle");
    }
    for (const glm::vec3& color : mesh.colors) {
        check_color(what, "a row of colors", color);
    }
    check_color(what, "base_color", mesh.base_color);
}

void check_light(const std::string& what, const SceneLight& light)
{
    constexpr float pi = std::numbers::pi_v<float>;
    check_color(what, "color", light.color);
    if (light.type != LightType::point) {
        check_direction(what, "direction", light.direction);
    }
    if (light.type == LightType::sun) {
        check_between(what, "angle", light.angle, 0.0f, pi);
        return;
    }
    if (!all_finite(light.position)) {
        refuse(what, "position is not finite");
    }
    if (light.type == LightType::area) {
        if (!all_finite(light.size) || std::min(light.size.x, light.size.y) < 0.0f) {
            refuse(what, "size is no size; give two numbers that are finite and not negative");
        }
        check_direction(what, "the first of its axes", light.axis_x);
        check_direction(what, "the second of its axes", light.axis_y);
        return;
    }
    if (!(light.radius >= 0.0f && std::isfinite(light.radius))) {
        refuse(what, "radius is " + std::to_string(light.radius) + "; give a finite length that is not negative");
    }
    if (light.type == LightType::spot) {
        check_between(what, "spot_size", light.spot_size, 0.0f, pi);
        check_between(what, "spot_blend", light.spot_blend, 0.0f, 1.0f);
    }
}

void check_world(const SceneWorld& world)
{
    check_color("world", "color", world.color);
    const auto pixels = static_cast<std::size_t>(std::max(world.image_size.x, 0)) * std::max(world.image_size.y, 0);
    if (world.image.size() != pixels) {
        refuse("world", "image has " + std::to_string(world.image.size()) + " pixels; give " + std::to_string(pixels));
    }
    for (const glm::vec3& color : world.image) {
        check_color("world", "a pixel of image", color);
    }
}

template <typename Items, typename Check>
void check_each(const char* name, const Items& items, const Check& check)
{
    for (std::size_t i = 0; i < items.size(); ++i) {
        check(std::string(name) + "[" + std::to_string(i) + "]", items[i]);
    }
}

}  // namespace

void check_scene(const Scene& scene)
{
    check_each("shells", scene.shells, check_shell);
    check_each("meshes", scene.meshes, check_mesh);
    check_each("lights", scene.lights, check_light);
    check_world(scene.world);
    std::size_t triangles = 0;
    std::size_t vertices = 0;
    for (const SceneMesh& mesh : scene.meshes) {
        triangles += mesh.triangles.size();
        vertices += mesh.positions.size();
    }
    if (std::max(triangles, vertices) > most_triangles) {
        refuse("meshes", "they have " + std::to_string(triangles) + " triangles and " + std::to_string(vertices) +
                             " vertices together; 2147483648 of each are the most");
    }
}

void check_film(const Film& film)
{
    try {
        eye_of(film.clip_from_world);
    } catch (const InvalidArgument&) {
        throw InvalidArgument("clip_from_world cannot be inverted; give a projection times a view matrix");
    }
    if (film.samples < 1 || film.samples > most_samples) {
        throw InvalidArgument("samples is " + std::to_string(film.samples) + "; give 1 to " + std::to_string(most_samples));
    }
    if (!(film.filter_width >= 0.0f && film.filter_width <= widest_filter)) {
        throw InvalidArgument("filter_width is " + std::to_string(film.filter_width) + "; give 0 to 16 pixels");
    }
}

}  // namespace mesoshell
