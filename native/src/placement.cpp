#include "placement.h"

#include <cmath>

namespace mesoshell {

void place_uvs(std::vector<glm::vec2>& uvs, const Placement& placement)
{
    const glm::dvec2 scale(placement.scale);
    const glm::dvec2 offset = glm::dvec2(placement.offset) - glm::trunc(glm::dvec2(placement.offset));
    const double cosine = std::cos(static_cast<double>(placement.rotation));
    const double sine = std::sin(static_cast<double>(placement.rotation));
    for (glm::vec2& uv : uvs) {
        const glm::dvec2 scaled = glm::dvec2(uv) * scale;
        uv = glm::vec2(glm::dvec2(cosine * scaled.x - sine * scaled.y, sine * scaled.x + cosine * scaled.y) + offset);
        if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
            throw InvalidArgument("the UV scale takes UVs beyond all numbers; use a smaller scale");
        }
    }
}

}  // namespace mesoshell
