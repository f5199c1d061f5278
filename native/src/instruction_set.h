// Which of the kernels of native/simd this processor runs.
#pragma once

#include "../simd/kernels.h"

namespace mesoshell {

// The table for the widest instruction set that the processor has and the environment allows (mesoshell/libraries.h).
const simd::Kernels& kernels();

}  // namespace mesoshell
