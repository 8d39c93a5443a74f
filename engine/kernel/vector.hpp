// Doubles side by side as one value: a `v8` is a row of eight, a `Column` holds one quantity of `lanes`
// pairs. Columns are as wide as the registers of the instruction set that the including file is compiled for:
// wider vectors than those, GCC turns into scalar code. Rows are then pairs of narrower vectors. Everything
// is static, so that no version leaks into another.
#pragma once

#include <cstdint>

#define LOAM_INLINE static inline __attribute__((always_inline))

#if defined(__AVX512F__)
#include "engine/kernel/vector_avx512.hpp"
#elif defined(__AVX2__)
#include "engine/kernel/vector_avx2.hpp"
#else
#include "engine/kernel/vector_sse2.hpp"
#endif

namespace loam::engine {
namespace {

static_assert(sizeof(v8) == 64 && sizeof(Column) == 8 * lanes && 8 % lanes == 0);

LOAM_INLINE Column load(const double* p) {
    return *reinterpret_cast<const Column*>(p);
}
LOAM_INLINE void store(double* p, Column a) {
    *reinterpret_cast<Column*>(p) = a;
}
LOAM_INLINE Column splat(double a) {
    return splat_as<Column>(a);
}

/// Length of the three components that start at lane k.
LOAM_INLINE double norm_of(v8 a, int k) {
    const double x = lane(a, k), y = lane(a, k + 1), z = lane(a, k + 2);
    return __builtin_sqrt(x * x + y * y + z * z);
}

}  // namespace
}  // namespace loam::engine
