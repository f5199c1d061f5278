#include "camera.h"

#include <cmath>

namespace mesoshell {

Camera::Camera(bool perspective, const glm::dvec3& eye, const glm::dvec3& target, double half_height,
               const glm::ivec2& size)
    : perspective_(perspective), eye_(eye), forward_(glm::normalize(target - eye)), half_height_(half_height),
      size_(size)
{
    // Straight down or up, the picture's top is +y.
    const glm::dvec3 top = std::abs(forward_.z) > 0.999 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    right_ = glm::normalize(glm::cross(forward_, top));
    up_ = glm::cross(right_, forward_);
}

View Camera::view() const
{
    // The OpenGL projection matrices, row by row.
    const double half_width = half_height_ * size_.x / size_.y;
    glm::dmat4 clip_from_view(0.0);
    clip_from_view[0][0] = 1.0 / half_width;
    clip_from_view[1][1] = 1.0 / half_height_;
    if (perspective_) {
        clip_from_view[2][2] = -(far + near) / (far - near);
        clip_from_view[3][2] = -2.0 * far * near / (far - near);
        clip_from_view[2][3] = -1.0;
    } else {
        clip_from_view[2][2] = -2.0 / (far - near);
        clip_from_view[3][2] = -(far + near) / (far - near);
        clip_from_view[3][3] = 1.0;
    }
    const glm::dmat4 object_from_view(glm::dvec4(right_, 0.0), glm::dvec4(up_, 0.0), glm::dvec4(-forward_, 0.0),
                                      glm::dvec4(eye_, 1.0));
    View view;
    view.clip_from_object = clip_from_view * glm::inverse(object_from_view);
    view.size = size_;
    return view;
}

CameraRay Camera::ray(int x, int y) const
{
    const double across = (2.0 * (x + 0.5) / size_.x - 1.0) * half_height_ * size_.x / size_.y;
    const double upward = (2.0 * (y + 0.5) / size_.y - 1.0) * half_height_;
    const glm::dvec3 offset = right_ * across + up_ * upward;
    if (perspective_) {
        return {eye_, glm::normalize(forward_ + offset)};
    }
    return {eye_ + offset + forward_ * near, forward_};
}

}  // namespace mesoshell
