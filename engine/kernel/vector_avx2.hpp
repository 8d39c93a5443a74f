// Columns are one register of AVX2, four pairs; rows are two. Included by vector.hpp.
#pragma once

#include <immintrin.h>

namespace loam::engine {
namespace {

typedef double v4 __attribute__((vector_size(32)));
using m4 = decltype(v4{} > v4{});

constexpr int lanes = 4;
using Column = v4;
using Mask = m4;

template <class V>
LOAM_INLINE V splat_as(double a) {
    if constexpr (sizeof(V) == sizeof(v4))
        return V{a, a, a, a};
    else
        return V(a);
}
LOAM_INLINE v4 load4(const double* p) {
    return *reinterpret_cast<const v4*>(p);
}
LOAM_INLINE void store4(double* p, v4 a) {
    *reinterpret_cast<v4*>(p) = a;
}
LOAM_INLINE v4 row4(double x, double y, double z, double w) {
    return v4{x, y, z, w};
}
LOAM_INLINE double lane(v4 a, int k) {
    return a[k];
}
LOAM_INLINE v4 choose(m4 mask, v4 a, v4 b) {
    return _mm256_blendv_pd(b, a, reinterpret_cast<v4>(mask));
}
LOAM_INLINE v4 larger(v4 a, v4 b) {
    return _mm256_max_pd(a, b);
}
LOAM_INLINE bool any(m4 m) {
    return _mm256_movemask_pd(reinterpret_cast<v4>(m)) != 0;
}
LOAM_INLINE double sum(v4 a) {
    return (a[0] + a[1]) + (a[2] + a[3]);
}
LOAM_INLINE v4 inverse_sqrt(v4 a) {
    return 1.0 / _mm256_sqrt_pd(a);
}
LOAM_INLINE v4 square_root(v4 a) {
    return _mm256_sqrt_pd(a);
}
LOAM_INLINE v4 inverse(v4 a) {
    return 1.0 / a;
}

/// Whether as many indices as there are lanes are all equal to one.
LOAM_INLINE bool all_equal(const std::int32_t* p, std::int32_t value) {
    typedef std::int32_t i4 __attribute__((vector_size(16)));
    const i4 differ = *reinterpret_cast<const i4*>(p) ^ (i4{} + value);
    return _mm_testz_si128(reinterpret_cast<__m128i>(differ), reinterpret_cast<__m128i>(differ));
}

template <int K>
LOAM_INLINE v4 spread4(v4 a) {
    return __builtin_shufflevector(a, a, K, K, K, K);
}
LOAM_INLINE v4 without_fourth(v4 a) {
    return __builtin_shufflevector(a, v4{}, 0, 1, 2, 7);
}

/// Four columns that hold the rows of four of all lanes, before or after transposition.
struct HalfRows {
    v4 r[4];

    v4 row(int l) const { return r[l]; }
    void set_rows(const v4 (&rows)[lanes]) {
        for (int l = 0; l < 4; ++l) r[l] = rows[l];
    }
    /// Turns rows into columns, r[k] holding the k-th of each, and back.
    void transpose() {
        const v4 t[4] = {
            __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6), __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7),
            __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6), __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7)};
        for (int l = 0; l < 2; ++l) {
            r[l] = __builtin_shufflevector(t[l], t[l + 2], 0, 1, 4, 5);
            r[l + 2] = __builtin_shufflevector(t[l], t[l + 2], 2, 3, 6, 7);
        }
    }
};

}  // namespace
}  // namespace loam::engine

#include "engine/kernel/vector_row_pairs.hpp"
