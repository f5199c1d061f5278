#include "instruction_set.h"

#include <cstdlib>
#include <cstring>

#include "mesoshell/libraries.h"

extern "C" const mesoshell::simd::Kernels* mesoshell_kernels_baseline();
extern "C" const mesoshell::simd::Kernels* mesoshell_kernels_avx2();
extern "C" const mesoshell::simd::Kernels* mesoshell_kernels_avx512();

namespace mesoshell {
namespace {

const simd::Kernels& choose()
{
    const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    const bool has_avx512 = has_avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                            __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
    const char* const wanted = std::getenv("MESOSHELL_INSTRUCTION_SET");
    const auto allowed = [&](const char* name) {
        // A user's wish narrows the choice: whatever is not known to be narrower is as good as none.
        return wanted == nullptr || (std::strcmp(wanted, "baseline") != 0 &&
                                     (std::strcmp(wanted, "avx2") != 0 || std::strcmp(name, "avx2") == 0));
    };
    if (has_avx512 && allowed("avx512")) {
        return *mesoshell_kernels_avx512();
    }
    return has_avx2 && allowed("avx2") ? *mesoshell_kernels_avx2() : *mesoshell_kernels_baseline();
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
