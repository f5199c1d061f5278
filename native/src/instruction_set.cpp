#include "instruction_set.h"

#include <cstdlib>
#include <cstring>

#include "mesoshell/libraries.h"

extern "C" const mesoshell::simd::Kernels* mesoshell_kernels_baseline();
extern "C" const mesoshell::simd::Kernels* mesoshell_kernels_avx2();

namespace mesoshell {
namespace {

const simd::Kernels& choose()
{
    const char* wanted = std::getenv("MESOSHELL_INSTRUCTION_SET");
    const bool narrow = wanted != nullptr && std::strcmp(wanted, "baseline") == 0;
    const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    return has_avx2 && !narrow ? *mesoshell_kernels_avx2() : *mesoshell_kernels_baseline();
}

}  // namespace

const simd::Kernels& kernels()
{
    static const simd::Kernels& chosen = choose();
    return chosen;
}

const char* instruction_set()
{
    return kernels().name;
}

}  // namespace mesoshell
