// Lamps: how much light each casts on a point, and where from.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "mesoshell/scene.h"

namespace mesoshell {

// Light from one place of a lamp.
struct Incidence {
    glm::dvec3 to_light{0.0};   // unit length
    double distance = 0.0;      // infinite to a sun
    glm::vec3 radiance{0.0f};   // of a white diffuse surface that faces it: irradiance over pi
};

class Lamp {
public:
    explicit Lamp(const SceneLight& light);

    // Places to ask for each of a pixel's samples.
    int places(int samples) const;

    // From the lamp's place of two numbers in [0, 1); its center is that of (1/2, 1/2).
    Incidence at(const glm::dvec3& position, const glm::dvec2& place) const;

    bool is_soft() const { return soft_; }
    bool casts_shadow() const { return light_.cast_shadow; }

private:
    Incidence from_sun(const glm::dvec2& place) const;
    Incidence from_bulb(const glm::dvec3& position, const glm::dvec2& place) const;
    Incidence from_area(const glm::dvec3& position, const glm::dvec2& place) const;
    double cone_share(const glm::dvec3& from_light) const;

    SceneLight light_;  // its directions of unit length
    bool soft_;
};

}  // namespace mesoshell
