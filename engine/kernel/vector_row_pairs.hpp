// Rows of eight as pairs of rows of four. To be included after the functions of those and their HalfRows.
#pragma once

#include "engine/kernel/vector_pair.hpp"

namespace loam::engine {
namespace {

using v8 = Pair<v4>;

LOAM_INLINE v8 load8(const double* p) {
    return {load4(p), load4(p + 4)};
}
LOAM_INLINE void store8(double* p, v8 a) {
    store4(p, a.a);
    store4(p + 4, a.b);
}
LOAM_INLINE v8 join(v4 a, v4 b) {
    return {a, b};
}
LOAM_INLINE v4 lower_half(v8 a) {
    return a.a;
}
LOAM_INLINE v8 lower_halves(v8 a, v8 b) {
    return {a.a, b.a};
}
LOAM_INLINE v8 upper_halves(v8 a, v8 b) {
    return {a.b, b.b};
}
/// The same three numbers and a zero in both halves.
LOAM_INLINE v8 twice(double x, double y, double z) {
    return {row4(x, y, z, 0), row4(x, y, z, 0)};
}
/// Lane K of each half in all lanes of that half.
template <int K>
LOAM_INLINE v8 spread(v8 a) {
    return {spread4<K>(a.a), spread4<K>(a.b)};
}
/// Zero in the last lane of each half.
LOAM_INLINE v8 without_fourth(v8 a) {
    return {without_fourth(a.a), without_fourth(a.b)};
}

/// Row l of a, then row l of b.
LOAM_INLINE v8 whole_row(const HalfRows& a, const HalfRows& b, int l) {
    return {a.row(l), b.row(l)};
}
/// Columns of the rows of all lanes. Unused columns cost nothing once inlined.
LOAM_INLINE void to_columns(const v8 (&rows)[lanes], Column (&c)[8]) {
    v4 lower[lanes], upper[lanes];
    for (int l = 0; l < lanes; ++l) {
        lower[l] = rows[l].a;
        upper[l] = rows[l].b;
    }
    HalfRows first, second;
    first.set_rows(lower);
    second.set_rows(upper);
    first.transpose();
    second.transpose();
    for (int k = 0; k < 4; ++k) {
        c[k] = first.r[k];
        c[k + 4] = second.r[k];
    }
}

}  // namespace
}  // namespace loam::engine
