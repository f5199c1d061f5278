// How long an edge is for adaptive refinement, as a share of what it may be.
#pragma once

#include <glm/glm.hpp>

#include "mesoshell/surface.h"

namespace mesoshell {

// Measures in object units, on the screen, or both: then whichever asks for more.
class EdgeMeasure {
public:
    explicit EdgeMeasure(const Refinement& refinement) : refinement_(refinement) {}

    // The length of the straight piece from a to b over the one asked for: above 1 it is too long. On the screen only what
    // lies in front of the camera and within twice the screen's width and height about its center counts, so that an edge
    // through the camera's plane has a length too, and what is out of sight stays coarse.
    float operator()(const glm::vec3& a, const glm::vec3& b) const;

private:
    double pixels(const glm::vec3& a, const glm::vec3& b) const;

    Refinement refinement_;
};

}  // namespace mesoshell
