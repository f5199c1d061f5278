// A pinhole or parallel camera by the words of a photographer: its matrix as a host would give it, and, from
// trigonometry alone, the ray of every pixel.
#pragma once

#include <glm/glm.hpp>

#include "mesoshell/render.h"

namespace mesoshell {

struct CameraRay {
    glm::dvec3 origin;  // the eye, or on the near plane of a parallel camera
    glm::dvec3 dir;     // unit length
};

class Camera {
public:
    // Looks from `eye` to `target`; half_height is that of the picture at distance 1 (perspective) or anywhere
    // (parallel).
    Camera(bool perspective, const glm::dvec3& eye, const glm::dvec3& target, double half_height,
           const glm::ivec2& size);

    View view() const;
    CameraRay ray(int x, int y) const;  // row 0 is the bottom
    glm::dvec3 forward() const { return forward_; }

    static constexpr double near = 0.05;
    static constexpr double far = 50.0;

private:
    bool perspective_;
    glm::dvec3 eye_;
    glm::dvec3 forward_;
    glm::dvec3 right_;
    glm::dvec3 up_;
    double half_height_;
    glm::ivec2 size_;
};

}  // namespace mesoshell
