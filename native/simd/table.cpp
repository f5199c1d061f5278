// The one visible symbol of an instruction set: its table of kernels.
#include "functions.h"

namespace mesoshell::simd {
namespace {

constexpr Kernels kernels{MESOSHELL_INSTRUCTION_SET, rasterize_slices, add_gram, project, project_transposed, residual};

}  // namespace
}  // namespace mesoshell::simd

extern "C" const mesoshell::simd::Kernels* MESOSHELL_KERNELS_NAME()
{
    return &mesoshell::simd::kernels;
}
