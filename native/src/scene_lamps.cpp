#include "scene_lamps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mesoshell {
namespace {

constexpr double pi = std::numbers::pi;

// Half the angle of a sun that has a disk at all: 89.5 degrees.
constexpr double widest_sun = 89.5 / 180.0 * pi;

// What is asked of an area in every pixel, at least: one place alone is a point.
constexpr int fewest_area_places = 16;

// The unit square onto the unit disk, keeping areas in proportion and the center (Shirley and Chiu 1997).
glm::dvec2 on_disk(const glm::dvec2& place)
{
    const glm::dvec2 square = place * 2.0 - 1.0;
    if (square.x == 0.0 && square.y == 0.0) {
        return square;
    }
    const bool wide = std::abs(square.x) > std::abs(square.y);
    const double radius = wide ? square.x : square.y;
    const double angle = wide ? pi / 4.0 * square.y / square.x : pi / 2.0 - pi / 4.0 * square.x / square.y;
    return radius * glm::dvec2(std::cos(angle), std::sin(angle));
}

// A point of the unit disk that is perpendicular to a unit vector.
glm::dvec3 on_disk_across(const glm::dvec3& axis, const glm::dvec2& place)
{
    const glm::dvec3 other = std::abs(axis.z) < 0.7 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 x = glm::normalize(glm::cross(other, axis));
    const glm::dvec2 point = on_disk(place);
    return x * point.x + glm::cross(axis, x) * point.y;
}

bool is_soft(const SceneLight& light)
{
    switch (light.type) {
    case LightType::sun:
        return light.angle > 0.0f;
    case LightType::point:
    case LightType::spot:
        return light.radius > 0.0f;
    default:
        return true;
    }
}

}  // namespace

Lamp::Lamp(const SceneLight& light) : light_(light), soft_(mesoshell::is_soft(light))
{
    if (light.type != LightType::point) {
        light_.direction = glm::normalize(light.direction);
    }
    if (light.type == LightType::area) {
        light_.axis_x = glm::normalize(light.axis_x);
        light_.axis_y = glm::normalize(light.axis_y);
    }
}

int Lamp::places(int samples) const
{
    return light_.type == LightType::area ? std::max(1, (fewest_area_places + samples - 1) / samples) : 1;
}

Incidence Lamp::at(const glm::dvec3& position, const glm::dvec2& place) const
{
    switch (light_.type) {
    case LightType::sun:
        return from_sun(place);
    case LightType::area:
        return from_area(position, place);
    default:
        return from_bulb(position, place);
    }
}

Incidence Lamp::from_sun(const glm::dvec2& place) const
{
    Incidence light;
    light.to_light = -light_.direction;
    light.distance = std::numeric_limits<double>::infinity();
    light.radiance = light_.color / static_cast<float>(pi);
    if (soft_) {
        light.to_light = glm::normalize(light.to_light + on_disk_across(light.to_light, place) *
                                                             std::tan(std::min(0.5 * light_.angle, widest_sun)));
    }
    return light;
}

Incidence Lamp::from_bulb(const glm::dvec3& position, const glm::dvec2& place) const
{
    Incidence light;
    glm::dvec3 across = light_.position - position;
    const double to_center = glm::length(across);
    if (to_center == 0.0) {
        return light;
    }
    const glm::dvec3 axis = across / to_center;
    if (soft_) {
        across += on_disk_across(axis, place) * static_cast<double>(light_.radius);
    }
    light.distance = glm::length(across);
    light.to_light = across / light.distance;
    double share = glm::dot(axis, light.to_light) / (4.0 * pi * pi * light.distance * light.distance);
    if (light_.type == LightType::spot) {
        share *= cone_share(-light.to_light);
    }
    light.radiance = light_.color * static_cast<float>(share);
    return light;
}

double Lamp::cone_share(const glm::dvec3& from_light) const
{
    const double cosine = glm::dot(from_light, light_.direction);
    const double rim = std::cos(0.5 * light_.spot_size);
    if (cosine <= rim) {
        return 0.0;
    }
    const double width = (1.0 - rim) * light_.spot_blend;
    const double t = width > 0.0 ? std::min((cosine - rim) / width, 1.0) : 1.0;
    return t * t * (3.0 - 2.0 * t) * (light_.spot_cosine ? cosine : 1.0);
}

Incidence Lamp::from_area(const glm::dvec3& position, const glm::dvec2& place) const
{
    Incidence light;
    const glm::dvec2 half = glm::dvec2(light_.size) * 0.5;
    const glm::dvec2 point = (light_.shape == AreaShape::ellipse ? on_disk(place) : place * 2.0 - 1.0) * half;
    const glm::dvec3 across = light_.position + light_.axis_x * point.x + light_.axis_y * point.y - position;
    light.distance = glm::length(across);
    if (light.distance == 0.0) {
        return light;
    }
    light.to_light = across / light.distance;
    const double cosine = -glm::dot(light.to_light, light_.direction);
    if (cosine > 0.0) {
        light.radiance = light_.color * static_cast<float>(cosine / (4.0 * pi * light.distance * light.distance));
    }
    return light;
}

}  // namespace mesoshell
