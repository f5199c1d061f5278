// The sky of a scene: what the camera sees of it, and how much light it casts on a surface that nothing hides from it.
#pragma once

#include <array>

#include <glm/glm.hpp>

#include "mesoshell/job.h"
#include "mesoshell/scene.h"

namespace mesoshell {

class Sky {
public:
    Sky(const SceneWorld& world, Job& job);

    // Radiance from a direction of unit length.
    glm::vec3 radiance(const glm::dvec3& dir) const;

    // The mean radiance over the hemisphere of a normal, weighted by cosine: what a white diffuse surface answers. An image
    // counts with its first nine spherical harmonics (Ramamoorthi and Hanrahan 2001, "An efficient representation for
    // irradiance environment maps": within 3 % of the whole for most skies).
    glm::vec3 ambient(const glm::vec3& normal) const;

private:
    glm::vec3 pixel(int x, int y) const;
    void project(Job& job);

    const SceneWorld& world_;
    std::array<glm::vec3, 9> harmonics_{};
};

}  // namespace mesoshell
