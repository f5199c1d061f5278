// The ray through the center of every pixel of a view, computed in double precision.
#pragma once

#include <algorithm>
#include <string>

#include <glm/glm.hpp>

#include "mesoshell/render.h"

namespace mesoshell {

struct PixelRay {
    glm::vec3 origin;  // the eye (perspective) or on the near plane (orthographic)
    glm::vec3 dir;     // unit length
};

struct ExactRay {
    glm::dvec3 origin;
    glm::dvec3 dir;
};

class ViewRays {
public:
    // Throws InvalidArgument for a size out of range or a matrix that cannot be inverted.
    explicit ViewRays(const View& view)
        : size_(view.size), object_from_clip_(glm::inverse(view.clip_from_object)), eye_(eye_of(view.clip_from_object))
    {
        if (std::min(size_.x, size_.y) < 1 || std::max(size_.x, size_.y) > 16384) {
            throw InvalidArgument("the picture is " + std::to_string(size_.x) + " by " + std::to_string(size_.y) +
                                  " pixels; give 1 to 16384 each way");
        }
    }

    PixelRay at(int x, int y) const
    {
        const ExactRay ray = through({x + 0.5, y + 0.5});
        return {glm::vec3(ray.origin), glm::vec3(ray.dir)};
    }

    // The ray through any place of the picture, in pixels.
    ExactRay through(const glm::dvec2& place) const
    {
        const glm::dvec2 ndc(2.0 * place.x / size_.x - 1.0, 2.0 * place.y / size_.y - 1.0);
        const glm::dvec4 homogeneous = object_from_clip_ * glm::dvec4(ndc, -1.0, 1.0);
        const glm::dvec3 near_point = glm::dvec3(homogeneous) / homogeneous.w;
        const glm::dvec3 dir = glm::normalize(near_point * eye_.w - glm::dvec3(eye_));
        return {eye_.w == 0.0 ? near_point : glm::dvec3(eye_), dir};
    }

private:
    glm::ivec2 size_;
    glm::dmat4 object_from_clip_;
    glm::dvec4 eye_;
};

}  // namespace mesoshell
