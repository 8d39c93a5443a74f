// What every x86-64 has: columns are one register of SSE2, two pairs; rows are four. Included by vector.hpp.
#pragma once

#include <emmintrin.h>

namespace loam::engine {
namespace {

typedef double v2 __attribute__((vector_size(16)));
using m2 = decltype(v2{} > v2{});

constexpr int lanes = 2;
using Column = v2;
using Mask = m2;

template <class V>
LOAM_INLINE V splat_as(double a) {
    if constexpr (sizeof(V) == sizeof(v2))
        return V{a, a};
    else
        return V(a);
}
LOAM_INLINE double lane(v2 a, int k) {
    return a[k];
}
LOAM_INLINE v2 choose(m2 mask, v2 a, v2 b) {
    return reinterpret_cast<v2>((mask & reinterpret_cast<m2>(a)) | (~mask & reinterpret_cast<m2>(b)));
}
LOAM_INLINE v2 larger(v2 a, v2 b) {
    return _mm_max_pd(a, b);
}
LOAM_INLINE bool any(m2 m) {
    return _mm_movemask_pd(reinterpret_cast<v2>(m)) != 0;
}
LOAM_INLINE double sum(v2 a) {
    return a[0] + a[1];
}
LOAM_INLINE v2 inverse_sqrt(v2 a) {
    return 1.0 / _mm_sqrt_pd(a);
}
LOAM_INLINE v2 square_root(v2 a) {
    return _mm_sqrt_pd(a);
}
LOAM_INLINE v2 inverse(v2 a) {
    return 1.0 / a;
}

/// Whether as many indices as there are lanes are all equal to one.
LOAM_INLINE bool all_equal(const std::int32_t* p, std::int32_t value) {
    return ((p[0] ^ value) | (p[1] ^ value)) == 0;
}

}  // namespace
}  // namespace loam::engine

#include "engine/kernel/vector_pair.hpp"

namespace loam::engine {
namespace {

using v4 = Pair<v2>;

LOAM_INLINE v4 load4(const double* p) {
    return {*reinterpret_cast<const v2*>(p), *reinterpret_cast<const v2*>(p + 2)};
}
LOAM_INLINE void store4(double* p, v4 a) {
    *reinterpret_cast<v2*>(p) = a.a;
    *reinterpret_cast<v2*>(p + 2) = a.b;
}
LOAM_INLINE v4 row4(double x, double y, double z, double w) {
    return {v2{x, y}, v2{z, w}};
}
template <int K>
LOAM_INLINE v4 spread4(v4 a) {
    const v2 half = K < 2 ? a.a : a.b, all = __builtin_shufflevector(half, half, K % 2, K % 2);
    return {all, all};
}
LOAM_INLINE v4 without_fourth(v4 a) {
    return {a.a, __builtin_shufflevector(a.b, v2{}, 0, 3)};
}

/// Four columns that hold the rows of four of all lanes, before or after transposition.
struct HalfRows {
    v2 r[4];

    v4 row(int l) const { return {r[l], r[l + 2]}; }
    void set_rows(const v4 (&rows)[lanes]) {
        for (int l = 0; l < 2; ++l) {
            r[l] = rows[l].a;
            r[l + 2] = rows[l].b;
        }
    }
    /// Turns rows into columns, r[k] holding the k-th of each, and back.
    void transpose() {
        for (int k = 0; k < 4; k += 2) {
            const v2 a = r[k], b = r[k + 1];
            r[k] = __builtin_shufflevector(a, b, 0, 2);
            r[k + 1] = __builtin_shufflevector(a, b, 1, 3);
        }
    }
};

}  // namespace
}  // namespace loam::engine

#include "engine/kernel/vector_row_pairs.hpp"
