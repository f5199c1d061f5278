// A ray against many prisms: whether it may meet one at all, by how its corners lie around the ray. Of the prisms whose boxes
// a ray meets, half are told off by this, in a fraction of the time that the ray's path through one takes.
//
// In SSE, which every x86-64 has: compilers leave these loops scalar, at three times the cost.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include <emmintrin.h>
#include <glm/glm.hpp>

#include "mesoshell/shell.h"

namespace mesoshell {

class SeenAlong {
public:
    SeenAlong(const glm::vec3& origin, const glm::vec3& dir) : origin_(_mm_setr_ps(origin.x, origin.y, origin.z, 0.0f))
    {
        const glm::vec3 helper = std::abs(dir.z) < 0.7f ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
        const glm::vec3 side = glm::normalize(glm::cross(helper, dir));
        const glm::vec3 up = glm::cross(dir, side);
        for (int i = 0; i < 3; ++i) {
            axes_[i] = _mm_setr_ps(side[i], up[i], side[i] + up[i], side[i] - up[i]);
        }
    }

    bool may_meet(const PrismTexels& prism) const
    {
        // The corners' extents on four axes across the ray, an octagon around their hull.
        __m128 low = _mm_set1_ps(std::numeric_limits<float>::max());
        __m128 high = _mm_set1_ps(std::numeric_limits<float>::lowest());
        for (int corner = 0; corner < 6; ++corner) {
            const __m128 offset = _mm_sub_ps(_mm_loadu_ps(&prism[corner].x), origin_);
            const __m128 along_x = _mm_mul_ps(axes_[0], _mm_shuffle_ps(offset, offset, _MM_SHUFFLE(0, 0, 0, 0)));
            const __m128 along_y = _mm_mul_ps(axes_[1], _mm_shuffle_ps(offset, offset, _MM_SHUFFLE(1, 1, 1, 1)));
            const __m128 along_z = _mm_mul_ps(axes_[2], _mm_shuffle_ps(offset, offset, _MM_SHUFFLE(2, 2, 2, 2)));
            const __m128 place = _mm_add_ps(_mm_add_ps(along_x, along_y), along_z);
            low = _mm_min_ps(low, place);
            high = _mm_max_ps(high, place);
        }
        // A hundred times the rounding of these sums, and what neighbors share of a ray between them: by the size of the prism
        // and how far it is.
        const __m128 sign = _mm_set1_ps(-0.0f);
        const __m128 away = _mm_andnot_ps(sign, _mm_sub_ps(_mm_loadu_ps(&prism[0].x), origin_));
        alignas(16) std::array<float, 4> distance;
        alignas(16) std::array<float, 4> extent;
        _mm_store_ps(distance.data(), away);
        _mm_store_ps(extent.data(), _mm_sub_ps(high, low));
        const __m128 margin = _mm_set1_ps(1e-5f * (distance[0] + distance[1] + distance[2] + extent[0] + extent[1]));
        const __m128 around = _mm_and_ps(_mm_cmple_ps(low, margin), _mm_cmpge_ps(high, _mm_xor_ps(sign, margin)));
        return _mm_movemask_ps(around) == 0xf;
    }

private:
    __m128 origin_;
    __m128 axes_[3];  // columns: an offset's coordinates on the four axes
};

}  // namespace mesoshell
