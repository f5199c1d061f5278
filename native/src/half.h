// Rounding to 16-bit floats, by OpenEXR's Imath.
#pragma once

#include <span>

#include <Imath/half.h>

namespace mesoshell {

inline void round_to_half(std::span<float> values)
{
    for (float& value : values) {
        value = static_cast<float>(Imath::half(value));
    }
}

}  // namespace mesoshell
