// The processor's vectors of 32-bit numbers, as wide as the instruction set that this is compiled for has them.
#pragma once

#include <cstdint>
#include <cstring>

#include <immintrin.h>

namespace mesoshell::simd {

#if defined(__AVX512F__)
constexpr int lanes = 16;
#elif defined(__AVX2__)
constexpr int lanes = 8;
#else
constexpr int lanes = 4;
#endif

typedef std::int32_t Ints __attribute__((vector_size(4 * lanes)));
typedef std::uint32_t Uints __attribute__((vector_size(4 * lanes)));
typedef float Floats __attribute__((vector_size(4 * lanes)));
// As many lanes in twice the width: for what does not fit 32 bits.
typedef double Doubles __attribute__((vector_size(8 * lanes)));

#if defined(__AVX512F__)
constexpr Ints lane_numbers = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
#elif defined(__AVX2__)
constexpr Ints lane_numbers = {0, 1, 2, 3, 4, 5, 6, 7};
#else
constexpr Ints lane_numbers = {0, 1, 2, 3};
#endif

template <typename Vector, typename Value>
inline Vector load(const Value* from)
{
    Vector vector;
    std::memcpy(&vector, from, sizeof vector);
    return vector;
}

template <typename Vector, typename Value>
inline void store(Value* to, const Vector& vector)
{
    std::memcpy(to, &vector, sizeof vector);
}

// One bit a lane: its sign.
inline unsigned sign_bits(const Ints& vector)
{
#if defined(__AVX512F__)
    return _mm512_movepi32_mask(reinterpret_cast<__m512i>(vector));
#elif defined(__AVX2__)
    return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(vector)));
#else
    return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(vector)));
#endif
}

}  // namespace mesoshell::simd
