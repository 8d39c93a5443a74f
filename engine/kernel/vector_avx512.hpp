// Rows and columns are both one register of AVX-512. Included by vector.hpp.
#pragma once

#include <immintrin.h>

namespace loam::engine {
namespace {

typedef double v8 __attribute__((vector_size(64)));
using m8 = decltype(v8{} > v8{});
typedef double v4 __attribute__((vector_size(32)));

constexpr int lanes = 8;
using Column = v8;
using Mask = m8;

template <class V>
LOAM_INLINE V splat_as(double a) {
    return V{a, a, a, a, a, a, a, a};
}
LOAM_INLINE v8 load8(const double* p) {
    return *reinterpret_cast<const v8*>(p);
}
LOAM_INLINE void store8(double* p, v8 a) {
    *reinterpret_cast<v8*>(p) = a;
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
LOAM_INLINE double lane(v8 a, int k) {
    return a[k];
}
LOAM_INLINE v8 choose(m8 mask, v8 a, v8 b) {
    return mask ? a : b;
}
LOAM_INLINE v8 larger(v8 a, v8 b) {
    return a > b ? a : b;
}
LOAM_INLINE bool any(m8 m) {
    return _mm512_test_epi64_mask(reinterpret_cast<__m512i>(m), reinterpret_cast<__m512i>(m)) != 0;
}
LOAM_INLINE double sum(v8 a) {
    return ((a[0] + a[1]) + (a[2] + a[3])) + ((a[4] + a[5]) + (a[6] + a[7]));
}

/// 1/sqrt(a), to within 2 units in the last place; a must be positive and normal. A 14-bit estimate, then one
/// correction of fourth order: much faster than a square root and a division.
LOAM_INLINE v8 inverse_sqrt(v8 a) {
    const v8 y = reinterpret_cast<v8>(_mm512_maskz_rsqrt14_pd(0xff, reinterpret_cast<__m512d>(a)));
    const v8 e = 1.0 - (a * y) * y;
    return y + (y * e) * (0.5 + e * (0.375 + e * 0.3125));
}

/// The square root, to within 3 units in the last place; zero for what is below 1e-300.
LOAM_INLINE v8 square_root(v8 a) {
    const m8 positive = a > 1e-300;
    const v8 safe = choose(positive, a, splat_as<v8>(1.0));
    return choose(positive, safe * inverse_sqrt(safe), v8{});
}

/// 1/a, to within 2 units in the last place; a must be normal.
LOAM_INLINE v8 inverse(v8 a) {
    v8 y = reinterpret_cast<v8>(_mm512_maskz_rcp14_pd(0xff, reinterpret_cast<__m512d>(a)));
    y = y + y * (1.0 - a * y);
    return y + y * (1.0 - a * y);
}

/// Whether as many indices as there are lanes are all equal to one.
LOAM_INLINE bool all_equal(const std::int32_t* p, std::int32_t value) {
    typedef std::int32_t i8 __attribute__((vector_size(32)));
    const i8 differ = *reinterpret_cast<const i8*>(p) ^ (i8{} + value);
    return _mm256_testz_si256(reinterpret_cast<__m256i>(differ), reinterpret_cast<__m256i>(differ));
}

LOAM_INLINE v8 join(v4 a, v4 b) {
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}
LOAM_INLINE v4 lower_half(v8 a) {
    return __builtin_shufflevector(a, a, 0, 1, 2, 3);
}
LOAM_INLINE v4 upper_half(v8 a) {
    return __builtin_shufflevector(a, a, 4, 5, 6, 7);
}
LOAM_INLINE v8 lower_halves(v8 a, v8 b) {
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
}
LOAM_INLINE v8 upper_halves(v8 a, v8 b) {
    return __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
}
/// The same three numbers and a zero in both halves.
LOAM_INLINE v8 twice(double x, double y, double z) {
    return v8{x, y, z, 0, x, y, z, 0};
}
/// Lane K of each half in all lanes of that half.
template <int K>
LOAM_INLINE v8 spread(v8 a) {
    return __builtin_shufflevector(a, a, K, K, K, K, K + 4, K + 4, K + 4, K + 4);
}
/// Zero in the last lane of each half.
LOAM_INLINE v8 without_fourth(v8 a) {
    return __builtin_shufflevector(a, v8{}, 0, 1, 2, 8, 4, 5, 6, 8);
}

/// Four columns that hold the rows of four of all lanes, before or after transposition.
struct HalfRows {
    v8 r[4];

    v4 row(int l) const { return l < 4 ? lower_half(r[l]) : upper_half(r[l - 4]); }
    void set_rows(const v4 (&rows)[lanes]) {
        for (int l = 0; l < 4; ++l) r[l] = join(rows[l], rows[l + 4]);
    }
    /// Turns rows into columns, r[k] holding the k-th of each, and back.
    void transpose() {
        v8 t[4];
        for (int k = 0; k < 4; k += 2) {
            t[k] = __builtin_shufflevector(r[k], r[k + 1], 0, 8, 2, 10, 4, 12, 6, 14);
            t[k + 1] = __builtin_shufflevector(r[k], r[k + 1], 1, 9, 3, 11, 5, 13, 7, 15);
        }
        for (int l = 0; l < 2; ++l) {
            r[l] = __builtin_shufflevector(t[l], t[l + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            r[l + 2] = __builtin_shufflevector(t[l], t[l + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
    }
};
/// Row l of a, then row l of b.
LOAM_INLINE v8 whole_row(const HalfRows& a, const HalfRows& b, int l) {
    return l < 4 ? lower_halves(a.r[l], b.r[l]) : upper_halves(a.r[l - 4], b.r[l - 4]);
}

/// Columns of the rows of all lanes. Unused columns cost nothing once inlined.
LOAM_INLINE void to_columns(const v8 (&r)[lanes], Column (&c)[8]) {
    v8 t[8], u[8];
    for (int k = 0; k < 8; k += 2) {
        t[k] = __builtin_shufflevector(r[k], r[k + 1], 0, 8, 2, 10, 4, 12, 6, 14);
        t[k + 1] = __builtin_shufflevector(r[k], r[k + 1], 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (int k = 0; k < 8; k += 4)
        for (int l = 0; l < 2; ++l) {
            u[k + l] = __builtin_shufflevector(t[k + l], t[k + l + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            u[k + l + 2] = __builtin_shufflevector(t[k + l], t[k + l + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
    for (int l = 0; l < 4; ++l) {
        c[l] = __builtin_shufflevector(u[l], u[l + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        c[l + 4] = __builtin_shufflevector(u[l], u[l + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

}  // namespace
}  // namespace loam::engine
